"""Small data sets with everything that VTK's files hold, for the scripts that have them written.

Every data set of one kind holds the same values. Runs under the package vtk and inside ParaView's own Python.
"""

import numpy as np

try:
    import vtk
except ImportError:
    import vtkmodules.all as vtk
from vtkmodules.util import numpy_support


def array(name, values, component_names=()):
    result = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    result.SetName(name)
    for component, text in enumerate(component_names):
        result.SetComponentName(component, text)
    return result


def texts(name, values):
    result = vtk.vtkStringArray()
    result.SetName(name)
    for value in values:
        result.InsertNextValue(value)
    return result


def fill(dataset):
    """Binary fractions only, so that ascii files hold the same numbers."""
    points, cells = dataset.GetPointData(), dataset.GetCellData()
    n = dataset.GetNumberOfPoints()
    steps = np.arange(n)
    points.AddArray(array("speed", steps * 0.25 - 1.0))
    points.AddArray(array("single \u03c1", (steps * 0.5).astype(np.float32)))
    points.AddArray(array("velocity", np.stack([steps, steps * 2, -steps], 1).astype(float), ("u", "v", "w")))
    for kind in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"):
        values = steps.astype(kind)
        values[0] = np.iinfo(kind).max
        points.AddArray(array(kind, values))
    bits, ids = vtk.vtkBitArray(), vtk.vtkIdTypeArray()
    bits.SetName("bits")
    ids.SetName("ids")
    for step in range(n):
        bits.InsertNextValue(step % 3 == 0)
        ids.InsertNextValue(step * 7)
    points.AddArray(bits)
    points.AddArray(ids)
    points.AddArray(texts("labels", [f"point {step}" if step else "" for step in range(n)]))
    points.SetActiveScalars("speed")
    points.SetActiveVectors("velocity")
    cells.AddArray(array("material", np.arange(dataset.GetNumberOfCells(), dtype=np.int32)))
    dataset.GetFieldData().AddArray(array("TimeValue", np.array([1.25])))
    dataset.GetFieldData().AddArray(texts("source", ["a b <&> c", "second"]))
    return dataset


def image():
    result = vtk.vtkImageData()
    result.SetExtent(-1, 1, 2, 4, 0, 0)
    result.SetOrigin(0.1, -0.7, 1e-9)
    result.SetSpacing(0.3, 0.1, 0.7)
    return fill(result)


def turned():
    result = image()
    result.SetDirectionMatrix(0, 1, 0, 1, 0, 0, 0, 0, -1)
    return result


def rectilinear():
    result = vtk.vtkRectilinearGrid()
    result.SetDimensions(3, 2, 2)
    for axis, values in zip("XYZ", ([0, 0.5, 2], [0, 0.5], [-1, 0.25])):
        getattr(result, f"Set{axis}Coordinates")(array(axis.lower(), np.array(values, float)))
    return fill(result)


def vtk_points(values, double=True):
    result = vtk.vtkPoints()
    result.SetDataType(vtk.VTK_DOUBLE if double else vtk.VTK_FLOAT)
    for value in values:
        result.InsertNextPoint(value)
    return result


def structured():
    result = vtk.vtkStructuredGrid()
    result.SetDimensions(3, 2, 1)
    result.SetPoints(vtk_points([(i + 0.5 * j, j, 0.25 * i * j) for j in range(2) for i in range(3)]))
    return fill(result)


def cell_array(lists):
    result = vtk.vtkCellArray()
    for points in lists:
        result.InsertNextCell(len(points), points)
    return result


def poly():
    result = vtk.vtkPolyData()
    result.SetPoints(vtk_points([(i * 0.5, (i * i) % 7 * 0.25, i % 3) for i in range(9)], double=False))
    result.SetVerts(cell_array([[0], [1, 2]]))
    result.SetLines(cell_array([[0, 1], [2, 3, 4]]))
    result.SetPolys(cell_array([[0, 1, 2], [3, 4, 5, 6]]))
    result.SetStrips(cell_array([[4, 5, 6, 7, 8]]))
    return fill(result)


def unstructured(polyhedron=False):
    result = vtk.vtkUnstructuredGrid()
    result.SetPoints(vtk_points([(i % 2, i // 2 % 2, i // 4) for i in range(8)] + [(0.5, 0.5, 2)]))
    cells = [(vtk.VTK_VOXEL, range(8)), (vtk.VTK_PYRAMID, [4, 5, 7, 6, 8]), (vtk.VTK_TETRA, [0, 1, 2, 4]), (vtk.VTK_LINE, [0, 1])]
    for kind, points in cells:
        result.InsertNextCell(kind, len(points), list(points))
    if polyhedron:
        faces = vtk.vtkIdList()
        for number in [4, 3, 0, 1, 2, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 2, 3]:
            faces.InsertNextId(number)
        result.InsertNextCell(vtk.VTK_POLYHEDRON, faces)
    return fill(result)


def empty():
    result = vtk.vtkUnstructuredGrid()
    result.SetPoints(vtk.vtkPoints())
    return result


KINDS = {"image": image, "rectilinear": rectilinear, "structured": structured, "poly": poly, "unstructured": unstructured}

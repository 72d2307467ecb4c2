"""Opens what `morsmooth complex` writes with VTK and checks it as TTK's filters would take it.

    python3 tools/vtk/complex.py OUT_DIR [--picture FILE.png]

Every array must downcast to the class that TTK asks for (SafeDownCast: a 32-bit id array in any other class is "missing"
to TTK), ids must name critical points, and every separatrix must run from its source to its destination.
"""

import argparse
import pathlib
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

CRITICAL = {
    "CellDimension": vtk.vtkSignedCharArray,
    "CellId": vtk.vtkIntArray,
    "IsOnBoundary": vtk.vtkSignedCharArray,
    "ttkVertexScalarField": vtk.vtkIntArray,
    "ManifoldSize": vtk.vtkIntArray,
}
LINE_POINTS = {
    "ttkMaskScalarField": vtk.vtkSignedCharArray,
    "CellDimension": vtk.vtkSignedCharArray,
    "CellId": vtk.vtkIntArray,
}
LINE_CELLS = {
    "SourceId": vtk.vtkIntArray,
    "DestinationId": vtk.vtkIntArray,
    "SeparatrixId": vtk.vtkIntArray,
    "SeparatrixType": vtk.vtkSignedCharArray,
    "SeparatrixFunctionMaximum": vtk.vtkDoubleArray,
    "SeparatrixFunctionMinimum": vtk.vtkDoubleArray,
    "SeparatrixFunctionDifference": vtk.vtkDoubleArray,
    "NumberOfCriticalPointsOnBoundary": vtk.vtkSignedCharArray,
}
SEGMENTS = {name: vtk.vtkIntArray for name in ("AscendingManifold", "DescendingManifold", "MorseSmaleManifold")}

READERS = {
    ".vtp": vtk.vtkXMLPolyDataReader,
    ".vtu": vtk.vtkXMLUnstructuredGridReader,
    ".vti": vtk.vtkXMLImageDataReader,
    ".vtr": vtk.vtkXMLRectilinearGridReader,
    ".vts": vtk.vtkXMLStructuredGridReader,
}


def read(path):
    reader = READERS[path.suffix]()
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetErrorCode():
        sys.exit(f"{path}: VTK reports error {reader.GetErrorCode()}")
    return reader.GetOutput()


def arrays(attributes, wanted, where):
    found = {}
    for name, kind in wanted.items():
        array = kind.SafeDownCast(attributes.GetArray(name))
        if array is None:
            sys.exit(f"{where}: array {name} is no {kind.__name__}")
        found[name] = vtk_to_numpy(array)
    return found


def check(condition, text):
    if not condition:
        sys.exit(f"FAILED: {text}")


def only(folder, ending):
    found = sorted(folder.glob(f"*{ending}"))
    check(len(found) == 1, f"{len(found)} files *{ending} in {folder}")
    return found[0]


def picture(path, segmentation, critical, lines):
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=(1600, 1200))
    ground = pyvista.wrap(segmentation)
    volume = max(ground.dimensions) if hasattr(ground, "dimensions") else 0
    flat = volume and min(ground.dimensions) == 1 or isinstance(ground, pyvista.PolyData)
    plotter.add_mesh(ground, scalars="MorseSmaleManifold", cmap="prism", opacity=1.0 if flat else 0.08, show_scalar_bar=False)
    plotter.add_mesh(pyvista.wrap(lines), scalars="SeparatrixType", cmap="cool", line_width=3, show_scalar_bar=False)
    plotter.add_mesh(
        pyvista.wrap(critical), scalars="CellDimension", cmap="coolwarm", point_size=12, render_points_as_spheres=True,
        show_scalar_bar=False,
    )
    if flat and not isinstance(ground, pyvista.PolyData):
        plotter.view_xy()
    plotter.screenshot(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--picture")
    options = parser.parse_args()
    critical = read(only(options.folder, "CriticalPoints.vtp"))
    lines = read(only(options.folder, "1Separatrices.vtp"))
    segmentation = read(only(options.folder, "Segmentation.vt?"))

    points = arrays(critical.GetPointData(), CRITICAL, "critical points")
    check(critical.GetPointData().GetScalars().GetName() == "CellDimension", "CellDimension is not active")
    check(critical.GetNumberOfVerts() == critical.GetNumberOfPoints() == critical.GetNumberOfCells(), "one vertex cell a point")
    inside = arrays(lines.GetPointData(), LINE_POINTS, "separatrices, points")
    steps = arrays(lines.GetCellData(), LINE_CELLS, "separatrices, cells")
    labels = arrays(segmentation.GetPointData(), SEGMENTS, "segmentation")
    if lines.GetNumberOfCells():
        check(lines.GetCellData().GetScalars().GetName() == "SeparatrixType", "SeparatrixType is not active")
    check(lines.GetNumberOfLines() == lines.GetNumberOfCells(), "only lines")

    dimension = points["CellDimension"].max()
    ends = {(d, i) for d, i in zip(points["CellDimension"], points["CellId"])}
    check(len(ends) == critical.GetNumberOfPoints(), "cell ids repeat")
    connectivity = vtk_to_numpy(lines.GetLines().GetConnectivityArray()).reshape(-1, 2)
    number = steps["SeparatrixId"]
    starts = np.flatnonzero(np.diff(number, prepend=-1))
    stops = np.append(starts[1:], len(number)) - 1
    where = {key: np.array(critical.GetPoint(k)) for k, key in enumerate(zip(points["CellDimension"], points["CellId"]))}
    positions = vtk_to_numpy(lines.GetPoints().GetData()) if lines.GetNumberOfPoints() else np.zeros((0, 3))
    for start, stop in zip(starts, stops):
        first, last = connectivity[start, 0], connectivity[stop, 1]
        check((connectivity[start:stop, 1] == connectivity[start + 1 : stop + 1, 0]).all(), "a separatrix has a gap")
        check(inside["CellId"][first] == steps["SourceId"][start], "a separatrix does not begin at its source")
        check(inside["CellId"][last] == steps["DestinationId"][start], "a separatrix does not end at its destination")
        check(inside["ttkMaskScalarField"][first] == 0 == inside["ttkMaskScalarField"][last], "mask of ends")
        for point in (first, last):
            key = (inside["CellDimension"][point], inside["CellId"][point])
            check(key in where and np.array_equal(where[key], positions[point]), f"end {key} is no critical point")
    check((steps["SeparatrixFunctionDifference"] >= 0).all(), "negative difference")
    for name, ends_in in (("DescendingManifold", 0), ("AscendingManifold", dimension)):
        sizes = points["ManifoldSize"][points["CellDimension"] == ends_in]
        counted = np.bincount(labels[name][labels[name] >= 0], minlength=len(sizes))
        check((counted == sizes).all(), f"{name} and ManifoldSize disagree")
    both = labels["MorseSmaleManifold"]
    check(set(np.unique(both)) - {-1} == set(range(both.max() + 1)), "MorseSmaleManifold is not dense")
    print(f"passed: {critical.GetNumberOfPoints()} critical points, {len(starts)} separatrices, {both.max() + 1} regions")
    if options.picture:
        picture(options.picture, segmentation, critical, lines)


if __name__ == "__main__":
    main()

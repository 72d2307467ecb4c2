"""Writes small VTK files of every kind in every encoding with real VTK.

    python tools/vtk/generate.py FOLDER

`roundtrip.py FOLDER` then compares; the tests under tests/it/io read a copy of the folder (tests/it/io/files; .vtkhdf files under
hdf). Every file of one kind holds the same data, so a test can compare the files with each other. Needs the packages vtk and numpy.
"""

import os
import sys

import numpy as np
import vtk
from vtk.util import numpy_support
from vtk.util.vtkAlgorithm import VTKPythonAlgorithmBase

OUT = sys.argv[1]
os.makedirs(OUT, exist_ok=True)
WRITERS = {
    "vtkPolyData": ("vtp", vtk.vtkXMLPolyDataWriter, vtk.vtkPolyDataWriter),
    "vtkUnstructuredGrid": ("vtu", vtk.vtkXMLUnstructuredGridWriter, vtk.vtkUnstructuredGridWriter),
    "vtkImageData": ("vti", vtk.vtkXMLImageDataWriter, vtk.vtkStructuredPointsWriter),
    "vtkRectilinearGrid": ("vtr", vtk.vtkXMLRectilinearGridWriter, vtk.vtkRectilinearGridWriter),
    "vtkStructuredGrid": ("vts", vtk.vtkXMLStructuredGridWriter, vtk.vtkStructuredGridWriter),
}


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


def write_xml(dataset, name, mode="appended", base64=False, packer="None", header=64, big=False, pieces=1):
    extension, writer, _ = WRITERS[dataset.GetClassName()]
    writer = writer()
    writer.SetInputData(dataset)
    writer.SetFileName(f"{OUT}/{name}.{extension}")
    {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary, "appended": writer.SetDataModeToAppended}[mode]()
    writer.SetEncodeAppendedData(base64)
    getattr(writer, f"SetCompressorTypeTo{packer}")()
    writer.SetHeaderTypeToUInt32() if header == 32 else writer.SetHeaderTypeToUInt64()
    writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
    writer.SetBlockSize(64)
    if pieces > 1:
        writer.SetNumberOfPieces(pieces)
    assert writer.Write() == 1


def write_legacy(dataset, name, version, binary):
    writer = WRITERS[dataset.GetClassName()][2]()
    writer.SetInputData(dataset)
    writer.SetFileName(f"{OUT}/{name}.vtk")
    writer.SetFileVersion(version)
    writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
    writer.Write()


for mode, base64 in (("binary", False), ("appended", True), ("appended", False)):
    for packer in ("None", "ZLib", "LZ4", "LZMA"):
        for header in (32, 64):
            form = mode if mode == "binary" else "base64" if base64 else "raw"
            write_xml(image(), f"image_{form}_{packer.lower()}_{header}", mode, base64, packer, header)
write_xml(image(), "image_ascii", "ascii")
write_xml(image(), "image_big_endian", packer="ZLib", header=32, big=True)
write_xml(image(), "image_big_endian_inline", "binary", big=True)
KINDS = {"image": image, "rectilinear": rectilinear, "structured": structured, "poly": poly, "unstructured": unstructured}
for kind, make in KINDS.items():
    if kind != "image":
        write_xml(make(), f"{kind}_ascii", "ascii")
        write_xml(make(), f"{kind}_raw_zlib_64", packer="ZLib")
    for version in (42, 51):
        for binary in (False, True):
            write_legacy(make(), f"{kind}_{version}_{'binary' if binary else 'ascii'}", version, binary)
write_xml(turned(), "turned_raw_none_64")
write_xml(unstructured(True), "polyhedron_raw_zlib_64", packer="ZLib")
write_xml(unstructured(True), "polyhedron_ascii", "ascii")
write_legacy(unstructured(True), "polyhedron_42_binary", 42, True)
write_legacy(unstructured(True), "polyhedron_51_ascii", 51, False)
write_xml(poly(), "poly_two_pieces", packer="ZLib", pieces=2)
write_xml(vtk.vtkPolyData(), "empty", packer="ZLib")
empty = vtk.vtkUnstructuredGrid()
empty.SetPoints(vtk.vtkPoints())
write_xml(empty, "empty_base64", base64=True, packer="ZLib", header=32)
write_legacy(empty, "empty_42_ascii", 42, False)


class Source(VTKPythonAlgorithmBase):
    """A data set that changes with time: the values, and the places of points where it has any."""

    TIMES = [0.0, 0.5, 2.0]

    def __init__(self, whole):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=0, nOutputPorts=1, outputType=whole.GetClassName())
        self.whole = whole

    def RequestInformation(self, _request, _inputs, outputs):
        information = outputs.GetInformationObject(0)
        pipeline = vtk.vtkStreamingDemandDrivenPipeline
        information.Set(pipeline.TIME_STEPS(), self.TIMES, len(self.TIMES))
        information.Set(pipeline.TIME_RANGE(), [self.TIMES[0], self.TIMES[-1]], 2)
        if self.whole.IsA("vtkImageData"):
            information.Set(pipeline.WHOLE_EXTENT(), self.whole.GetExtent(), 6)
        return 1

    def RequestData(self, _request, _inputs, outputs):
        key = vtk.vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
        information = outputs.GetInformationObject(0)
        time = information.Get(key) if information.Has(key) else self.TIMES[0]
        step = self.TIMES.index(time)
        output = vtk.vtkDataObject.GetData(outputs)
        output.ShallowCopy(self.whole)
        if not self.whole.IsA("vtkImageData"):
            places = numpy_support.vtk_to_numpy(self.whole.GetPoints().GetData())
            output.SetPoints(vtk_points(places + [step, 0, 0]))
        output.GetPointData().AddArray(array("speed", np.arange(output.GetNumberOfPoints()) * 0.25 + step))
        output.GetCellData().AddArray(array("material", np.arange(output.GetNumberOfCells(), dtype=np.int32) + 100 * step))
        output.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), time)
        return 1


def stored(dataset, only=None):
    """Without the arrays that VTK's writer of VTKHDF refuses, or with a few only."""
    points = dataset.GetPointData()
    for name in [points.GetArrayName(i) for i in range(points.GetNumberOfArrays())]:
        if name in ("labels", "bits") or (only and name not in only):
            points.RemoveArray(name)
    return dataset


def write_hdf(source, name, level=0, steps=False):
    writer = vtk.vtkHDFWriter()
    if steps:
        writer.SetInputConnection(source.GetOutputPort())
    else:
        writer.SetInputData(source)
    writer.SetFileName(f"{OUT}/{name}.vtkhdf")
    # Chunks are written whole.
    writer.SetChunkSize(16)
    writer.SetCompressionLevel(level)
    writer.SetWriteAllTimeSteps(steps)
    assert writer.Write() == 1


for kind, make in {**KINDS, "turned": turned, "polyhedron": lambda: unstructured(True)}.items():
    write_hdf(stored(make()), kind)
write_hdf(stored(poly()), "poly_packed", level=4)
write_hdf(vtk.vtkPolyData(), "empty")
parts, blocks = vtk.vtkPartitionedDataSet(), vtk.vtkMultiBlockDataSet()
for part in range(2):
    parts.SetPartition(part, stored(unstructured(True), ["speed"]))
    blocks.SetBlock(part, stored([poly, unstructured][part](), ["speed"]))
write_hdf(parts, "parts")
write_hdf(blocks, "blocks")
write_hdf(Source(stored(unstructured(True), ["speed"])), "steps", steps=True)
write_hdf(Source(stored(image(), ["speed"])), "steps_image", steps=True)

"""Writes small VTK files of every kind in every encoding with real VTK.

    python tools/vtk/generate.py FOLDER

`roundtrip.py FOLDER` then compares; the tests under tests/it/io read a copy of the folder (tests/it/io/files; .vtkhdf files under
hdf). Every file of one kind holds the same data, so a test can compare the files with each other. Needs the packages vtk and numpy.
"""

import os
import sys

import vtk

import numpy as np
from vtkmodules.util import numpy_support
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase

from samples import KINDS, array, empty, image, poly, turned, unstructured, vtk_points

OUT = sys.argv[1]
os.makedirs(OUT, exist_ok=True)
WRITERS = {
    "vtkPolyData": ("vtp", vtk.vtkXMLPolyDataWriter, vtk.vtkPolyDataWriter),
    "vtkUnstructuredGrid": ("vtu", vtk.vtkXMLUnstructuredGridWriter, vtk.vtkUnstructuredGridWriter),
    "vtkImageData": ("vti", vtk.vtkXMLImageDataWriter, vtk.vtkStructuredPointsWriter),
    "vtkRectilinearGrid": ("vtr", vtk.vtkXMLRectilinearGridWriter, vtk.vtkRectilinearGridWriter),
    "vtkStructuredGrid": ("vts", vtk.vtkXMLStructuredGridWriter, vtk.vtkStructuredGridWriter),
}


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
nothing = empty()
write_xml(nothing, "empty_base64", base64=True, packer="ZLib", header=32)
write_legacy(nothing, "empty_42_ascii", 42, False)


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

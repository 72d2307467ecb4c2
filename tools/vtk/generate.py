"""Writes small VTK files of every kind in every encoding with real VTK.

    python tools/vtk/generate.py FOLDER

`roundtrip.py FOLDER` then compares; the tests under tests/it/io read a copy of the folder (tests/it/io/files). Every file of
one kind holds the same data, so a test can compare the files with each other. Needs the packages vtk and numpy.
"""

import os
import sys

import vtk

from samples import KINDS, empty, image, poly, turned, unstructured

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

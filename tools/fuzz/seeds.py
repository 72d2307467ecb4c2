"""Fills tools/fuzz/corpus with small valid files, from which the targets set out. Needs nothing but Python.

    python tools/fuzz/seeds.py

The files of VTK are those of the tests, and small lists of such files; those of the mesh formats are written here. The first
byte of a mesh is the place of its extension in EXTENSIONS, as in targets/mesh.rs.
"""

import pathlib
import shutil
import struct
import zlib

HERE = pathlib.Path(__file__).resolve().parent
FILES = HERE / "../../tests/it/io/files"
EXTENSIONS = ["obj", "off", "ply", "stl", "mesh", "msh", "csv", "png", "npy", "tsv"]
FACE = "<Points><DataArray type='Float32' NumberOfComponents='3'>0 0 0 1 0 0 0 1 0</DataArray></Points>"
XML = {
    "image.vti": "<VTKFile type='ImageData'><ImageData WholeExtent='0 1 0 1 0 0' Spacing='1 2 3'><Piece Extent='0 1 0 1 0 0'><PointData "
    "Scalars='h'><DataArray type='Float64' Name='h'>1 2 3 4.5</DataArray></PointData></Piece></ImageData></VTKFile>",
    "face.vtp": f"<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='3' NumberOfPolys='1'>{FACE}<Polys><DataArray type='Int32' "
    "Name='connectivity'>0 1 2</DataArray><DataArray type='Int32' Name='offsets'>3</DataArray></Polys></Piece></PolyData></VTKFile>",
    "face.vtu": f"<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='3' NumberOfCells='1'>{FACE}<Cells>"
    "<DataArray type='Int64' Name='connectivity'>0 1 2</DataArray><DataArray type='Int64' Name='offsets'>3</DataArray>"
    "<DataArray type='UInt8' Name='types'>5</DataArray></Cells><CellData><DataArray type='Bit' Name='b'>1</DataArray>"
    "<Array type='String' Name='s'>65 66 0</Array></CellData></Piece></UnstructuredGrid></VTKFile>",
    "steps.pvd": "<VTKFile type='Collection'><Collection><DataSet timestep='0.5' file='a.vtp'/></Collection></VTKFile>",
    "blocks.vtm": "<VTKFile type='vtkMultiBlockDataSet'><vtkMultiBlockDataSet><Block index='0' name='a'><DataSet index='0' file='a.vtu'/>"
    "<DataSet index='1'/></Block></vtkMultiBlockDataSet></VTKFile>",
    "pieces.pvtu": "<VTKFile type='PUnstructuredGrid'><PUnstructuredGrid GhostLevel='1'><PPoints><PDataArray type='Float32' "
    "NumberOfComponents='3'/></PPoints><Piece Source='a.vtu'/></PUnstructuredGrid></VTKFile>",
}
TEXTS = [
    ("obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1 2/1/1 3//1 -1\nl 1 4\np 2\n"),
    ("off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 2 255 0 0\n"),
    ("off", "COFF # c\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n0 1 0 0 0 1 1\n3 0 1 2\n"),
    (
        "ply",
        "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nelement edge 1\n"
        "property int vertex1\nproperty int vertex2\nend_header\n0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n0 2\n",
    ),
    ("stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n"),
    (
        "mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\nRidges\n1\n1\nTriangles 1\n1 2 3 5\n"
        "Tetrahedra\n1\n1 2 3 4 6\nEnd\n",
    ),
    (
        "msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n10 0 0 0\n20 1 0 0\n30 0 1 0\n$EndNodes\n$Elements\n1\n7 2 2 3 1 10 20 30\n"
        '$EndElements\n$NodeData\n1\n"t"\n1\n0.0\n3\n0\n1\n2\n10 1.5\n30 2.5\n$EndNodeData\n',
    ),
    (
        "msh",
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 0 1 3 0\n$EndEntities\n$Nodes\n1 3 10 30\n2 1 0 3\n10\n20\n"
        "30\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n$Elements\n1 1 7 7\n2 1 2 1\n7 10 20 30\n$EndElements\n",
    ),
    ("csv", "x;y;z\n1;2;3\n2,5;-1;0\n3;4;1e9\n4;;2\n"),
    ("csv", '# c\nday,"a ""b"""\n2001-01-01,1\n2001-02-01T12:00Z,NA\n2001-Q2,2\n'),
    ("tsv", "a\tb\n1\t2,5\n2\t3\n"),
]


def binary_ply(order):
    """A triangle with a value a face, in either byte order."""
    mark, name = {"little": "<", "big": ">"}[order], f"binary_{order}_endian"
    head = (
        f"ply\nformat {name} 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face 1\n"
        "property list uchar int vertex_indices\nproperty short part\nend_header\n"
    )
    return head.encode() + struct.pack(mark + "9dB3ih", 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2, -7)


def binary_stl():
    return bytes(80) + struct.pack("<I12fH", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)


def binary_gmsh(mark):
    nodes = struct.pack(mark + "4Q3iQ3Q9d", 1, 3, 1, 3, 2, 1, 0, 3, 1, 2, 3, 0, 0, 0, 1, 0, 0, 0, 1, 0)
    elements = struct.pack(mark + "4Q3iQ4Q", 1, 1, 1, 1, 2, 1, 2, 1, 5, 1, 2, 3)
    head = b"$MeshFormat\n4.1 1 8\n" + struct.pack(mark + "i", 1) + b"\n$EndMeshFormat\n"
    return head + b"$Nodes\n" + nodes + b"\n$EndNodes\n$Elements\n" + elements + b"\n$EndElements\n"


def png(depth, colour, channels):
    """Three by two samples."""
    line = bytes([0]) + bytes(range(3 * channels * depth // 8))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = chunk(b"IHDR", struct.pack(">2I5B", 3, 2, depth, colour, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(line * 2)) + chunk(b"IEND", b"")


def npy(kind, fortran, version):
    head = f"{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': (2, 3), }}".ljust(117) + "\n"
    length = struct.pack("<H" if version == 1 else "<I", len(head))
    return b"\x93NUMPY" + bytes([version, 0]) + length + head.encode() + bytes(6 * int(kind[2:]))


def meshes():
    yield from ((extension, text.encode()) for extension, text in TEXTS)
    yield from (("ply", binary_ply(order)) for order in ("little", "big"))
    yield "stl", binary_stl()
    yield from (("msh", binary_gmsh(mark)) for mark in "<>")
    yield from (("png", png(*form)) for form in ((8, 0, 1), (16, 0, 1), (8, 2, 3), (8, 6, 4), (16, 4, 2)))
    yield from (("npy", npy(*form)) for form in (("<f8", False, 1), (">f4", True, 1), ("|u1", False, 2), ("<i8", True, 1)))


def folder(target):
    result = HERE / "corpus" / target
    result.mkdir(parents=True, exist_ok=True)
    return result


def main():
    for path in sorted(FILES.iterdir()):
        if path.is_file():
            shutil.copy(path, folder("legacy" if path.suffix == ".vtk" else "xml") / path.name)
    for name, text in XML.items():
        (folder("xml") / name).write_text(text)
    for number, (extension, data) in enumerate(meshes()):
        (folder("mesh") / f"{number}.{extension}").write_bytes(bytes([EXTENSIONS.index(extension)]) + data)


if __name__ == "__main__":
    main()

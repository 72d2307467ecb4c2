"""Writes small files of every kind with PyVista's `save`, and copies the example files that come with it.

    python tools/vtk/generate_pyvista.py FOLDER

`roundtrip.py FOLDER` then compares. Needs the package pyvista; nothing is downloaded.
"""

import os
import shutil
import sys

import numpy as np
import pyvista as pv
from pyvista import examples

OUT = sys.argv[1]
MOST_BYTES = 3_000_000
PACKERS = (None, "zlib", "lz4", "lzma")


def dressed(mesh):
    """A data set with what only PyVista's users tend to have."""
    n, cells = mesh.n_points, mesh.n_cells
    steps = np.arange(n)
    mesh.point_data["height"] = steps * 0.1
    mesh.point_data["inside"] = steps % 3 == 0
    mesh.point_data["wave"] = np.exp(0.7j * steps)
    mesh.point_data["single wave"] = np.exp(0.3j * steps).astype(np.complex64)
    mesh.point_data["h\u00f6he"] = [f"p {step}" for step in steps]
    mesh.point_data["stress"] = np.outer(steps, np.arange(9)).astype(np.float32)
    mesh.point_data["half"] = (steps * 0.5).astype(np.float16).astype(np.float32)
    mesh.point_data.active_texture_coordinates = np.stack([steps, steps * 0.5], 1).astype(np.float32)
    mesh.point_data.set_vectors(np.stack([steps, -steps, steps * 2], 1).astype(float), "flow")
    mesh.set_active_scalars("height")
    mesh.cell_data["mask"] = np.arange(cells) % 2 == 0
    mesh.cell_data["parts"] = np.arange(cells, dtype=np.uint16)
    mesh.field_data["names"] = ["a b", "<&>", ""]
    mesh.field_data["one word"] = "text"
    mesh.field_data["table"] = np.arange(6).reshape(2, 3)
    mesh.user_dict["note"] = {"by": ["hand", 1.5]}
    return mesh


def rectilinear():
    return pv.RectilinearGrid(np.array([0.0, 0.5, 2.0]), np.array([0.0, 1.0]), np.array([-1.0, 0.25], dtype=np.float32))


def structured():
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0))
    return pv.StructuredGrid(x, y, np.sin(x) + y)


def polyhedra():
    grid = pv.ImageData(dimensions=(3, 2, 2)).cast_to_unstructured_grid()
    return grid.to_polyhedra() if hasattr(grid, "to_polyhedra") else examples.cells.Polyhedron()


def mixed():
    """Linear cells of all kinds in one grid."""
    kinds = (examples.cells.Voxel, examples.cells.Hexahedron, examples.cells.Polyhedron, examples.cells.Triangle)
    return pv.merge([kind().translate((3.0 * place, 0, 0)) for place, kind in enumerate(kinds)])


def lines():
    result = pv.PolyData(np.arange(15.0).reshape(5, 3), lines=[3, 0, 1, 2, 2, 3, 4], verts=[1, 0])
    return result


KINDS = {
    "image": ("vti", lambda: pv.ImageData(dimensions=(3, 2, 2), spacing=(0.1, 0.2, 0.3), origin=(0.7, 0, -1), offset=(2, 0, -1))),
    "turned": ("vti", lambda: pv.ImageData(dimensions=(3, 2, 1), direction_matrix=[[0, 1, 0], [1, 0, 0], [0, 0, -1]])),
    "rectilinear": ("vtr", rectilinear),
    "structured": ("vts", structured),
    "sphere": ("vtp", lambda: pv.Sphere(theta_resolution=6, phi_resolution=5)),
    "lines": ("vtp", lines),
    "strip": ("vtp", lambda: pv.Plane(i_resolution=2, j_resolution=2).triangulate().strip()),
    "cloud": ("vtp", lambda: pv.PolyData(np.eye(3))),
    "mixed": ("vtu", mixed),
    "polyhedra": ("vtu", polyhedra),
    "explicit": ("vtu", lambda: examples.load_explicit_structured(dimensions=(3, 3, 2))),
}


def save(mesh, name, **options):
    mesh.save(os.path.join(OUT, name), **options)


def cell_names():
    """Every function of PyVista's that makes a cell: all types of VTK, those of higher order included."""
    for name in sorted(dir(examples.cells)):
        made = getattr(examples.cells, name)
        if name[0].isupper() and callable(made) and getattr(made, "__module__", "") == examples.cells.__name__:
            yield name, made


def main():
    os.makedirs(OUT, exist_ok=True)
    for name, (extension, make) in KINDS.items():
        for packer in PACKERS:
            save(dressed(make()), f"{name}_{packer}.{extension}".lower(), compression=packer)
        save(dressed(make()), f"{name}_ascii.{extension}", binary=False)
        # The legacy format knows no turned axes.
        for binary in (True, False) if name != "turned" else ():
            save(dressed(make()), f"{name}_{'binary' if binary else 'ascii'}.vtk", binary=binary)
    for extension in ("ply", "stl"):
        for binary in (True, False):
            save(pv.Sphere(theta_resolution=6, phi_resolution=5), f"sphere_{'binary' if binary else 'ascii'}.{extension}", binary=binary)
    colours = np.arange(3 * pv.Plane(i_resolution=2, j_resolution=2).n_points, dtype=np.uint8).reshape(-1, 3)
    save(pv.Plane(i_resolution=2, j_resolution=2), "coloured.ply", texture=colours)
    save(pv.Plane(i_resolution=2, j_resolution=2), "plane.obj")
    for name, make in cell_names():
        cell = make()
        if isinstance(cell, pv.UnstructuredGrid):
            cell["number"] = np.arange(cell.n_points) * 0.5
            save(cell, f"cell_{name}.vtu")
            save(cell, f"cell_{name}.vtk", binary=False)
    for name, mesh in (("points", pv.PolyData()), ("cells", pv.UnstructuredGrid()), ("grid", pv.StructuredGrid())):
        save(mesh, f"no_{name}.{ {'points': 'vtp', 'cells': 'vtu', 'grid': 'vts'}[name] }")
    blocks = pv.MultiBlock({"a b": dressed(pv.Sphere(theta_resolution=5, phi_resolution=4)), "nothing": None})
    blocks["within"] = pv.MultiBlock({"grid": dressed(structured()), "image": dressed(KINDS["image"][1]())})
    save(blocks, "blocks.vtm")
    save(pv.PartitionedDataSet([pv.Sphere(theta_resolution=5, phi_resolution=4), pv.Plane()]), "partitions.vtpd")
    for path in (value for name, value in vars(examples).items() if name.endswith("file") and isinstance(value, str)):
        if os.path.getsize(path) < MOST_BYTES and not path.endswith((".jpg", ".png")):
            shutil.copy(path, os.path.join(OUT, "example_" + os.path.basename(path)))
    print(len(os.listdir(OUT)), "files")


if __name__ == "__main__":
    main()

"""Persistence diagrams of VTK files in all dimensions, by GUDHI on the simplices that morsmooth made.

    pip install numpy==2.4.6 vtk==9.7.2 pyvista==0.49.1 gudhi==3.13.0
    cargo build --release --example persistence_diagram
    python tools/reference/gudhi_diagram.py FILE --array A [--mask M]
    python tools/reference/gudhi_diagram.py --data ../shared/data [--only NAME]

The diagrams are compared as multisets of (dimension, birth, death), bit for bit. Pairs of persistence 0 are left out: which of
them there are depends on how ties are broken. --data compares the seven reference fields, two tetrahedral meshes with
fields made here (heights with noise, and few levels, so with plateaus and ties), and two grids of measured values.
Exit code 0 if all diagrams are equal, 1 if not.
"""

import argparse
import collections
import pathlib
import subprocess
import sys
import tempfile
import time

import gudhi
import numpy as np
import pyvista

EXAMPLE = pathlib.Path(__file__).parents[2] / "target/release/examples/persistence_diagram"

FIELDS = [
    ("flow/jet_pivmat.vti", "vorticity_magnitude", "valid"),
    ("flow/soap_film.vti", "vorticity_magnitude", "valid"),
    ("flow/urban_canopy.vti", "vorticity_magnitude", "valid"),
    ("surfaces/fsaverage5_pial_left.vtp", "curv", None),
    ("surfaces/fsaverage5_pial_left.vtp", "sulc", None),
    ("surfaces/fsaverage5_pial_left.vtp", "thick", None),
    ("images/jacksboro_dem.vti", "elevation", "valid"),
    ("tets/spot_low_resolution_tet.vtu", "noisy height", None),
    ("tets/spot_low_resolution_tet.vtu", "levels", None),
    ("tets/hand.mesh", "noisy height", None),
    ("tets/hand.mesh", "levels", None),
    ("volumes/carotid.vtk", "scalars", None),
    ("volumes/epi_example4d_t0.vti", "intensity", None),
]


def medit(path):
    """Points and tetrahedra of a Medit text file."""
    words = path.read_text().split()

    def block(name, width):
        start = words.index(name) + 2
        count = int(words[start - 1])
        return np.array(words[start : start + count * width], dtype=float).reshape(count, width)

    points = block("Vertices", 4)[:, :3]
    tetrahedra = block("Tetrahedra", 5)[:, :4].astype(int) - 1
    return pyvista.UnstructuredGrid({pyvista.CellType.TETRA: tetrahedra}, points)


def with_fields(path, folder):
    """A copy of a tetrahedral mesh as .vtu with fields made here."""
    mesh = medit(path) if path.suffix == ".mesh" else pyvista.read(path)
    random = np.random.default_rng(7)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    place = (mesh.points - low) / (high - low).max()
    wave = np.sin(9 * place[:, 0]) + np.cos(11 * place[:, 1]) * np.sin(7 * place[:, 2])
    mesh.point_data["noisy height"] = place[:, 1] + 0.2 * random.standard_normal(mesh.n_points)
    mesh.point_data["levels"] = np.round(4 * wave + random.standard_normal(mesh.n_points)) / 4
    target = folder / f"{path.stem}.vtu"
    mesh.save(target)
    return target


def diagram(values, simplices):
    """Lower-star persistence in all dimensions: multiset of (dimension, birth, death)."""
    tree = gudhi.SimplexTree()
    tree.insert_batch(simplices.T.astype(np.int32), np.full(len(simplices), -np.inf))
    for vertex, value in enumerate(values):
        tree.assign_filtration([vertex], value)
    tree.make_filtration_non_decreasing()
    # The top dimension has no dimension above that could fill its classes, and matters for closed surfaces.
    pairs = tree.persistence(homology_coeff_field=2, min_persistence=0.0, persistence_dim_max=True)
    return collections.Counter((dimension, birth, death) for dimension, (birth, death) in pairs if birth != death)


def compare(path, array, mask):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        source = path
        if path.parent.name == "tets":
            source = with_fields(path, folder)
        command = [EXAMPLE, source, array, folder] + ([mask] if mask else [])
        says = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
        values = np.fromfile(folder / "values.f64", dtype="<f8")
        corners = np.fromfile(folder / "simplices.u32", dtype="<u4")
        lines = [line.split() for line in (folder / "pairs.txt").read_text().splitlines()]
    ours = collections.Counter(
        (int(dimension), float(birth), float(death)) for dimension, birth, death in lines if float(birth) != float(death)
    )
    simplices = corners.reshape(int(says.split()[2]), -1)
    start = time.perf_counter()
    theirs = diagram(values, simplices)
    seconds = time.perf_counter() - start
    same = ours == theirs
    counts = collections.Counter(dimension for dimension, *_ in ours.elements())
    print(f"{'equal' if same else 'DIFFERENT'}  {path.name} {array}: {says}")
    print(f"    of positive persistence by dimension {dict(sorted(counts.items()))}; GUDHI {seconds:.2f} s")
    for title, difference in [("only morsmooth", ours - theirs), ("only GUDHI", theirs - ours)]:
        for pair, count in list(difference.items())[:5]:
            print(f"    {title}: {pair} x {count}")
    sys.stdout.flush()
    return same


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file", nargs="?")
    parser.add_argument("--array")
    parser.add_argument("--mask")
    parser.add_argument("--data", metavar="DIR")
    parser.add_argument("--only", metavar="NAME", default="")
    arguments = parser.parse_args()
    if arguments.data:
        data = pathlib.Path(arguments.data)
        wanted = [row for row in FIELDS if arguments.only in row[0]]
        results = [compare(data / file, array, mask) for file, array, mask in wanted]
    elif arguments.file and arguments.array:
        results = [compare(pathlib.Path(arguments.file), arguments.array, arguments.mask)]
    else:
        parser.error("a file with --array, or --data, is needed")
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()

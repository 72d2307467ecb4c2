"""Extremum pairs of a VTK file by GUDHI, compared with those that morsmooth reports.

    pip install numpy==2.4.6 vtk==9.7.2 pyvista==0.49.1 gudhi==3.13.0
    python tools/reference/gudhi_pairs.py FILE --array A [--mask M] --report out.json
    python tools/reference/gudhi_pairs.py FILE --array A [--mask M] --program target/release/morsmooth
    python tools/reference/gudhi_pairs.py FILE --array A [--mask M] --example target/release/examples/extremum_pairs
    python tools/reference/gudhi_pairs.py FILE --array A [--mask M] --dump mesh.txt
    python tools/reference/gudhi_pairs.py --fields ../shared/data (--program target/release/morsmooth | --example E)
    python tools/reference/gudhi_pairs.py --noisy 512 --example target/release/examples/extremum_pairs

Pairs are those of dimension 0 of the lower-star filtration of h (minima) and of -h (maxima), as multisets of
(birth, death), compared bit for bit. Pairs of persistence 0 are left out: which of them there are depends on how ties are
broken. The report is JSON with two lists, both in values of h:

    minima_pairs: [[value of the minimum, value of its saddle, or null if it is essential], ...]
    maxima_pairs: [[value of the maximum, value of its saddle, or null if it is essential], ...]

Grids are triangulated with the diagonal (i,j)-(i+1,j+1), boxes with Kuhn's six tetrahedra; a simplex stays if all its
points are valid: the mask is not 0 and the value is a number. --fields compares the seven reference fields in a directory,
--noisy N a generated surface of N x N points: hills and white noise. The example
prints its own time in the same run: order of the vertices and pairs of both kinds.
Exit code 0 if all pairs are equal, 1 if not.
"""

import argparse
import collections
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import gudhi
import numpy as np
import pyvista

FIELDS = [
    ("flow/jet_pivmat.vti", "vorticity_magnitude", "valid"),
    ("flow/soap_film.vti", "vorticity_magnitude", "valid"),
    ("flow/urban_canopy.vti", "vorticity_magnitude", "valid"),
    ("surfaces/fsaverage5_pial_left.vtp", "curv", None),
    ("surfaces/fsaverage5_pial_left.vtp", "sulc", None),
    ("surfaces/fsaverage5_pial_left.vtp", "thick", None),
    ("images/jacksboro_dem.vti", "elevation", "valid"),
]

# What the example times between plain values and the pairs of both kinds.
STAGES = ["vertex order", "pairs of the minima", "pairs of the maxima"]


def grid_simplices(dimensions):
    """Kuhn's subdivision of a grid whose points are numbered x fastest; axes of one point are flat."""
    number = np.arange(np.prod(dimensions)).reshape(dimensions, order="F")
    axes = [axis for axis in range(3) if dimensions[axis] > 1]
    simplices = []
    for path in itertools.permutations(axes):
        offset = [0, 0, 0]
        corners = []
        for axis in (None, *path):
            if axis is not None:
                offset[axis] += 1
            ranges = tuple(
                slice(offset[a], dimensions[a] - 1 + offset[a]) if a in axes else slice(None) for a in range(3)
            )
            corners.append(number[ranges].ravel())
        simplices.append(np.stack(corners, axis=1))
    return np.concatenate(simplices)


def load(path, array, mask):
    """Values and simplices of the valid part of a file, vertices renumbered in their order."""
    mesh = pyvista.read(path)
    values = np.asarray(mesh.point_data[array]).astype(np.float64)
    if hasattr(mesh, "dimensions"):
        simplices = grid_simplices(mesh.dimensions)
    elif isinstance(mesh, pyvista.PolyData) and mesh.n_lines:
        lines = [np.array(mesh.get_cell(k).point_ids) for k in range(mesh.n_cells)]
        simplices = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    elif isinstance(mesh, pyvista.PolyData):
        if not mesh.is_all_triangles:
            sys.exit(f"error: {path} has cells that are no triangles")
        simplices = mesh.regular_faces
    else:
        of_type = mesh.cells_dict
        if len(of_type) != 1 or next(iter(of_type)) not in (3, 5, 10):
            sys.exit(f"error: {path} has cells of VTK types {sorted(of_type)}; expected one of 3, 5, 10")
        simplices = next(iter(of_type.values()))
    valid = np.isfinite(values)
    if mask is not None:
        valid &= np.asarray(mesh.point_data[mask]) != 0
    simplices = simplices[valid[simplices].all(axis=1)]
    used, renumbered = np.unique(simplices, return_inverse=True)
    return values[used], renumbered.reshape(simplices.shape)


def pairs(values, simplices):
    """Dimension 0 of the lower-star filtration: list of (birth, death), death inf for essential classes."""
    tree = gudhi.SimplexTree()
    tree.insert_batch(simplices.T.astype(np.int32), np.full(len(simplices), -np.inf))
    tree.insert_batch(np.arange(len(values), dtype=np.int32)[None, :], values)
    for vertex, value in enumerate(values):
        tree.assign_filtration([vertex], value)
    tree.make_filtration_non_decreasing()
    tree.compute_persistence(homology_coeff_field=2, min_persistence=0.0)
    return [tuple(pair) for pair in tree.persistence_intervals_in_dimension(0)]


def dump(path, values, simplices):
    with open(path, "w") as file:
        print(simplices.shape[1] - 1, len(values), len(simplices), file=file)
        print("\n".join(map(repr, values.tolist())), file=file)
        np.savetxt(file, simplices, fmt="%d")


def reported(arguments, path, array, mask, values, simplices):
    """The report as given, or as written by the program or the example."""
    if arguments.report:
        return json.loads(pathlib.Path(arguments.report).read_text())
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.json"
        if arguments.example:
            dump(pathlib.Path(folder) / "mesh.txt", values, simplices)
            command = [arguments.example, f"{folder}/mesh.txt", out]
        else:
            command = [arguments.program, "extrema", path, "--array", array, "--report", out]
            command += ["--mask", mask] if mask else []
        run = subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        stages = [line.split() for line in run.stderr.splitlines()]
        spent = [float(words[-2]) for words in stages if " ".join(words[:-2]) in STAGES]
        if len(spent) == len(STAGES):
            print(f"morsmooth: {sum(spent) / 1000:.3f} s for {', '.join(STAGES)}")
        return json.loads(out.read_text())


def compare(arguments, path, array, mask):
    values, simplices = load(path, array, mask)
    if arguments.dump:
        dump(arguments.dump, values, simplices)
        return True
    report = reported(arguments, path, array, mask, values, simplices)
    equal = True
    for name, sign in [("minima", 1.0), ("maxima", -1.0)]:
        start = time.perf_counter()
        by_gudhi = collections.Counter(
            (sign * birth, None if np.isinf(death) else sign * death)
            for birth, death in pairs(sign * values, simplices)
            if birth != death
        )
        seconds = time.perf_counter() - start
        listed = [tuple(pair) for pair in report[f"{name}_pairs"]]
        ours = collections.Counter((birth, death) for birth, death in listed if birth != death)
        same = ours == by_gudhi
        equal &= same
        print(
            f"{'equal' if same else 'DIFFERENT'}  {pathlib.Path(path).name} {array} {name}: {len(listed)} pairs, "
            f"{sum(ours.values())} of positive persistence, GUDHI {sum(by_gudhi.values())} in {seconds:.2f} s"
        )
        for title, difference in [("only morsmooth", ours - by_gudhi), ("only GUDHI", by_gudhi - ours)]:
            for pair, count in list(difference.items())[:5]:
                print(f"    {title}: {pair} x {count}")
    return equal


def noisy(folder, side):
    """A triangulated surface with hills and white noise, as a file."""
    place = np.linspace(0.0, 1.0, side)
    x, y = np.meshgrid(place, place)
    noise = np.random.default_rng(1).standard_normal((side, side))
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    triangles = grid_simplices((side, side, 1))
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles]).ravel()
    mesh = pyvista.PolyData(points, faces)
    mesh["noisy"] = (np.sin(9.0 * x) * np.cos(7.0 * y) + 0.3 * noise).ravel()
    path = str(pathlib.Path(folder) / "noisy.vtp")
    mesh.save(path)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file", nargs="?")
    parser.add_argument("--array")
    parser.add_argument("--mask")
    parser.add_argument("--fields", metavar="DIR")
    parser.add_argument("--noisy", metavar="N", type=int)
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--report", metavar="JSON")
    source.add_argument("--program", metavar="MORSMOOTH")
    source.add_argument("--example", metavar="EXTREMUM_PAIRS")
    source.add_argument("--dump", metavar="TEXT")
    arguments = parser.parse_args()
    if arguments.fields:
        if not (arguments.program or arguments.example):
            parser.error("--fields needs --program or --example")
        folder = pathlib.Path(arguments.fields)
        results = [compare(arguments, folder / file, array, mask) for file, array, mask in FIELDS]
    elif arguments.noisy:
        with tempfile.TemporaryDirectory() as folder:
            results = [compare(arguments, noisy(folder, arguments.noisy), "noisy", None)]
    elif arguments.file and arguments.array:
        results = [compare(arguments, arguments.file, arguments.array, arguments.mask)]
    else:
        parser.error("a file with --array, --fields or --noisy is needed")
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()

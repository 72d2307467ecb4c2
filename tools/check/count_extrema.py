#!/usr/bin/env python3
"""Count the minima and maxima of a point array of a VTK file, knowing nothing of morsmooth.

Usage:  python tools/check/count_extrema.py FILE --array NAME [--mask NAME] [--json]
Needs:  pip install numpy==2.4.6 vtk==9.7.2 pyvista==0.49.1

The neighbours of a point are those it shares an edge of a surviving simplex with. Grids of points are cut along the
diagonals (0,0,0)-(1,1,1), in 2-D (i,j)-(i+1,j+1); other cells as VTK triangulates them (simplices stay as they are).
A simplex survives if all its points are finite, and non-zero in --mask. Points of no surviving simplex do not count.

Two counts: under the strict order (value, point number), and under plain <, where equal neighbours are no extrema.
Counting compares the array in its stored precision.
"""
import argparse
import itertools
import json

import numpy as np
import pyvista as pv


def edges(mesh, ok):
    """Edges (a, b), a != b, of the simplices whose points are all in `ok`."""
    if hasattr(mesh, "dimensions"):  # image, rectilinear or structured grid
        number = np.arange(mesh.n_points).reshape(mesh.dimensions[::-1])
        axes = [a for a in range(3) if number.shape[a] > 1]
        cells = []
        for order in itertools.permutations(axes):  # a monotone path from corner to opposite corner is a simplex
            corner, path = [0, 0, 0], []
            for step in (None, *order):
                if step is not None:
                    corner[step] = 1
                path.append(number[tuple(slice(c, n - 1 + c if a in axes else n)
                                         for a, (c, n) in enumerate(zip(corner, number.shape)))].ravel())
            cells.append(np.stack(path, -1))
        cells = [np.concatenate(cells)]
    elif isinstance(mesh, pv.PolyData) and mesh.n_lines and not (mesh.n_verts or mesh.n_strips or len(mesh.faces)):
        lines, cells, at = mesh.lines, [], 0
        while at < len(lines):
            line = lines[at + 1:at + 1 + lines[at]]
            cells.append(np.stack([line[:-1], line[1:]], -1))
            at += lines[at] + 1
    elif isinstance(mesh, pv.PolyData):
        cells = [mesh.triangulate().faces.reshape(-1, 4)[:, 1:]]
    else:
        by_type = mesh.triangulate().cells_dict
        top = max(by_type, key={3: 1, 4: 1, 5: 2, 10: 3}.get)
        cells = [by_type[top]]
    cells = np.concatenate(cells)
    cells = cells[ok[cells].all(1)]
    return np.concatenate([cells[:, pair] for pair in itertools.combinations(range(cells.shape[1]), 2)])


def extrema(edge, value):
    """Point numbers of the minima and maxima: (value, number) order, then plain <."""
    a, b = np.concatenate([edge, edge[:, ::-1]]).T
    seen, result = np.unique(a), []
    for below in ((value[b] < value[a]) | ((value[b] == value[a]) & (b < a)), value[b] <= value[a]):
        result.append(np.setdiff1d(seen, a[below]))  # minima: no neighbour is below
        above = ~below if len(result) == 1 else value[b] >= value[a]
        result.append(np.setdiff1d(seen, a[above]))  # maxima: no neighbour is above
    return result


def count(path, array, mask=None):
    """The report for one array, as a dictionary."""
    mesh = pv.read(path)
    if array not in mesh.point_data:
        raise SystemExit(f"{path}: no point array {array!r}; found {sorted(mesh.point_data.keys())}")
    value = np.asarray(mesh.point_data[array])
    ok = np.isfinite(value)
    if mask is not None:
        ok &= np.asarray(mesh.point_data[mask]) != 0
    minima, maxima, strict_minima, strict_maxima = (ids.tolist() for ids in extrema(edges(mesh, ok), value))
    return {"file": path, "array": array, "dtype": str(value.dtype), "points": int(mesh.n_points),
            "minima": minima, "maxima": maxima, "strict_minima": strict_minima, "strict_maxima": strict_maxima}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--array", required=True)
    parser.add_argument("--mask")
    parser.add_argument("--json", action="store_true", help="print everything as one JSON object")
    given = parser.parse_args()
    report = count(given.file, given.array, given.mask)
    if given.json:
        print(json.dumps(report))
        return
    print(f"{given.file} {given.array} ({report['dtype']})")
    for name, key in (("(value, number) order", ""), ("plain <", "strict_")):
        low, high = report[key + "minima"], report[key + "maxima"]
        print(f"  {name}: {len(low)} minima, {len(high)} maxima")
        for kind, ids in (("minima", low), ("maxima", high)):
            if len(ids) <= 50:
                print(f"    {kind} at points", *ids)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Skinning weights at size: 16 handles in a solid of 22,528 vertices, and order 4 without data at 60,025 vertices.

Usage:  cargo build --release; python tools/bars/large_weights.py [--program target/release/morsmooth] [--threads N] [--only tets|order4]
Needs:  pip install numpy==2.4.6 scipy==1.17.1 pyvista==0.49.1

  tets    a jittered, bent bar of 88 x 16 x 16 points in tetrahedra, 16 point handles, one run a method: energy tr(W' L M^-1 L W), spurious
          extrema, seconds, peak memory. Bar: monotone weights have exactly the wanted extrema.
  order4  a jittered square of 245 x 245 points, two handles: the residual of polyharmonic and monotone weights of order 4: the
          componentwise backward error (largest entry of the gradient over the addends of its own row; Oettli, Prager 1964), multiplied through
          factor by factor. Bar: 1e-8, or refused.
Exit code 1 if a bar is missed.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
import pyvista as pv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from weight_scenes import ROOT, farthest_points, write_points  # noqa: E402


def bar():
    dims = (88, 16, 16)
    grid = pv.ImageData(dimensions=dims)
    points = np.array(grid.points)
    inside = np.all((points > 0) & (points < np.array(dims) - 1), axis=1)
    points[inside] += np.random.default_rng(7).uniform(-0.15, 0.15, (inside.sum(), 3))
    turn = points[:, 0] / 60.0
    radius = 60.0 + points[:, 1]
    points[:, :2] = np.column_stack([radius * np.sin(turn), radius * np.cos(turn)])
    # Six tetrahedra a cube, all around its diagonal.
    i, j, k = np.meshgrid(*(np.arange(size - 1) for size in dims), indexing="ij")
    at = lambda a, b, c: (i + a + dims[0] * ((j + b) + dims[1] * (k + c))).ravel()  # noqa: E731
    tets = []
    for axes in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        corner, path = np.zeros(3, int), [at(0, 0, 0)]
        for axis in axes:
            corner[axis] = 1
            path.append(at(*corner))
        tets.append(np.column_stack(path))
    return points, np.concatenate(tets)


def square(side):
    grid = pv.ImageData(dimensions=(side, side, 1))
    points = np.array(grid.points)
    inside = np.all((points[:, :2] > 0) & (points[:, :2] < side - 1), axis=1)
    points[inside, :2] += np.random.default_rng(1).uniform(-0.2, 0.2, (inside.sum(), 2))
    column = np.arange((side - 1) * (side - 1)) % (side - 1)
    row = np.arange((side - 1) * (side - 1)) // (side - 1)
    a = row * side + column
    return points, np.concatenate([np.column_stack([a, a + 1, a + side + 1]), np.column_stack([a, a + side + 1, a + side])])


def save(path, points, simplices):
    kind = {3: pv.CellType.TRIANGLE, 4: pv.CellType.TETRA}[simplices.shape[1]]
    cells = np.column_stack([np.full(len(simplices), simplices.shape[1]), simplices]).ravel()
    pv.UnstructuredGrid(cells, np.full(len(simplices), kind), points).save(path)


def run(args, mesh, handles, folder, *options):
    report = os.path.join(folder, "report.json")
    call = [args.program, "weights", mesh, os.path.join(folder, "out.vtu"), "--handles", handles, "--report", report, "--quiet",
            *map(str, options)] + (["--threads", str(args.threads)] if args.threads else [])
    child = subprocess.Popen(call, stderr=subprocess.PIPE, text=True)
    said = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode == 2:
        return None, said.strip()
    told = json.load(open(report))
    told["peak"] = usage.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
    told["processor"] = usage.ru_utime + usage.ru_stime
    return told, said.strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target/release/morsmooth"))
    parser.add_argument("--threads", type=int)
    parser.add_argument("--only", choices=["tets", "order4"])
    args = parser.parse_args()
    missed = []
    with tempfile.TemporaryDirectory() as folder:
        mesh, handles = os.path.join(folder, "mesh.vtu"), os.path.join(folder, "handles.json")
        if args.only != "order4":
            points, simplices = bar()
            save(mesh, points, simplices)
            write_points(handles, points, farthest_points(points, simplices, 16))
            print(f"{len(points)} vertices, {len(simplices)} tetrahedra, 16 handles, order 2")
            for method in ("polyharmonic", "bounded", "monotone"):
                told, said = run(args, mesh, handles, folder, "--method", method, "--partition", "free", "--keep-unaudited")
                if told is None:
                    missed.append(f"tets {method}: {said}")
                    continue
                spurious = sum(handle["audit"]["spurious"] for handle in told["handles"])
                print(f"  {method:<13} energy {told['energy']:.6e}, spurious extrema {spurious}, {told['seconds']['total']:.1f} s "
                      f"(processor {told['processor']:.1f}), peak {told['peak']:.0f} MB, factor of {told['factor_entries']} numbers", flush=True)
                if method == "monotone" and not told["passed"]:
                    missed.append("tets monotone: extrema")
        if args.only != "tets":
            points, simplices = square(245)
            save(mesh, points, simplices)
            write_points(handles, points, [20 * 245 + 30, 200 * 245 + 190])
            print(f"{len(points)} vertices, {len(simplices)} triangles, 2 handles, order 4")
            for method in ("polyharmonic", "monotone"):
                told, said = run(args, mesh, handles, folder, "--method", method, "--order", 4, "--partition", "free")
                if told is None:
                    print(f"  {method:<13} refused: {said}")
                    continue
                residual = max(handle["solver"]["residual"] for handle in told["handles"])
                print(f"  {method:<13} residual {residual:.1e}, mixed form: {told['mixed_form']}, passed: {told['passed']}, "
                      f"{told['seconds']['total']:.1f} s (processor {told['processor']:.1f}), peak {told['peak']:.0f} MB {said}", flush=True)
                if residual > 1e-8 or (method == "monotone" and not told["passed"]):
                    missed.append(f"order 4 {method}: residual {residual:.1e}, passed: {told['passed']}")
    print("\n" + ("\n".join(["MISSED"] + missed) if missed else "every bar met"))
    return 1 if missed else 0


if __name__ == "__main__":
    raise SystemExit(main())

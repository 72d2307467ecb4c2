#!/usr/bin/env python3
"""Weights beside libigl's: bounded biharmonic, harmonic and polyharmonic, on the same meshes and handles, in the same run.

Usage:  cargo build --release
        python tools/reference/libigl_weights.py [--program target/release/morsmooth] [--data ../shared/data] [--only NAME,NAME]
Needs:  pip install numpy==2.4.6 scipy==1.17.1 pyvista==0.49.1 libigl

  bounded       igl.bbw without partition of unity, its default tolerances: the same problem as --method bounded --order 2 --partition free.
                Bar: the energy is not above libigl's by more than 1e-6 of it, the largest difference is at most 1e-3 and shrinks with the
                tolerance (columns --gap 1e-6 and 1e-10), and the whole run of the program, reading and writing included, takes
                less processor time than the call of libigl.
  harmonic      igl.harmonic, k = 1: largest difference at most 1e-8.
  polyharmonic  igl.harmonic, k = 2: largest difference at most 1e-8 beside an error of libigl's own, measured against a solution refined
                to convergence in extended precision.
libigl's mass is mixed Voronoi on triangles and equal shares on tetrahedra, as is the program's default. Exit code 1 if a bar is missed.
"""
import argparse
import os
import sys
import tempfile
import time

import igl
import numpy as np
import pyvista as pv
import scipy.sparse as sp
import scipy.sparse.linalg as spl

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bars"))
from weight_scenes import ROOT, farthest_points, read_mesh, run_weights, write_points  # noqa: E402

SCENES = {
    "generated": (None, 4),
    "woody": ("planar/woody.obj", 5),
    "alligator": ("planar/alligator.obj", 6),
    "bump-domain": ("planar/bump-domain.obj", 4),
    "spot": ("surfaces/spot.obj", 4),
    "cactus_3d": ("tets/cactus_3d.mesh", 4),
    "bunny": ("tets/bunny.mesh", 4),
}


def refined(points, simplices, order, chosen):
    """The polyharmonic weights, refined with residuals in extended precision until they no longer change."""
    laplacian = (-igl.cotmatrix(points, simplices)).tocsr()
    mass = igl.massmatrix(points, simplices, igl.MASSMATRIX_TYPE_DEFAULT).diagonal()
    n = len(points)
    coo = laplacian.tocoo()
    off = coo.row != coo.col
    row, column, value = coo.row[off], coo.col[off], np.longdouble(coo.data[off])
    inverse = 1 / np.longdouble(mass)

    def apply(field):
        out = field
        for step in range(order):
            out = out * inverse if step else out
            image = np.zeros(n, np.longdouble)
            np.add.at(image, row, value * (out[column] - out[row]))
            out = image
        return out

    # apply() has L x = sum -w (x_j - x_i) with value = -w: the sign is right as it stands.
    formed = laplacian
    for _ in range(1, order):
        formed = formed @ sp.diags(1 / mass) @ laplacian
    free = np.setdiff1d(np.arange(n), chosen)
    solve = spl.splu(formed[free][:, free].tocsc())
    weights = np.zeros((n, len(chosen)))
    for handle, vertex in enumerate(chosen):
        field = np.zeros(n, np.longdouble)
        field[vertex] = 1
        before = np.inf
        for _ in range(60):
            step = solve.solve(np.float64(-apply(field)[free]))
            size = np.abs(step).max()
            if not np.isfinite(size) or size > 0.7 * before:
                break
            field[free] += step
            before = size
            if size < 1e-16:
                break
        weights[:, handle] = field
    return weights


def run_ours(args, folder, path, handles, *options):
    output = os.path.join(folder, "out.vtu")
    told = run_weights(args.program, path, output, handles, os.path.join(folder, "report.json"), "--partition", "free", *options)
    if "failed" in told:
        return None, told
    mesh = pv.read(output)
    return np.column_stack([mesh.point_data[handle["array"]] for handle in told["handles"]]), told


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target/release/morsmooth"))
    parser.add_argument("--data", default=os.path.join(ROOT, "../shared/data"))
    parser.add_argument("--only")
    args = parser.parse_args()
    missed = []
    with tempfile.TemporaryDirectory() as folder:
        for name in args.only.split(",") if args.only else SCENES:
            file, count = SCENES[name]
            path = os.path.join(args.data, file) if file else os.path.join(folder, "comb.vtp")
            if not file:
                from weights import generated
                generated(path)
            if not os.path.exists(path):
                print(f"{name}: skipped, {path} is not there")
                continue
            points, simplices = read_mesh(path)
            simplices = np.ascontiguousarray(simplices, dtype=np.int64)
            chosen = farthest_points(points, simplices, count)
            handles = os.path.join(folder, f"{name}.json")
            write_points(handles, points, chosen)
            at, values = np.array(chosen, dtype=np.int64), np.eye(len(chosen))
            print(f"{name}: {len(points)} vertices, {len(simplices)} simplices, {count} handles")

            for order, method in ((1, "harmonic"), (2, "polyharmonic")):
                theirs = igl.harmonic(points, simplices, at, values, order)
                ours, told = run_ours(args, folder, path, handles, "--method", method, "--order", order)
                if ours is None:
                    missed.append(f"{name} {method}: {told['failed']}")
                    continue
                exact = refined(points, simplices, order, chosen)
                difference = np.abs(ours - theirs).max()
                own, other = np.abs(ours - exact).max(), np.abs(theirs - exact).max()
                print(f"  {method:<13} differs from libigl by {difference:.1e}; from the refined solution: ours {own:.1e}, libigl {other:.1e}")
                if difference > 1e-8 + other or own > 1e-8:
                    missed.append(f"{name} {method}: {difference:.1e}")

            begin, clock = time.process_time(), time.perf_counter()
            theirs = igl.bbw(points, simplices, at, values)
            processor, wall = time.process_time() - begin, time.perf_counter() - clock
            energy = 0.0
            laplacian = igl.cotmatrix(points, simplices)
            inverse = sp.diags(1 / igl.massmatrix(points, simplices, igl.MASSMATRIX_TYPE_DEFAULT).diagonal())
            of = lambda weights: sum(float(column @ (laplacian @ (inverse @ (laplacian @ column)))) for column in weights.T)  # noqa: E731
            energy = of(theirs)
            for gap in ("1e-6", "1e-10"):
                ours, told = run_ours(args, folder, path, handles, "--method", "bounded", "--order", 2, "--gap", gap)
                if ours is None:
                    missed.append(f"{name} bounded: {told['failed']}")
                    continue
                difference, above = np.abs(ours - theirs).max(), of(ours) / energy - 1
                print(f"  bounded, gap {gap:<6} largest difference {difference:.1e}; energy {above:+.1e} of libigl's; values {ours.min():.1e} to "
                      f"{ours.max():.6f} (libigl {theirs.min():.1e} to {theirs.max():.6f}); processor {told['processor']:.2f} s, libigl {processor:.2f} s "
                      f"(wall {told['seconds']['total']:.2f}, {wall:.2f})", flush=True)
                if above > 1e-6 or difference > 1e-3:
                    missed.append(f"{name} bounded, gap {gap}: {difference:.1e}, energy {above:+.1e}")
                if gap == "1e-6" and told["processor"] >= processor:
                    missed.append(f"{name} bounded: {told['processor']:.2f} s, libigl {processor:.2f} s")
    print("\n" + ("\n".join(["MISSED"] + missed) if missed else "every bar met"))
    return 1 if missed else 0


if __name__ == "__main__":
    raise SystemExit(main())

#!/usr/bin/env python3
"""Colours given at four points of a letter J, spread by every method: who stays among the given colours, who invents others.

Usage:  python tools/bars/colours.py [--program target/release/morsmooth] [--pictures FOLDER]
Needs:  pip install numpy==2.4.6 vtk==9.7.2 pyvista==0.49.1

The shape and the message are those of figures 4 and 11 of Jacobson, Weinkauf, Sorkine 2012: unconstrained biharmonic colours leave the
gamut, bounded ones stay in it and oscillate, monotone ones do neither. The mesh has about as many triangles as the paper's (8,229).
What counts is read from the files with VTK and counted here, not by the program: vertices without a given colour at which a channel has
no lower or no higher neighbour (a plateau counts with all its vertices), vertices beyond the range of the given colours. Pixels whose
colour no screen can show are the program's count. A linear solve of order 4 may be refused as beyond double precision; that is shown.
Exit code 1 if monotone has any of them at order 2, 3 or 4, if polyharmonic of order 2 keeps within the gamut, or bounded of order 2 has
no spurious extremum.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
import pyvista as pv

LETTER = [(0, 2), (0.5, 0.8), (1.6, 0), (3, 0), (4.2, 0.8), (4.6, 2), (4.6, 7), (5.6, 7), (5.6, 8), (2.4, 8), (2.4, 7), (3.6, 7),
          (3.6, 2), (3.2, 1.2), (2.6, 1), (1.8, 1), (1.2, 1.3), (1, 2)]
COLOURS = [(4.1, 4.5, "#d02020"), (4.1, 6, "#909090"), (4.1, 3, "#2040c0"), (1.9, 0.5, "#f0e040")]


def spurious(values, triangles, given):
    """Vertices without a given colour that have no lower or no higher neighbour."""
    lower, higher = np.zeros((2, len(values)), bool)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        for i, j in ((triangles[:, a], triangles[:, b]), (triangles[:, b], triangles[:, a])):
            np.logical_or.at(lower, i, values[j] < values[i])
            np.logical_or.at(higher, i, values[j] > values[i])
    extreme = ~(lower & higher)
    extreme[given] = False
    return int(extreme.sum())


def run(program, folder, method, order):
    out = os.path.join(folder, f"{method}{order}")
    done = subprocess.run([program, "diffuse", f"{folder}/j.csv", f"{out}.png", f"{out}.vtp", "--colours", f"{folder}/c.csv", "--max-edge", "0.9%",
                    "--method", method, "--order", str(order), "--width", "400", "--quiet", "--report", f"{out}.json"], text=True, stderr=subprocess.PIPE)
    if done.returncode == 2:
        return done.stderr.splitlines()[0].split(": ", 2)[-1]
    if done.returncode != 0:
        raise SystemExit(f"{method} of order {order}: {done.stderr}")
    report, mesh = json.load(open(f"{out}.json")), pv.read(f"{out}.vtp")
    triangles = mesh.regular_faces
    colours = np.array([[int(c[k:k + 2], 16) / 255 for k in (1, 3, 5)] for *_, c in COLOURS])
    given = [int(np.argmin(np.hypot(mesh.points[:, 0] - x, mesh.points[:, 1] - y))) for x, y, _ in COLOURS]
    channels = np.array([mesh.point_data[name] for name in ("red", "green", "blue")]).T
    outside = ((channels < colours.min(0) - 1e-9) | (channels > colours.max(0) + 1e-9)).any(1)
    counts = [spurious(channels[:, k], triangles, given) for k in range(3)]
    seconds = np.mean([function["seconds"] for function in report["functions"]])
    return len(triangles), counts, int(outside.sum()), report["pixels"], seconds, np.abs(channels[given] - colours).max()


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=os.path.join(here, "..", "..", "target", "release", "morsmooth"))
    parser.add_argument("--pictures", help="folder that keeps the images")
    args = parser.parse_args()
    missed = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.pictures or temporary
        os.makedirs(folder, exist_ok=True)
        with open(f"{folder}/j.csv", "w") as text:
            text.write("x,y\n" + "".join(f"{x},{y}\n" for x, y in LETTER))
        with open(f"{folder}/c.csv", "w") as text:
            text.write("x,y,colour\n" + "".join(f"{x},{y},{c}\n" for x, y, c in COLOURS))
        print(f"{'method':>13} {'order':>5} {'triangles':>9} {'spurious r g b':>15} {'beyond given':>12} {'out of gamut':>20} {'s/function':>10}")
        for method, order in [("harmonic", 1), *((m, k) for k in (2, 3, 4) for m in ("polyharmonic", "bounded", "monotone"))]:
            found = run(args.program, folder, method, order)
            if isinstance(found, str):
                print(f"{method:>13} {order:>5} refused: {found}")
                if method == "monotone":
                    missed.append(f"monotone of order {order} is refused")
                continue
            triangles, counts, outside, pixels, seconds, moved = found
            gamut = pixels["out_of_gamut"]
            print(f"{method:>13} {order:>5} {triangles:>9} {'{} {} {}'.format(*counts):>15} {outside:>12} {gamut:>9} of {pixels['covered']:>7} {seconds:>10.3f}")
            if method == "monotone" and (sum(counts) or outside or gamut or moved):
                missed.append(f"monotone of order {order} has extrema or colours of its own")
            if (method, order) == ("polyharmonic", 2) and not (gamut and outside):
                missed.append("polyharmonic stays within the gamut: the scene shows nothing")
            if (method, order) == ("bounded", 2) and not sum(counts):
                missed.append("bounded does not oscillate: the scene shows nothing")
    for what in missed:
        print("MISSED", what)
    sys.exit(bool(missed))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Deform woody, an alligator, an outline of Italy and a photograph so far that ex-rotated skinning inverts at least 50 elements of each.

Usage:  python tools/pictures/deform.py [--data ../shared/data] [--out pictures] [--program target/release/morsmooth]
Needs:  pip install numpy pyvista

Runs `morsmooth deform` twice on each shape, by ex-rotated skinning and free of inversions, prints how many elements each leaves inverted
(by the program's audit and by VTK's points), and keeps a picture of both. Exit code 1 unless ex-rotated skinning inverts at least 50 elements and ours none.
"""
import argparse
import json
import os
import subprocess
import sys

import numpy as np
import pyvista

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")


def point(name, place, degrees=0.0, move=(0.0, 0.0)):
    return {"name": name, "point": list(place)}, {"rotation_degrees": degrees, "translation": list(move)}


def bone(name, root, tip, degrees=0.0, move=(0.0, 0.0)):
    return {"name": name, "bone": [list(root), list(tip)]}, {"rotation_degrees": degrees, "translation": list(move)}


# file: handles with their poses, edges of a cage, options
SCENES = {
    "woody": ("planar/woody.obj", [
        bone("belly", (172, 130), (172, 230)),
        bone("head", (170, 310), (170, 380), 60, (0, -50)),
        bone("left arm", (100, 245), (20, 245), 130, (25, -5)),
        bone("right arm", (245, 245), (325, 245), 130, (-25, -5)),
        bone("left leg", (140, 90), (110, 20), -100, (20, 20)),
        bone("right leg", (215, 90), (250, 20), 60, (0, 30)),
    ], [], []),
    "alligator": ("planar/alligator.obj", [
        bone("head", (230, 125), (40, 110), -100, (130, 10)),
        point("body", (470, 110)),
        bone("foreleg", (365, 50), (365, 15), 60, (20, 30)),
        bone("hindleg", (615, 50), (615, 15), -60, (-30, 30)),
        bone("tail", (750, 115), (960, 100), 160, (-150, 10)),
    ], [], []),
    "italy": ("planar/outline_italy.csv", [
        point("west", (5.5, 44.8), 90, (1.5, 0)),
        point("centre", (8.6, 43.2), -60, (1.0, 1.2)),
        point("heel", (13.0, 40.2), 120, (-3.0, 1.5)),
        point("toe", (11.6, 38.3), -120, (-1.0, 3.0)),
        point("east", (9.5, 46.3), -90, (-1.0, -1.0)),
    ], [], ["--max-edge", "1.5%"]),
    "photograph": ("images/astronaut.png", [
        *[point(f"corner {k}", (512 * (k in (1, 2)), 512 * (k > 1))) for k in range(4)],
        bone("face", (200, 400), (230, 400), 170),
        bone("shuttle", (400, 420), (430, 420), -190),
        bone("flag", (80, 190), (110, 190), -190),
        bone("suit", (250, 200), (280, 200), 190),
        bone("hand", (400, 110), (430, 110), 180),
    ], [[f"corner {k}", f"corner {(k + 1) % 4}"] for k in range(4)], ["--triangles", "60000"]),
}


def inverted(rest, result):
    """Elements whose determinant has another sign, from the files as VTK reads them."""
    before, after = pyvista.read(rest), pyvista.read(result)
    cells = next(iter(before.cells_dict.values())) if hasattr(before, "cells_dict") else before.regular_faces

    def area(mesh):
        a, b, c = np.moveaxis(mesh.points[cells][:, :, :2].astype(float), 1, 0)
        return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]

    return int((np.sign(area(before)) * np.sign(area(after)) <= 0).sum())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target", "release", "morsmooth"))
    parser.add_argument("--data", default=os.path.join(ROOT, "..", "shared", "data"))
    parser.add_argument("--out", default="pictures")
    parser.add_argument("--only", choices=SCENES)
    args = parser.parse_args()
    os.makedirs(args.out, exist_ok=True)
    missed = 0
    print("| shape | elements | inverted by ex-rotated skinning (VTK) | ours (VTK) | smallest det F, ours, in 32 bits | active | factorizations | duality gap | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, (file, rig, cage, options) in SCENES.items():
        if args.only not in (None, name):
            continue
        at = lambda ending: os.path.join(args.out, f"{name}_{ending}")
        json.dump({"handles": [handle for handle, _ in rig], "cage": cage}, open(at("handles.json"), "w"), indent=1)
        json.dump({"handles": {handle["name"]: pose for handle, pose in rig}}, open(at("pose.json"), "w"), indent=1)
        json.dump({"handles": {}}, open(at("rest.json"), "w"))
        told = {}
        mesh = os.path.join(args.data, file)
        for method, pose, more in [
            ("rest", "rest.json", ["--method", "ex-rotated", "--weight-method", "harmonic"]),
            ("ex-rotated", "pose.json", ["--method", "ex-rotated", "--keep-unaudited"]),
            ("inversion-free", "pose.json", []),
        ]:
            command = [args.program, "deform", mesh, at(method + ".vtu"), "--handles", at("handles.json"), "--pose", at(pose), *options, *more]
            command += ["--report", at(method + "_report.json"), "--plots", at(method), "--quiet"]
            if file.endswith(".png"):
                command += ["--out-image", at(method + ".png")]
            ended = subprocess.run(command, capture_output=True, text=True)
            told[method] = json.load(open(at(method + "_report.json"))) if ended.returncode < 2 else sys.exit(ended.stderr)
            if method == "inversion-free" and ended.returncode != 0:
                print(f"{name}: {ended.stderr.strip()}")
        count = lambda method: told[method]["result"]["audit"]["as_written"]["inverted"]
        seen = {method: inverted(at("rest.vtu"), at(method + ".vtu")) if os.path.exists(at(method + ".vtu")) else "-" for method in told}
        ours = told["inversion-free"]["result"]
        print(
            f"| {name} | {told['rest']['mesh']['elements']} | {count('ex-rotated')} ({seen['ex-rotated']}) | {count('inversion-free')} ({seen['inversion-free']}) "
            f"| {ours['audit']['in_32_bits']['smallest_det_F']:.2e} | {ours['active_constraints']} | {ours['effort']['factorizations']} "
            f"| {ours['certificate']['duality_gap']:.1e} | {told['inversion-free']['seconds']['deform']:.2f} |"
        )
        missed += count("ex-rotated") < 50 or seen["inversion-free"] != 0 or not ours["audit"]["passed"]
    sys.exit(1 if missed else 0)


main()

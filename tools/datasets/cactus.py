#!/usr/bin/env python3
"""datasets/cactus.csv, cactus_handles.json, cactus_pose.json, cactus_keys.json: a cactus of our own with five arms, to pose.

Source: made here, from nothing but the numbers below.
Needs:  pip install numpy contourpy
Usage:  python tools/datasets/cactus.py outline|handles|pose|keys [OUTPUT]

The outline is the level line of a smooth union of thick strokes, a place about every 0.09, rounded to four digits. Handles are bones: the
trunk, its top, and the four arms from the elbow to the tip. The pose turns arms and top; the keys go there and on.
"""
import json
import os
import sys

import numpy as np
from contourpy import contour_generator

STROKES = [  # places, radius
    ([(0.0, 0.0), (0.0, 6.0)], 0.62),
    ([(0.0, 1.5), (-1.9, 1.6), (-2.0, 2.7)], 0.36),
    ([(0.0, 2.2), (1.8, 2.3), (1.9, 3.5)], 0.38),
    ([(0.0, 3.6), (-1.5, 3.8), (-1.6, 5.2)], 0.32),
    ([(0.0, 4.5), (1.3, 4.8), (1.4, 6.0)], 0.30),
]
BLEND = 0.22
SPACING = 0.09
BONES = {
    "trunk": [(0.0, 0.2), (0.0, 3.0)],
    "top": [(0.0, 5.0), (0.0, 6.3)],
    "left_low": [(-1.93, 1.8), (-2.0, 2.7)],
    "right_low": [(1.82, 2.5), (1.9, 3.5)],
    "left_high": [(-1.52, 4.0), (-1.6, 5.2)],
    "right_high": [(1.32, 5.0), (1.4, 6.0)],
}
POSE = {"top": (-25, 0.0, 0.0), "left_low": (70, -0.3, 0.2), "right_low": (-80, 0.4, 0.1), "left_high": (55, -0.2, 0.0), "right_high": (-50, 0.2, -0.2)}


def distance(points, start, end):
    start, end = np.array(start), np.array(end)
    along = np.clip((points - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
    return np.linalg.norm(points - start - along[..., None] * (end - start), axis=-1)


def outline():
    x, y = np.linspace(-3, 3, 601), np.linspace(-1, 7, 801)
    points = np.stack(np.meshgrid(x, y), -1)
    field = np.zeros(points.shape[:2])
    for places, radius in STROKES:
        stroke = np.min([distance(points, a, b) for a, b in zip(places, places[1:])], axis=0) - radius
        field += np.exp(-stroke / BLEND)
    line = contour_generator(x, y, -BLEND * np.log(field)).lines(0.0)
    assert len(line) == 1, "one outline"
    line = line[0]
    length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    at = np.linspace(0, length[-1], int(round(length[-1] / SPACING)) + 1)[:-1]
    ring = np.stack([np.interp(at, length, line[:, axis]) for axis in (0, 1)], -1)
    return "x,y\n" + "".join(f"{a:.4f},{b:.4f}\n" for a, b in ring)


def handles():
    entries = [{"name": name, "bone": [list(place) for place in bone]} for name, bone in BONES.items()]
    return json.dumps({"handles": entries}, indent=1) + "\n"


def transforms(share):
    return {name: {"rotation_degrees": round(share * turn, 6), "translation": [round(share * x, 6), round(share * y, 6)]}
            for name, (turn, x, y) in POSE.items()}


def pose():
    return json.dumps({"handles": transforms(1.0)}, indent=1) + "\n"


def keys():
    return json.dumps({"keys": [{"time": time, "handles": transforms(share)}
                                for time, share in [(0, 0.0), (1, 1.0), (2, -0.6), (3, 0.0)]]}, indent=1) + "\n"


def main():
    kinds = {"outline": ("cactus.csv", outline), "handles": ("cactus_handles.json", handles),
             "pose": ("cactus_pose.json", pose), "keys": ("cactus_keys.json", keys)}
    if len(sys.argv) < 2 or sys.argv[1] not in kinds:
        raise SystemExit(f"found {sys.argv[1:]}; expected one of {', '.join(kinds)}")
    name, make = kinds[sys.argv[1]]
    here = os.path.dirname(os.path.abspath(__file__))
    path = sys.argv[2] if len(sys.argv) > 2 else os.path.join(here, "..", "..", "datasets", name)
    text = make()
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(text)
    print(path)


if __name__ == "__main__":
    main()

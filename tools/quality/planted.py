#!/usr/bin/env python3
"""Fields of known truth: 9 minima and 4 maxima planted, plus uniform noise.

Usage:  python tools/quality/planted.py FOLDER [--seeds 10] [--noise 2 5 10]
Needs:  pip install numpy pyvista

Writes FOLDER/planted_<noise>_<seed>.vti, 160 x 125 points, 1.59 x 1.24 in size, with the point arrays
  truth  sum of 9 gaussian pits, 4 gaussian hills and a gentle saddle, shifted and scaled to the range 0 to 1
  noisy  truth + noise, uniform in plus or minus <noise> percent of the range of truth
and FOLDER/planted.json: the vertices of the planted extrema and their persistence, by seed.

Centres, widths and heights are drawn anew for every seed, and drawn again until the sampled truth has exactly 9
minima and 4 maxima, boundary points counted, none of them on the boundary, under (value, number) order and under
plain <, and each with a persistence of at least 33 % of the range. Noise of +-10 % makes extrema of persistence up
to 20 % of the range.
"""
import argparse
import json
import os
import sys

import numpy as np
import pyvista as pv

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "check"))
from count_extrema import edges, extrema  # noqa: E402

NX, NY, STEP = 160, 125, 0.01
PITS, HILLS = 9, 4
LEAST_PERSISTENCE = 0.33


def persistences(edge, value):
    """{minimum: persistence} by union-find on (value, number); the lowest gets the whole range."""
    order = np.lexsort((np.arange(len(value)), value))
    rank = np.empty(len(value), int)
    rank[order] = np.arange(len(value))
    top = np.maximum(rank[edge[:, 0]], rank[edge[:, 1]])
    low = np.minimum(rank[edge[:, 0]], rank[edge[:, 1]])[np.argsort(top, kind="stable")]
    top.sort()
    parent, born = list(range(len(value))), {}

    def root(v):
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for a, b in zip(top.tolist(), low.tolist()):
        a, b, at = root(a), root(b), a
        if a != b:
            young, old = max(a, b), min(a, b)
            parent[young] = old
            if young != at:  # a vertex that joins its first lower component is no minimum
                born[int(order[young])] = float(value[order[at]] - value[order[young]])
    return born | {int(order[0]): float(np.ptp(value))}


def draw(random, x, y):
    """One candidate: places, widths and heights vary about a fixed layout.

    A hill beside the left and the right side and a pit beside the lower and the upper one leave no extremum on the
    boundary, and a gentle saddle x^2 - y^2 orders the corners. Every gap between pits leads up to a hill, so that no
    further maximum arises.
    """
    w, h = (NX - 1) * STEP, (NY - 1) * STEP
    hills = [(0.14, h / 2), (w - 0.14, h / 2), (w / 2, h / 2 - 0.26), (w / 2, h / 2 + 0.26)]
    pits = [(w / 2, 0.14), (w / 2, h - 0.14), (0.42, 0.30), (0.42, h - 0.30), (w - 0.42, 0.30), (w - 0.42, h - 0.30),
            (w / 2, h / 2), (0.5, h / 2), (w - 0.5, h / 2)]
    centres = np.array(hills + pits) + random.uniform(-0.03, 0.03, (HILLS + PITS, 2))
    heights = np.r_[np.ones(HILLS), -np.ones(PITS)] * random.uniform(0.95, 1.05, HILLS + PITS)
    widths = np.r_[[0.115] * 2, [0.07] * 2, [0.115] * 2, [0.07] * 7] * random.uniform(0.92, 1.08, HILLS + PITS)
    total = 0.13 * ((2 * x / w - 1) ** 2 - (2 * y / h - 1) ** 2)
    for centre, height, width in zip(centres, heights, widths):
        total += height * np.exp(-((x - centre[0]) ** 2 + (y - centre[1]) ** 2) / (2 * width ** 2))
    return (total - total.min()) / np.ptp(total)


def truth(seed, edge, x, y):
    """The first candidate of this seed that keeps what the page above promises, and its extrema."""
    random = np.random.default_rng(seed)
    rim = (x == x.min()) | (x == x.max()) | (y == y.min()) | (y == y.max())
    for attempt in range(20000):
        value = draw(random, x, y)
        low, high, strict_low, strict_high = extrema(edge, value)
        if (len(low), len(high)) != (PITS, HILLS) or rim[low].any() or rim[high].any():
            continue
        if len(strict_low) != PITS or len(strict_high) != HILLS:
            continue
        down, up = persistences(edge, value), persistences(edge, -value)
        if min(*(down[v] for v in low.tolist()), *(up[v] for v in high.tolist())) < LEAST_PERSISTENCE:
            continue
        return value, {"minima": {v: down[v] for v in low.tolist()}, "maxima": {v: up[v] for v in high.tolist()},
                       "drawn": attempt + 1}
    raise SystemExit(f"seed {seed}: no field found")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--noise", type=float, nargs="+", default=[2, 5, 10], help="percent of the range")
    given = parser.parse_args()
    os.makedirs(given.folder, exist_ok=True)
    grid = pv.ImageData(dimensions=(NX, NY, 1), spacing=(STEP, STEP, 1.0))
    x, y = grid.points[:, 0], grid.points[:, 1]
    edge, report = edges(grid, np.ones(NX * NY, bool)), {}
    for seed in range(given.seeds):
        value, report[seed] = truth(seed, edge, x, y)
        kept = report[seed]
        least = min(*kept["minima"].values(), *kept["maxima"].values())
        print(f"seed {seed}: field {kept['drawn']}, least persistence {least:.3f}")
        for percent in given.noise:
            out = grid.copy()
            random = np.random.default_rng([seed, round(1000 * percent)])
            out.point_data["truth"] = value
            out.point_data["noisy"] = value + 0.01 * percent * random.uniform(-1.0, 1.0, len(value))
            out.save(os.path.join(given.folder, f"planted_{percent:g}_{seed}.vti"))
    with open(os.path.join(given.folder, "planted.json"), "w") as text:
        json.dump(report, text, indent=1)


if __name__ == "__main__":
    main()

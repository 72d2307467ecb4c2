#!/usr/bin/env python3
"""Fields of known truth: 9 minima and 4 maxima planted, plus uniform noise.

Usage:  python tools/quality/planted.py FOLDER [--seeds 10] [--noise 2 5 10]
Needs:  pip install numpy==2.4.6 vtk==9.7.2 pyvista==0.49.1

Writes FOLDER/planted_<noise>_<seed>.vti, 160 x 125 points, 1.59 x 1.24 in size, with the point arrays
  truth  sum of 9 gaussian pits, 4 gaussian hills and a gentle saddle, shifted and scaled to the range 0 to 1
  noisy  truth + noise, uniform in plus or minus <noise> percent of the range of truth
and FOLDER/planted.json: the vertices of the planted extrema and their persistence, by seed.

The standard deviations of the gaussians are 0.117 to 0.160, 12 to 16 cells, so that the field is resolved as a measured one would
be. (With 0.07, 7 cells, the best smoothing length of order 2 leaves 0.22 of an error of +-2 %: the field itself is too rough.) Nine pits and four hills so wide overlap; the layout that keeps them apart was found by differential evolution over
centres, heights and widths with both mirror symmetries, for the greatest least persistence.

Centres, widths and heights are drawn anew about that layout for every seed, and drawn again until the sampled truth has exactly 9
minima and 4 maxima, boundary points counted, none of them on the boundary, under (value, number) order and under
plain <, and each with a persistence of at least 30 % of the range. Noise of +-10 % makes extrema of persistence up
to 20 % of the range.
"""
import argparse
import functools
import json
import os
import sys

import numpy as np
import pyvista as pv

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "check"))
from count_extrema import edges, extrema  # noqa: E402
from persistence import persistences  # noqa: E402

NX, NY, STEP = 160, 125, 0.01
WIDTH, HEIGHT = (NX - 1) * STEP, (NY - 1) * STEP
PITS, HILLS = 9, 4
LEAST_PERSISTENCE = 0.3
SADDLE = 0.16
# Centre in the lower left quarter, height, standard deviation; mirrored in x and y. Hills first.
LAYOUT = [
    ((0.255, HEIGHT / 2), 0.42, 0.126),
    ((WIDTH / 2, 0.295), 1.14, 0.149),
    ((0.373, 0.404), -1.72, 0.122),
    ((0.577, 0.020), -1.60, 0.131),
    ((WIDTH / 2, HEIGHT / 2), -1.93, 0.154),
]


def layout():
    """Centres, heights and standard deviations of the 13 gaussians."""
    rows = []
    for (x, y), height, deviation in LAYOUT:
        rows += [(*place, height, deviation) for place in dict.fromkeys((u, v) for v in (y, HEIGHT - y) for u in (x, WIDTH - x))]
    table = np.array(rows)
    return table[:, :2], table[:, 2], table[:, 3]


def draw(random):
    """Parameters of one candidate, varied about the layout."""
    centres, heights, deviations = layout()
    return (centres + random.uniform(-0.01, 0.01, centres.shape), heights * random.uniform(0.96, 1.04, len(heights)),
            deviations * random.uniform(0.96, 1.04, len(deviations)))


def sample(parameters, x, y):
    """The field before it is scaled; its saddle x^2 - y^2 orders the corners."""
    total = SADDLE * ((2 * x / WIDTH - 1) ** 2 - (2 * y / HEIGHT - 1) ** 2)
    for centre, height, deviation in zip(*parameters):
        total += height * np.exp(-((x - centre[0]) ** 2 + (y - centre[1]) ** 2) / (2 * deviation ** 2))
    return total


def empty_grid():
    return pv.ImageData(dimensions=(NX, NY, 1), spacing=(STEP, STEP, 1.0))


@functools.cache
def truth(seed):
    """The first candidate of this seed that keeps what the page above promises, its extrema, and its parameters."""
    random, grid = np.random.default_rng(seed), empty_grid()
    x, y = grid.points[:, 0], grid.points[:, 1]
    edge = edges(grid, np.ones(NX * NY, bool))
    i, j = np.arange(NX * NY) % NX, np.arange(NX * NY) // NX
    rim = (i == 0) | (i == NX - 1) | (j == 0) | (j == NY - 1)
    for attempt in range(2000):
        parameters = draw(random)
        value = sample(parameters, x, y)
        value = (value - value.min()) / np.ptp(value)
        low, high, strict_low, strict_high = extrema(edge, value)
        if (len(low), len(high)) != (PITS, HILLS) or rim[low].any() or rim[high].any():
            continue
        if len(strict_low) != PITS or len(strict_high) != HILLS:
            continue
        # The lowest and the highest extremum have the whole range.
        down, up = ({v: 1.0 if p is None else p for v, p in persistences(edge, value, maxima).items()} for maxima in (False, True))
        if min(*down.values(), *up.values()) < LEAST_PERSISTENCE:
            continue
        return value, {"minima": down, "maxima": up, "drawn": attempt + 1}, parameters
    raise SystemExit(f"seed {seed}: no field found")


def grid(seed, percent):
    """The truth and the noisy field of a seed."""
    value, result = truth(seed)[0], empty_grid()
    random = np.random.default_rng([seed, round(1000 * percent)])
    result.point_data["truth"] = value
    result.point_data["noisy"] = value + 0.01 * percent * random.uniform(-1.0, 1.0, len(value))
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--noise", type=float, nargs="+", default=[2, 5, 10], help="percent of the range")
    given = parser.parse_args()
    os.makedirs(given.folder, exist_ok=True)
    report = {}
    for seed in range(given.seeds):
        kept = report[seed] = truth(seed)[1]
        least = min(*kept["minima"].values(), *kept["maxima"].values())
        print(f"seed {seed}: field {kept['drawn']}, least persistence {least:.3f}")
        for percent in given.noise:
            grid(seed, percent).save(os.path.join(given.folder, f"planted_{percent:g}_{seed}.vti"))
    with open(os.path.join(given.folder, "planted.json"), "w") as text:
        json.dump(report, text, indent=1)


if __name__ == "__main__":
    main()

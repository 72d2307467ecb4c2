#!/usr/bin/env python3
"""datasets/elevation.vti and datasets/terrain.vti: ground elevation at the Jacksboro fault, Tennessee.

Source: PyPI matplotlib 3.11.2, mpl-data/sample_data/jacksboro_fault_dem.npz (3 arc seconds, whole metres).
Needs:  pip install numpy pyvista
Usage:  python tools/datasets/elevation.py elevation|terrain [OUTPUT]

terrain is the whole grid, 403 x 344; elevation its middle part, 144 x 120. Array `elevation` in metres; lengths in
metres, a degree of longitude shortened by the cosine of the mean latitude. Whole metres make plateaus: many
neighbours have equal values.
"""
import io
import sys

import numpy as np
import pyvista as pv

import archive

METRES_A_DEGREE = 111320.0


def main():
    which = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    if which not in ("elevation", "terrain"):
        raise SystemExit(__doc__)
    packed = np.load(io.BytesIO(archive.member(archive.fetch("matplotlib", "3.11.2"), "jacksboro_fault_dem.npz")))
    height = packed["elevation"][::-1].astype(np.float32)  # its rows run from north to south
    dx, dy = float(packed["dx"]) * METRES_A_DEGREE, float(packed["dy"]) * METRES_A_DEGREE
    dx *= np.cos(np.deg2rad(0.5 * (float(packed["ymin"]) + float(packed["ymax"]))))
    i, j = (0, 0) if which == "terrain" else (130, 110)
    ny, nx = height.shape if which == "terrain" else (120, 144)
    grid = pv.ImageData(dimensions=(nx, ny, 1), origin=(i * dx, j * dy, 0.0), spacing=(dx, dy, 1.0))
    grid.point_data["elevation"] = height[j:j + ny, i:i + nx].ravel()
    grid.save(archive.output(f"{which}.vti"))
    print(grid.dimensions, grid.get_data_range("elevation"))


if __name__ == "__main__":
    main()

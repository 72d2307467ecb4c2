#!/usr/bin/env python3
"""datasets/jet.vti: a 12 m/s air jet measured by particle image velocimetry (F. Moisy, Lab FAST).

Source: PyPI pivpy 0.4.0, pivpy/data/PIVMAT_jet/B00001.VC7 (DaVis 7 vector file, parsed below).
Needs:  pip install numpy pyvista
Usage:  python tools/datasets/jet.py [OUTPUT]

Arrays on the 128 x 128 grid, lengths in metres:
  velocity             m/s, 3 components, 0 where there is no vector
  vorticity            1/s, central differences, one-sided beside points without a vector
  vorticity_magnitude  1/s
  valid                1 where there is a vector and a vorticity; the bottom left corner was too dark to measure
"""
import struct

import numpy as np
import pyvista as pv

import archive


def read_vc7(data):
    """x, y [m]; u, v [m/s]; whether a vector was measured. Rows run upwards."""
    _, packing, layout, _, nx, ny, _, _, _, step = struct.unpack("<4h4i2h", data[:28])
    if layout != 3 or packing != 0:
        raise SystemExit(f"VC7 of layout {layout}, packing {packing}; expected 3 and 0")
    planes = np.frombuffer(data, "<f4", 10 * nx * ny, 256).reshape(10, ny, nx)
    text = data[256 + planes.nbytes:].decode("latin1")

    def scale(axis):  # attribute lines "factor \n offset \n unit"
        lines = text[text.index(f"FrameScale{axis}0=") + len("FrameScaleX0="):].split("\n")
        return float(lines[0]), float(lines[1])

    (sx, ox), (sy, oy), (si, oi) = scale("X"), scale("Y"), scale("I")
    # Plane 0 says which of four candidate vectors was chosen; 5 = post-processed, stored as the fourth.
    choice = planes[0].astype(int)
    pick = np.clip(choice, 1, 4)[None] - 1
    u = np.take_along_axis(planes[1:9:2], pick, 0)[0].astype(float) * si + oi
    v = (np.take_along_axis(planes[2:9:2], pick, 0)[0].astype(float) * si + oi) * np.sign(sy)
    x = ((np.arange(nx) + 0.5) * step * sx + ox) * 1e-3
    y = ((np.arange(ny) + 0.5) * step * sy + oy) * 1e-3
    measured = choice > 0
    if y[0] > y[-1]:
        y, u, v, measured = y[::-1], u[::-1], v[::-1], measured[::-1]
    return x, y, u, v, measured


def derivative(f, c, axis):
    """Central difference of f along axis; the one-sided one where a neighbour is NaN or absent."""
    f = np.moveaxis(f, axis, 0)
    forward, backward = np.full(f.shape, np.nan), np.full(f.shape, np.nan)
    forward[:-1] = np.diff(f, axis=0) / np.diff(c)[:, None]
    backward[1:] = forward[:-1]
    d = np.where(np.isnan(forward), backward, np.where(np.isnan(backward), forward, 0.5 * (forward + backward)))
    return np.moveaxis(d, 0, axis)


def main():
    x, y, u, v, measured = read_vc7(archive.member(archive.fetch("pivpy", "0.4.0"), "PIVMAT_jet/B00001.VC7"))
    u, v = np.where(measured, u, np.nan), np.where(measured, v, np.nan)
    vorticity = derivative(v, x, 1) - derivative(u, y, 0)
    valid = measured & np.isfinite(vorticity)
    grid = pv.ImageData(dimensions=(len(x), len(y), 1), origin=(x[0], y[0], 0.0),
                        spacing=((x[-1] - x[0]) / (len(x) - 1), (y[-1] - y[0]) / (len(y) - 1), 1.0))
    zero = lambda a: np.where(valid, a, 0.0).ravel().astype(np.float32)
    grid.point_data["velocity"] = np.stack([zero(u), zero(v), 0 * zero(u)], -1)
    grid.point_data["vorticity"] = zero(vorticity)
    grid.point_data["vorticity_magnitude"] = zero(abs(vorticity))
    grid.point_data["valid"] = valid.ravel().astype(np.uint8)
    grid.set_active_scalars("vorticity_magnitude")
    grid.save(archive.output("jet.vti"))
    print(f"{grid.dimensions}, {valid.sum()} valid, vorticity up to {np.nanmax(abs(vorticity)):.4g} 1/s")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""A left cortex with measured curvature, sulcal depth and thickness (FreeSurfer fsaverage5), NOT redistributed.

Source: PyPI nilearn 0.14.1, nilearn/datasets/data/fsaverage5, whose own description gives the licence as "unknown".
Needs:  pip install numpy pyvista nibabel
Usage:  python tools/datasets/cortex.py OUTPUT.vtp
"""
import gzip
import sys

import nibabel
import numpy as np
import pyvista as pv

import archive


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    wheel = archive.fetch("nilearn", "0.14.1")

    def arrays(name):
        packed = archive.member(wheel, f"data/fsaverage5/{name}_left.gii.gz")
        return [a.data for a in nibabel.GiftiImage.from_bytes(gzip.decompress(packed)).darrays]

    points, triangles = arrays("pial")
    surface = pv.PolyData(points, np.c_[np.full(len(triangles), 3), triangles].ravel())
    for name in ("curv", "sulc", "thick"):
        surface.point_data[name] = arrays(name)[0].astype(np.float32)
    surface.save(archive.output("cortex.vtp"))
    print(surface.n_points, surface.n_cells)


if __name__ == "__main__":
    main()

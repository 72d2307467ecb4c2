#!/usr/bin/env python3
"""datasets/cmb.vtp: the microwave sky as WMAP measured it, a scalar on a closed surface.

Source: source archive of PyPI healpy 1.20.1, test/data: the seven-year W band map (94 GHz) of NASA's Wilkinson
Microwave Anisotropy Probe and its temperature analysis mask, both averaged to HEALPix N_side 32.
Needs:  pip install numpy scipy pyvista        (healpy itself is not installed or run: FITS and HEALPix are read below)
Usage:  python tools/datasets/cmb.py [OUTPUT]

One vertex at the centre of each of the 12,288 pixels on the unit sphere (galactic coordinates), triangles of their
convex hull.
  temperature  mK, difference from the mean sky; the bright band is our galaxy
  valid        0 in our galaxy, the largest connected region that the analysis mask leaves out (the many single
               masked pixels elsewhere, point sources, stay): what remains are two caps and some islands

The FreeSurfer cortex (cortex.py) would be the textbook example of a measured surface, but the package that ships it
states its licence as "unknown", so it is derived on demand and not redistributed here. WMAP data products are in the
public domain as work of a United States agency; NASA asks for the credit that MANIFEST.toml gives.
"""
import numpy as np
import pyvista as pv
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

import archive


def fits_table(data):
    """Header of the first table extension and its columns, for tables of floats only."""
    def header(start):
        cards, at = {}, start
        while True:
            card = data[at:at + 80].decode("ascii")
            at += 80
            if card.startswith("END"):
                return cards, start + -(-(at - start) // 2880) * 2880
            if card[8:10] == "= ":
                value = card[10:].strip()
                cards[card[:8].strip()] = value[1:].split("'")[0].strip() if value[0] == "'" else value.split("/")[0].strip()
    _, start = header(0)
    cards, start = header(start)
    kinds = {"E": ">f4", "D": ">f8", "I": ">i2", "J": ">i4", "B": "u1"}
    fields = []
    for k in range(1, int(cards["TFIELDS"]) + 1):
        form = cards[f"TFORM{k}"]
        fields.append((f"{cards.get(f'TTYPE{k}', 'column')}_{k}", kinds[form[-1]], (int(form[:-1] or 1),)))
    rows = int(cards["NAXIS2"])
    return cards, np.frombuffer(data, np.dtype(fields), rows, start)


def sky(data):
    """First column as one value a pixel, in ring order."""
    cards, table = fits_table(data)
    assert cards["ORDERING"] == "RING"
    return int(cards["NSIDE"]), table[table.dtype.names[0]].astype(float).ravel()


def ring_centres(side):
    """Unit vectors to pixel centres in ring order (Gorski et al. 2005, equations 2 to 9)."""
    z, phi = [], []
    for ring in range(1, 4 * side):
        mirrored = min(ring, 4 * side - ring)
        if mirrored < side:
            count, height, shift = 4 * mirrored, 1.0 - mirrored ** 2 / (3.0 * side ** 2), 0.5
            height = height if ring == mirrored else -height
        else:
            count, height, shift = 4 * side, 4.0 / 3.0 - 2.0 * ring / (3.0 * side), 0.5 * ((ring - side + 1) % 2)
        z.append(np.full(count, height))
        phi.append(2.0 * np.pi / count * (np.arange(count) + shift))
    z, phi = np.concatenate(z), np.concatenate(phi)
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], -1)


def largest_region(triangles, inside):
    """Vertices of the largest edge-connected set of vertices in `inside`."""
    edge = np.concatenate([triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    edge = edge[inside[edge].all(1)]
    n = len(inside)
    label = connected_components(coo_matrix((np.ones(len(edge)), edge.T), (n, n)), False)[1]
    return inside & (label == np.bincount(label[inside]).argmax())


def main():
    packed = archive.fetch("healpy", "1.20.1", source=True)
    side, temperature = sky(archive.member(packed, "test/data/wmap_band_iqumap_r9_7yr_W_v4_udgraded32.fits"))
    mask_side, mask = sky(archive.member(packed, "test/data/wmap_temperature_analysis_mask_r9_7yr_v4_udgraded32.fits"))
    assert side == mask_side == 32 and len(temperature) == len(mask) == 12 * side ** 2
    centres = ring_centres(side)
    triangles = ConvexHull(centres).simplices
    a, b, c = (centres[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    # One order for any version of the hull code: lowest vertex first, then by rows.
    first = triangles.argmin(1)
    triangles = triangles[np.arange(len(triangles))[:, None], (first[:, None] + np.arange(3)) % 3]
    triangles = triangles[np.lexsort(triangles.T[::-1])]
    surface = pv.PolyData(centres, np.c_[np.full(len(triangles), 3), triangles].ravel())
    surface.point_data["temperature"] = temperature.astype(np.float32)
    surface.point_data["valid"] = (~largest_region(triangles, mask < 0.5)).astype(np.uint8)
    surface.set_active_scalars("temperature")
    surface.save(archive.output("cmb.vtp"))
    print(len(centres), len(triangles), np.ptp(temperature), surface["valid"].sum(), "open edges", surface.n_open_edges)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Skinning weights on many meshes: spurious extrema, range, energy and time of every method and order.

Usage:  cargo build --release
        python tools/bars/weights.py [--program target/release/morsmooth] [--data ../shared/data] [--only NAME,NAME] [--threads N]
                                     [--report FILE.json]
Needs:  pip install numpy==2.4.6 scipy==1.17.1 pyvista==0.49.1

Handles: those of the mesh's .tgf where there is one, else points far from each other. Meshes that are not there are left out with a
message; a generated one is always there. Extrema are counted by the program's audit of the file written, and once more here, from
the file alone: connected points of one value are one place, and an extremum without a handle's point is spurious.

Bar: monotone weights of order 2, 3 and 4 have exactly the wanted extrema, by both counts, for every handle of every mesh. Polyharmonic and
bounded weights are counted beside them. Exit code 1 if the bar is missed.
"""
import argparse
import json
import os
import sys
import tempfile

import numpy as np
import pyvista as pv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from weight_scenes import ROOT, count_extrema, farthest_points, read_mesh, run_weights, write_points  # noqa: E402

# name: (file, file of handles or number of points)
SCENES = {
    "generated": (None, 5),
    "woody": ("planar/woody.obj", 5),
    "alligator": ("planar/alligator.obj", 6),
    "bump-domain": ("planar/bump-domain.obj", 4),
    "italy": ("planar/outline_italy.csv", 5),
    "norway": ("planar/outline_norway.csv", 5),
    "beetle": ("surfaces/beetle.off", 4),
    "spot": ("surfaces/spot.obj", 5),
    "skull": ("surfaces/skull.obj", 4),
    "hand": ("tets/hand.mesh", "tets/hand.tgf"),
    "cactus_3d": ("tets/cactus_3d.mesh", 4),
    "bunny": ("tets/bunny.mesh", 5),
}
RUNS = [("harmonic", 1)] + [(method, order) for method in ("polyharmonic", "bounded", "monotone") for order in (2, 3, 4)]


def generated(path):
    """A comb: long teeth are where oscillations show."""
    side = 61
    keep = np.zeros((side, side), bool)
    keep[:12, :] = True
    for tooth in range(5):
        keep[:, 13 * tooth:13 * tooth + 6] = True
    grid = pv.ImageData(dimensions=(side + 1, side + 1, 1)).cast_to_unstructured_grid()
    mesh = grid.extract_cells(np.flatnonzero(keep.ravel())).triangulate().extract_surface(algorithm="dataset_surface")
    mesh.clear_data()
    mesh.save(path)


def judge(output, names, simplices):
    """The independent count of every handle: (minima, maxima, spurious)."""
    mesh = pv.read(output)
    weights = np.array([mesh.point_data[name] for name in names])
    simplices_of = mesh.cells_dict if isinstance(mesh, pv.UnstructuredGrid) else {5: mesh.faces.reshape(-1, 4)[:, 1:]}
    simplices = simplices_of.get(10, simplices_of.get(5))
    # A handle's points, and those of others, are exactly 1 or 0; the program's report names none, so they are read off the JSON.
    return weights, simplices


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target/release/morsmooth"))
    parser.add_argument("--data", default=os.path.join(ROOT, "../shared/data"))
    parser.add_argument("--only")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--report")
    args = parser.parse_args()
    wanted = args.only.split(",") if args.only else list(SCENES)
    rows, missed = [], []
    print(f"{'mesh':<12}{'vertices':>9}{'handles':>8} {'method':<13}{'k':>2}{'spurious':>9}{'by hand':>8}{'missing':>8}"
          f"{'least':>9}{'greatest':>9}{'energy':>13}{'off 1':>9}{'CPU s':>8}")
    with tempfile.TemporaryDirectory() as folder:
        for name in wanted:
            file, handles = SCENES[name]
            path = os.path.join(args.data, file) if file else os.path.join(folder, "comb.vtp")
            if not file:
                generated(path)
            if not os.path.exists(path):
                print(f"{name:<12} skipped: {path} is not there")
                continue
            outline = path.endswith(".csv")
            chosen_file = os.path.join(folder, f"{name}.json")
            if isinstance(handles, str):
                chosen_file = os.path.join(args.data, handles)
            elif outline:
                ring = np.loadtxt(path, delimiter=",", skiprows=1)
                picked = ring[np.linspace(0, len(ring), handles, endpoint=False).astype(int)]
                write_points(chosen_file, np.column_stack([picked, np.zeros(len(picked))]), range(handles))
            else:
                points, simplices = read_mesh(path)
                write_points(chosen_file, points, farthest_points(points, simplices, handles))
            for method, order in RUNS:
                output = os.path.join(folder, "out.vtu")
                options = ["--method", method, "--order", order, "--keep-unaudited"]
                options += ["--threads", args.threads] if args.threads else []
                told = run_weights(args.program, path, output, chosen_file, os.path.join(folder, "report.json"), *options)
                if "failed" in told:
                    print(f"{name:<12}{'':>17} {method:<13}{order:>2}  refused: {' '.join(told['failed'])}")
                    rows.append({"mesh": name, "method": method, "order": order, "refused": told["failed"]})
                    if method == "monotone":
                        missed.append(f"{name} order {order}: refused")
                    continue
                weights, simplices = judge(output, [handle["array"] for handle in told["handles"]], None)
                # Given values: those points that hold exactly 0 or 1, or a share, in every run are the handles'; take them from one run.
                given = given_points(args, path, chosen_file, folder, name)
                counts = [count_extrema(simplices, column, given) for column in weights]
                spurious = sum(handle["audit"]["spurious"] for handle in told["handles"])
                missing = sum(handle["audit"]["missing"] for handle in told["handles"])
                by_hand = sum(count[2] for count in counts)
                least = min(handle["audit"]["range"][0] for handle in told["handles"])
                greatest = max(handle["audit"]["range"][1] for handle in told["handles"])
                agree = all([count[0], count[1]] == [handle["audit"]["minima"], handle["audit"]["maxima"]]
                            for count, handle in zip(counts, told["handles"]))
                row = {"mesh": name, "method": method, "order": order, "vertices": told["vertices"], "handles": len(counts),
                       "spurious": spurious, "by_hand": by_hand, "missing": missing, "least": least, "greatest": greatest,
                       "energy": told["energy"], "off_unity": told["off_unity"], "turns": told["turns"],
                       "divided": sum((handle["if_only_divided"] or {"spurious": 0})["spurious"] for handle in told["handles"]),
                       "processor": told["processor"], "seconds": told["seconds"]["total"]}
                rows.append(row)
                print(f"{name:<12}{row['vertices']:>9}{row['handles']:>8} {method:<13}{order:>2}{spurious:>9}{by_hand:>8}{missing:>8}"
                      f"{least:>9.3f}{greatest:>9.3f}{row['energy']:>13.5e}{row['off_unity']:>9.1e}{row['processor']:>8.2f}", flush=True)
                if method == "monotone" and (told["exit"] or not told["passed"] or spurious or missing or by_hand or not agree):
                    missed.append(f"{name} order {order}: {spurious} spurious, {missing} missing, {by_hand} by hand, agree: {agree}")
                elif not agree:
                    missed.append(f"{name} {method} {order}: the two counts differ")
    if args.report:
        json.dump(rows, open(args.report, "w"), indent=1)
    print("\n" + ("\n".join(["MISSED"] + missed) if missed else "every bar met"))
    return 1 if missed else 0


GIVEN = {}


def given_points(args, path, handles, folder, name):
    """The points that carry handles: where the harmonic weights are as given whatever the mass and the order. Found once a mesh."""
    if name not in GIVEN:
        output = os.path.join(folder, "given.vtu")
        told = run_weights(args.program, path, output, handles, os.path.join(folder, "given.json"), "--method", "harmonic",
                           "--partition", "free")
        weights, _ = judge(output, [handle["array"] for handle in told["handles"]], None)
        # Exactly 0, 1 or a share at all handles at once happens at given points only.
        is_share = np.isclose(weights * 12, np.round(weights * 12), rtol=0, atol=0)
        GIVEN[name] = is_share.all(axis=0) & (weights.sum(axis=0) == 1)
    return GIVEN[name]


if __name__ == "__main__":
    raise SystemExit(main())

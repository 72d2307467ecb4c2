#!/usr/bin/env python3
"""200 random poses on six meshes: each result is free of inversions, or refused with the culprits named. None may hang.

Usage:  python tools/bars/poses.py [--program target/release/morsmooth] [--poses 200] [--seed 1]
Needs:  pip install numpy pyvista

Three planar meshes (a square, an outline with a hole, a star) and three solid ones (a bar, a ball, an L) get three to five handles
and random poses: any rotation, translations up to a quarter of the diagonal, scales from 0.7 to 1.4. Every fourth pose turns two handles
by 180 degrees against each other; every eighth besides has weights by which two neighbouring elements are turned by 180 degrees against each
other, for which there is no shape: it must be refused, and name one of the two. Results are read with VTK and judged with exact rational
arithmetic where a determinant is near zero, as written and rounded to 32 bits. Exit code 1 if a run ends otherwise than promised.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from fractions import Fraction

import numpy as np
import pyvista

HERE = os.path.dirname(os.path.abspath(__file__))
PATIENCE = 120


def solid(keep, cells, step):
    """Six tetrahedra in every cube that is kept."""
    points, cubes = {}, []
    number = lambda p: points.setdefault(p, len(points))
    for i, j, k in np.ndindex(*cells):
        if not keep((i + 0.5) * step, (j + 0.5) * step, (k + 0.5) * step):
            continue
        for axes in [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]:
            at, tet = [i, j, k], [number((i, j, k))]
            for axis in axes:
                at[axis] += 1
                tet.append(number(tuple(at)))
            cubes.append(tet)
    return np.array(list(points), float) * step, np.array(cubes)


def write_vtu(path, points, cells):
    kind = pyvista.CellType.TRIANGLE if cells.shape[1] == 3 else pyvista.CellType.TETRA
    listed = np.hstack([np.full((len(cells), 1), cells.shape[1]), cells]).ravel()
    pyvista.UnstructuredGrid(listed, np.full(len(cells), kind), points).save(path)


def write_csv(path, rings):
    with open(path, "w") as file:
        file.write("x,y,ring\n")
        for ring, places in enumerate(rings):
            file.writelines(f"{float(x)!r},{float(y)!r},{ring}\n" for x, y in places)


def meshes(folder):
    """Name: file, handles."""
    made = {}
    n = 18
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    rng = np.random.default_rng(5)
    inner = np.zeros(((n + 1), (n + 1)), bool)
    inner[1:-1, 1:-1] = True
    shift = 0.25 / n * rng.uniform(-1, 1, (2, n + 1, n + 1)) * inner
    points = np.stack([x + shift[0], y + shift[1], 0 * x], -1).reshape(-1, 3)
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    write_vtu(os.path.join(folder, "square.vtu"), points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))
    made["square"] = ("square.vtu", [("sw", [0, 0]), ("se", [1, 0]), ("n", [0.5, 1]), ("mid", [0.5, 0.5])])
    circle = lambda r, m, s=1: [(0.5 + r * np.cos(t), 0.5 + r * np.sin(t)) for t in s * 2 * np.pi * np.arange(m) / m]
    write_csv(os.path.join(folder, "ring.csv"), [circle(0.5, 60), circle(0.2, 30, -1)])
    made["ring"] = ("ring.csv", [("w", [0, 0.5]), ("e", [1, 0.5]), ("n", [0.5, 1]), ("s", [0.5, 0])])
    star = [(0.5 + r * np.cos(t), 0.5 + r * np.sin(t)) for k in range(10) for r, t in [((0.5, 0.2)[k % 2], np.pi * k / 5 + 0.3)]]
    write_csv(os.path.join(folder, "star.csv"), [star])
    made["star"] = ("star.csv", [(f"tip{k}", list(star[2 * k])) for k in range(5)])
    bar = solid(lambda *_: True, (16, 4, 4), 1 / 16)
    write_vtu(os.path.join(folder, "bar.vtu"), *bar)
    made["bar"] = ("bar.vtu", [("left", [0, 0.125, 0.125]), ("mid", [0.5, 0.125, 0.125]), ("right", [1, 0.125, 0.125])])
    ball = solid(lambda *p: sum((q - 0.5) ** 2 for q in p) < 0.25, (9, 9, 9), 1 / 9)
    write_vtu(os.path.join(folder, "ball.vtu"), *ball)
    made["ball"] = ("ball.vtu", [("low", [0.5, 0.5, 0.05]), ("high", [0.5, 0.5, 0.95]), ("side", [0.95, 0.5, 0.5])])
    ell = solid(lambda x, y, z: x < 0.3 or z < 0.3, (10, 3, 10), 1 / 10)
    write_vtu(os.path.join(folder, "ell.vtu"), *ell)
    made["ell"] = ("ell.vtu", [("top", [0.15, 0.15, 1]), ("knee", [0.15, 0.15, 0.15]), ("toe", [1, 0.15, 0.15])])
    return made


def neighbours_opposed(rng, rest, handles, target):
    """Weights that give one handle all of an element, and the next all of a neighbour; the two elements."""
    mesh = pyvista.read(rest)
    cells = next(iter(mesh.cells_dict.values()))
    d = cells.shape[1] - 1
    facets = {}
    for cell, corners in enumerate(cells):
        for corner in corners:
            facets.setdefault(tuple(sorted(set(corners) - {corner})), []).append((cell, corner))
    inner = [(facet, pair) for facet, pair in facets.items() if len(pair) == 2]
    facet, ((one, apex), (other, opposite)) = inner[rng.integers(len(inner))]
    weights = np.full((mesh.n_points, len(handles)), 1 / len(handles))
    weights[[*facet, apex, opposite]] = 0
    # The mean over the corners is (1, 0) in the first element, (0, 1) in the second.
    weights[list(facet), :2] = 0.5
    weights[apex, :2] = (d + 1 - d / 2, -d / 2)
    weights[opposite, :2] = (-d / 2, d + 1 - d / 2)
    for column, (name, _) in enumerate(handles):
        mesh.point_data[name] = weights[:, column]
    mesh.save(target)
    return {one, other}


def random_pose(rng, handles, is_solid, is_opposed):
    pose = {}
    for name, _ in handles:
        entry = {"translation": list(rng.uniform(-0.25, 0.25, 3) * ([1, 1, 1] if is_solid else [1, 1, 0])), "scale": rng.uniform(0.7, 1.4)}
        entry["rotation_degrees"] = rng.uniform(-180, 180)
        if is_solid:
            entry["axis"] = list(rng.normal(size=3))
        pose[name] = entry
    if is_opposed:
        one, other = 0, 1
        turn = pose[handles[one][0]]
        opposite = {**pose[handles[other][0]], "rotation_degrees": turn["rotation_degrees"] + 180}
        if is_solid:
            opposite["axis"] = turn["axis"]
        pose[handles[other][0]] = opposite
    return {"handles": pose}


def determinant(rows):
    if len(rows) == 2:
        return rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    a, b, c = rows
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])


def signs(points, cells):
    """Exact signs of all determinants."""
    d = cells.shape[1] - 1
    rows = points[cells][:, 1:, :d] - points[cells][:, :1, :d]
    det = np.linalg.det(rows)
    result = np.sign(det)
    scale = np.abs(rows).max(axis=(1, 2)) ** d
    for cell in np.nonzero(np.abs(det) <= 1e-12 * scale)[0]:
        exact = [[Fraction(float(p)) for p in points[v, :d]] for v in cells[cell]]
        value = determinant([[p - q for p, q in zip(corner, exact[0])] for corner in exact[1:]])
        result[cell] = (value > 0) - (value < 0)
    return result


def inverted(rest, result):
    before, after = pyvista.read(rest), pyvista.read(result)
    cells = next(iter(before.cells_dict.values()))
    assert np.array_equal(cells, next(iter(after.cells_dict.values()))), "the cells changed"
    at_rest = signs(np.asarray(before.points, float), cells)
    points = np.asarray(after.points, float)
    return [int((signs(p, cells) != at_rest).sum()) for p in (points, points.astype(np.float32).astype(float))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(HERE, "..", "..", "target", "release", "morsmooth"))
    parser.add_argument("--poses", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", help="folder for files of runs that break the promise")
    args = parser.parse_args()
    program = os.path.abspath(args.program)
    rng = np.random.default_rng(args.seed)
    wrong, rows = [], {}
    with tempfile.TemporaryDirectory() as folder:
        made = meshes(folder)
        path = lambda name: os.path.join(folder, name)
        for name, (file, handles) in made.items():
            json.dump({"handles": [{"name": n, "point": [float(c) for c in p]} for n, p in handles]}, open(path(name + "_h.json"), "w"))
            # The mesh of an outline is that of a pose of rest.
            json.dump({"handles": {}}, open(path("rest.json"), "w"))
            common = ["--handles", name + "_h.json", "--weight-method", "harmonic", "-q", "--max-edge", "4%"]
            done = subprocess.run([program, "deform", file, name + "_rest.vtu", "--pose", "rest.json", *common], cwd=folder, capture_output=True, text=True)
            assert done.returncode == 0, done.stderr
            rows[name] = {"elements": pyvista.read(path(name + "_rest.vtu")).n_cells, "poses": 0, "opposed": 0, "none": 0, "done": 0, "refused": 0, "warned": 0, "slowest": 0.0}
        for number in range(args.poses):
            name = list(made)[number // 8 % len(made)] if number % 8 == 7 else list(made)[number % len(made)]
            file, handles = made[name]
            row, is_opposed = rows[name], number % 4 == 3
            is_impossible = number % 8 == 7
            pose = random_pose(rng, handles, name in ("bar", "ball", "ell"), is_opposed)
            json.dump(pose, open(path("pose.json"), "w"))
            out = path("out.vtu")
            if os.path.exists(out):
                os.remove(out)
            common = ["--handles", name + "_h.json", "--weight-method", "harmonic", "-q", "--max-edge", "4%", "--report", "report.json"]
            if is_impossible:
                file = name + "_rest.vtu"
                pair = neighbours_opposed(rng, path(file), handles, path("weights.vtu"))
                common = ["--handles", name + "_h.json", "--weights", "weights.vtu", "-q", "--report", "report.json"]
            begin = time.time()
            try:
                ended = subprocess.run([program, "deform", file, "out.vtu", "--pose", "pose.json", *common], cwd=folder, capture_output=True, text=True, timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                wrong.append(f"pose {number} on {name}: still running after {PATIENCE} s")
                continue
            row["poses"] += 1
            row["opposed"] += is_opposed
            row["none"] += is_impossible
            row["slowest"] = max(row["slowest"], time.time() - begin)
            what = None
            if ended.returncode == 0:
                row["done"] += 1
                row["warned"] += "warning" in ended.stderr
                bad = inverted(path(name + "_rest.vtu"), out)
                if is_impossible:
                    what = "reported as done where there is no shape"
                elif bad != [0, 0]:
                    what = f"reported as done with {bad} inverted elements"
            elif ended.returncode == 1:
                row["refused"] += 1
                is_named = "contradict each other" in ended.stderr and '"' in ended.stderr and "element" in ended.stderr
                blamed = json.load(open(path("report.json")))["result"].get("blame", {}).get("cells", [])
                if os.path.exists(out) or not is_named or not blamed:
                    what = f"refused without its culprits: {ended.stderr.strip()}"
                elif is_impossible and not pair & set(blamed):
                    what = f"blames {blamed[:5]} where the elements {pair} contradict each other"
            else:
                what = f"exit code {ended.returncode}: {ended.stderr.strip()}"
            if what:
                wrong.append(f"pose {number} on {name}: {what}")
                if args.keep:
                    os.makedirs(args.keep, exist_ok=True)
                    json.dump(pose, open(os.path.join(args.keep, f"{number}_{name}.json"), "w"))
                    for extra in (file, name + "_h.json", *(["weights.vtu"] if is_impossible else [])):
                        open(os.path.join(args.keep, f"{number}_{extra}"), "wb").write(open(path(extra), "rb").read())
    print("| mesh | elements | poses | two handles half a turn apart | of them no shape exists | free of inversions | not certified optimal | refused, culprits named | slowest s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, r in rows.items():
        print(f"| {name} | {r['elements']} | {r['poses']} | {r['opposed']} | {r['none']} | {r['done']} | {r['warned']} | {r['refused']} | {r['slowest']:.2f} |")
    total = lambda key: sum(row[key] for row in rows.values())
    print(f"{total('poses')} poses: {total('done')} free of inversions, {total('refused')} refused ({100 * total('refused') / max(total('poses'), 1):.1f} %), {len(wrong)} wrong")
    for line in wrong:
        print("WRONG", line)
    sys.exit(1 if wrong else 0)


main()

#!/usr/bin/env python3
"""`morsmooth pose` beside libigl's linear blend skinning and a dual-quaternion skinning written here in matrices and numpy.

Needs:  pip install numpy pyvista libigl
Usage:  cargo build --release; python tools/reference/skinning.py [MESH SKELETON.tgf POSE.dmat]

Without files: a bar of tetrahedra with a chain of four bones and random turns, generated. Weights: inverse squared distances to the bones. The
skeleton goes through .tgf, the pose through .dmat (turns against the parent bone), the weights through .vtu. Exit 1 if a
position is off by more than 1e-10 of the extent.
"""
import json
import os
import subprocess
import sys
import tempfile

import igl
import numpy as np
import pyvista as pv

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
PROGRAM = os.path.join(ROOT, "target", "release", "morsmooth")
ALLOWED = 1e-10


def generated(folder):
    grid = pv.ImageData(dimensions=(33, 5, 5), spacing=(0.25, 0.25, 0.25)).to_tetrahedra(5)
    joints = np.array([[x, 0.5, 0.5] for x in (0.0, 2.0, 4.0, 6.0, 8.0)])
    turns = np.random.default_rng(3).normal(size=(4, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    with open(os.path.join(folder, "s.tgf"), "w") as text:
        text.writelines(f"{i + 1} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(joints.tolist()))
        text.write("#\n" + "".join(f"{i} {i + 1}\n" for i in range(1, 5)))
    with open(os.path.join(folder, "p.dmat"), "w") as text:
        text.write("1 16\n" + "".join(f"{v!r}\n" for v in turns.ravel().tolist()))
    return grid.cast_to_unstructured_grid(), os.path.join(folder, "s.tgf"), os.path.join(folder, "p.dmat")


def skeleton(path):
    points, bones, part = [], [], 0
    for line in open(path):
        if line.startswith("#"):
            part += 1
        elif part == 0:
            points.append([float(word) for word in line.split()[1:4]])
        elif part == 1 and line.strip():
            bones.append([int(word) - 1 for word in line.split()[:2]])
    return np.array(points), np.array(bones)


def matrix(x, y, z, w):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def motions(points, bones, turns):
    """4 x 4 matrices from the roots down: a bone turns about its root, and its parent carries that."""
    parents = igl.directed_edge_parents(bones.astype(np.int64))
    found = {}

    def motion(bone):
        if bone not in found:
            local = np.eye(4)
            root = points[bones[bone][0]]
            local[:3, :3] = matrix(*turns[bone])
            local[:3, 3] = root - local[:3, :3] @ root
            found[bone] = local if parents[bone] < 0 else motion(int(parents[bone])) @ local
        return found[bone]

    return np.array([motion(bone) for bone in range(len(bones))])


def quaternion(rotation):
    """Eigenvector of the greatest eigenvalue (Bar-Itzhack 2000): shares nothing with the products of the program."""
    r = rotation
    k = np.array([[r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0], [r[1, 0] + r[0, 1], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
                  [r[2, 0] + r[0, 2], r[2, 1] + r[1, 2], r[2, 2] - r[0, 0] - r[1, 1], 0],
                  [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], r.trace()]])
    return np.linalg.eigh(k + np.tril(k, -1).T)[1][:, -1][[3, 0, 1, 2]]


def product(a, b):
    return np.r_[a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])]


def dual_quaternions(points, weights, moves):
    real = np.array([quaternion(move[:3, :3]) for move in moves])
    dual = np.array([product(np.r_[0, move[:3, 3]], q) / 2 for move, q in zip(moves, real)])
    moved = np.empty_like(points)
    for vertex, row in enumerate(weights):
        signs = np.where(real @ real[row.argmax()] < 0, -1, 1)
        a, b = (row * signs) @ real, (row * signs) @ dual
        length = np.linalg.norm(a)
        a, b = a / length, b / length
        inverse = np.r_[a[0], -a[1:]]
        moved[vertex] = product(product(a, np.r_[0, points[vertex]]), inverse)[1:] + 2 * product(b, inverse)[1:]
    return moved


def main():
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) == 4:
            read, tgf, dmat = sys.argv[1:]
            subprocess.run([PROGRAM, "convert", read, os.path.join(folder, "m.vtu"), "-q"], check=True)
            mesh = pv.read(os.path.join(folder, "m.vtu"))
        else:
            mesh, tgf, dmat = generated(folder)
        mesh = pv.UnstructuredGrid(mesh.cells, mesh.celltypes, mesh.points.astype(float))
        joints, bones = skeleton(tgf)
        turns = np.loadtxt(dmat, skiprows=1).reshape(-1, 4)
        turns /= np.linalg.norm(turns, axis=1)[:, None]
        ends = joints[bones]
        along = ends[:, 1] - ends[:, 0]
        place = np.clip(np.einsum("nbk,bk->nb", mesh.points[:, None] - ends[None, :, 0], along) / (along**2).sum(1), 0, 1)
        squares = ((mesh.points[:, None] - ends[None, :, 0] - place[..., None] * along) ** 2).sum(-1)
        weights = 1 / (squares + 1e-4)
        weights /= weights.sum(1, keepdims=True)
        names = [f"bone_{bone + 1}" for bone in range(len(bones))]
        for name, column in zip(names, weights.T):
            mesh.point_data[name] = column
        mesh.field_data["handle_names"] = names
        mesh.save(os.path.join(folder, "w.vtu"))
        moves = motions(joints, bones, turns)
        stacked = np.concatenate([move[:3].T for move in moves])
        expected = {"lbs": igl.lbs_matrix(mesh.points, weights) @ stacked, "dqs": dual_quaternions(mesh.points, weights, moves)}
        extent, worst = np.ptp(mesh.points, axis=0).max(), 0.0
        for method, positions in expected.items():
            target, report = os.path.join(folder, "o.vtu"), os.path.join(folder, "r.json")
            subprocess.run([PROGRAM, "pose", os.path.join(folder, "w.vtu"), os.path.join(folder, "w.vtu"), dmat, target,
                            "--handles", tgf, "--method", method, "--report", report, "-q"], check=True)
            off = np.abs(pv.read(target).points - positions).max() / extent
            inverted = json.load(open(report))["inversions"]
            print(f"{method}: {mesh.n_points} points, {len(bones)} bones, largest difference {off:.1e} of the extent; inverted {inverted.get('count')}")
            worst = max(worst, off)
        sys.exit(int(not worst <= ALLOWED))


if __name__ == "__main__":
    main()

"""Meshes and fields that the tests share, and the program that results are compared with."""

import json
import os
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def program():
    """Runs the program on files and gives what it says; skips where it was not built."""
    given = os.environ.get("MORSMOOTH_PROGRAM") or shutil.which("morsmooth") or ROOT / "target/release/morsmooth"
    if not pathlib.Path(given).exists():
        pytest.skip(f"{given} is not built: cargo build --release")

    def run(*words, expect=0):
        ended = subprocess.run([str(given), *map(str, words)], capture_output=True, text=True)
        assert ended.returncode == expect, ended.stderr
        return ended

    return run


@pytest.fixture(scope="session")
def triangles():
    """A bumpy sheet of triangles in the plane: points, triangles, values."""
    count = 31
    u, v = np.meshgrid(np.linspace(0, 1, count), np.linspace(0, 1, count), indexing="ij")
    random = np.random.default_rng(3)
    jitter = 0.2 / (count - 1) * random.uniform(-1, 1, (2, count, count))
    points = np.column_stack([(u + jitter[0]).ravel(), (v + jitter[1]).ravel(), np.zeros(count * count)])
    number = np.arange(count * count).reshape(count, count)
    a, b, c, d = number[:-1, :-1].ravel(), number[1:, :-1].ravel(), number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    cells = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    values = np.sin(8 * u) * np.cos(7 * v) + 0.2 * random.standard_normal((count, count))
    return points, cells, values.ravel()


@pytest.fixture(scope="session")
def tetrahedra():
    """A block of tetrahedra: points, tetrahedra, values."""
    count = 7
    axes = np.meshgrid(*3 * [np.arange(float(count))], indexing="ij")
    points = np.column_stack([axis.ravel() for axis in axes])
    number = np.arange(count**3).reshape(3 * (count,))
    corner = lambda i, j, k: number[i : i + count - 1, j : j + count - 1, k : k + count - 1].ravel()
    paths = [(1, 0, 0, 1, 1, 0), (1, 0, 0, 1, 0, 1), (0, 1, 0, 1, 1, 0), (0, 1, 0, 0, 1, 1), (0, 0, 1, 1, 0, 1), (0, 0, 1, 0, 1, 1)]
    cells = [np.column_stack([corner(0, 0, 0), corner(*path[:3]), corner(*path[3:]), corner(1, 1, 1)]) for path in paths]
    random = np.random.default_rng(4)
    values = np.sin(points @ [0.9, 0.7, 0.5]) + 0.3 * random.standard_normal(len(points))
    return points, np.concatenate(cells), values


def extrema(values, cells):
    """Strict minima and maxima, and points without a strictly lower or higher neighbour that are neither: by edges alone."""
    edges = np.concatenate([cells[:, [i, j]] for i in range(cells.shape[1]) for j in range(cells.shape[1]) if i != j])
    above = np.zeros(len(values), int)
    below = np.zeros(len(values), int)
    np.add.at(above, edges[:, 0], values[edges[:, 1]] > values[edges[:, 0]])
    np.add.at(below, edges[:, 0], values[edges[:, 1]] < values[edges[:, 0]])
    degree = np.bincount(edges[:, 0], minlength=len(values))
    minima = set(np.flatnonzero((above == degree) & (degree > 0)).tolist())
    maxima = set(np.flatnonzero((below == degree) & (degree > 0)).tolist())
    others = np.flatnonzero((degree > 0) & ((above == 0) | (below == 0))).tolist()
    return minima, maxima, set(others) - minima - maxima


@pytest.fixture(scope="session")
def count_extrema():
    return extrema


def same_bits(a, b):
    a, b = np.ascontiguousarray(a), np.ascontiguousarray(b)
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


@pytest.fixture(scope="session")
def equal():
    return same_bits


@pytest.fixture
def as_json(tmp_path):
    def write(name, content):
        path = tmp_path / name
        path.write_text(json.dumps(content))
        return path

    return write

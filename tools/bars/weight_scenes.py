"""Meshes, handles and the independent count of extrema for the bars of skinning weights. Needs numpy and scipy; reads VTK with pyvista."""
import json
import os
import resource
import subprocess

import numpy as np
import pyvista as pv
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def read_mesh(path):
    """Points n x 3 and simplices m x (d + 1) of a file that pyvista or a few lines can read."""
    if path.endswith(".mesh"):
        return read_medit(path)
    if path.endswith(".off"):
        words = [word for line in open(path) for word in line.split("#")[0].split()][1:]
        n, m = int(words[0]), int(words[1])
        points = np.array(words[3:3 + 3 * n], dtype=float).reshape(n, 3)
        rest = np.array(words[3 + 3 * n:3 + 3 * n + 4 * m], dtype=int).reshape(m, 4)
        return points, rest[:, 1:]
    if path.endswith(".obj"):
        # VTK's reader makes new points along the seams of textures.
        lines = [line.split() for line in open(path)]
        points = np.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)
        faces = [[int(word.split("/")[0]) - 1 for word in line[1:]] for line in lines if line[:1] == ["f"]]
        return points, np.array([[face[0], face[i], face[i + 1]] for face in faces for i in range(1, len(face) - 1)])
    mesh = pv.read(path)
    if isinstance(mesh, pv.PolyData):
        return np.array(mesh.points, dtype=float), mesh.triangulate().faces.reshape(-1, 4)[:, 1:]
    for kind, width in ((10, 4), (5, 3)):
        if kind in mesh.cells_dict:
            return np.array(mesh.points, dtype=float), mesh.cells_dict[kind].reshape(-1, width)
    raise SystemExit(f"{path}: no triangles or tetrahedra")


def read_medit(path):
    words = open(path).read().split()
    at = words.index("Vertices")
    n = int(words[at + 1])
    points = np.array(words[at + 2:at + 2 + 4 * n], dtype=float).reshape(n, 4)[:, :3]
    at = words.index("Tetrahedra")
    m = int(words[at + 1])
    return points, np.array(words[at + 2:at + 2 + 5 * m], dtype=int).reshape(m, 5)[:, :4] - 1


def farthest_points(points, simplices, count):
    """Point handles, each as far from those before as the mesh allows; at least one on every connected part."""
    graph = edge_graph(points, simplices)
    parts, label = connected_components(graph, directed=False)
    chosen = [int(np.flatnonzero(label == part)[0]) for part in range(parts)]
    distance = np.min([sp.csgraph.dijkstra(graph, indices=first) for first in chosen], axis=0)
    # The first ones were any point of their part: the farthest of each part are better.
    chosen = [int(np.argmax(np.where(label == part, distance, -1))) for part in range(parts)]
    distance = np.min([sp.csgraph.dijkstra(graph, indices=first) for first in chosen], axis=0)
    while len(chosen) < count:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, sp.csgraph.dijkstra(graph, indices=chosen[-1]))
    return chosen


def edge_graph(points, simplices):
    ends = edges(simplices)
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    n = len(points)
    return sp.csr_matrix((length, (ends[:, 0], ends[:, 1])), shape=(n, n)).maximum(
        sp.csr_matrix((length, (ends[:, 1], ends[:, 0])), shape=(n, n)))


def edges(simplices):
    width = simplices.shape[1]
    pairs = [simplices[:, [a, b]] for a in range(width) for b in range(a)]
    return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)


def count_extrema(simplices, values, given):
    """Minima, maxima and spurious extrema; connected points of one value are one place.

    `given`: a mask of the points whose value was given; an extremum without one is spurious."""
    ends = edges(simplices)
    n = len(values)
    equal = ends[values[ends[:, 0]] == values[ends[:, 1]]]
    _, place = connected_components(sp.csr_matrix((np.ones(len(equal)), (equal[:, 0], equal[:, 1])), shape=(n, n)), directed=False)
    places = place.max() + 1
    lower, higher = np.zeros(places, bool), np.zeros(places, bool)
    for a, b in ((ends[:, 0], ends[:, 1]), (ends[:, 1], ends[:, 0])):
        below = values[a] < values[b]
        higher[place[a[below]]] = True
        lower[place[b[below]]] = True
    has_given = np.zeros(places, bool)
    has_given[place[given]] = True
    minima, maxima = higher & ~lower, lower & ~higher
    return int(minima.sum()), int(maxima.sum()), int(((minima | maxima) & ~has_given).sum())


def write_points(path, points, chosen):
    handles = [{"name": f"p{index}", "point": list(map(float, points[vertex]))} for index, vertex in enumerate(chosen)]
    with open(path, "w") as file:
        json.dump({"handles": handles}, file)


def run_weights(program, mesh, output, handles, report, *options):
    """The report of a run; exit code 1 of a run that was kept is left to the caller."""
    call = [program, "weights", mesh, output, "--handles", handles, "--report", report, "--quiet", *map(str, options)]
    begin = resource.getrusage(resource.RUSAGE_CHILDREN)
    child = subprocess.run(call, capture_output=True, text=True)
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    if child.returncode not in (0, 1) or not os.path.exists(report):
        return {"failed": (child.stderr or child.stdout).strip().splitlines()[-1:]}
    told = json.load(open(report))
    os.remove(report)
    told["exit"] = child.returncode
    told["processor"] = (end.ru_utime + end.ru_stime) - (begin.ru_utime + begin.ru_stime)
    return told

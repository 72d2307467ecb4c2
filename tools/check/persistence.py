"""Persistence of extrema by union-find over the vertex order, knowing nothing of morsmooth.

Needs:  pip install numpy==2.4.6

Edges are those of count_extrema.py. The order is (value, point number); maxima are the minima of the reversed order.
"""
import numpy as np


def persistences(edge, value, maxima=False):
    """{extremum: persistence}; the last of its component has None, as nothing there outlives it."""
    order = np.lexsort((np.arange(len(value)), value))
    order = order[::-1] if maxima else order
    rank = np.empty(len(value), int)
    rank[order] = np.arange(len(value))
    top = np.maximum(rank[edge[:, 0]], rank[edge[:, 1]])
    low = np.minimum(rank[edge[:, 0]], rank[edge[:, 1]])[np.argsort(top, kind="stable")]
    top.sort()
    parent, born = list(range(len(value))), {}

    def root(v):
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for a, b in zip(top.tolist(), low.tolist()):
        a, b, at = root(a), root(b), a
        if a != b:
            young, old = max(a, b), min(a, b)
            parent[young] = old
            if young != at:  # a vertex that joins its first lower component is no minimum
                born[int(order[young])] = abs(float(value[order[at]]) - float(value[order[young]]))
    roots = {root(v) for v in np.unique(rank[edge]).tolist()}
    return born | {int(order[v]): None for v in roots}


def wanted(edge, value, threshold):
    """Point numbers of the minima and of the maxima whose persistence exceeds `threshold`, rising."""
    return [sorted(v for v, p in persistences(edge, value, maxima).items() if p is None or p > threshold)
            for maxima in (False, True)]

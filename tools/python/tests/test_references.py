"""Results against GUDHI and libigl, where these are installed."""

import collections

import numpy as np
import pytest

import morsmooth


def lower_star_diagram(gudhi, values, cells):
    """Multiset of (dimension, birth, death) of all pairs of positive persistence."""
    tree = gudhi.SimplexTree()
    tree.insert_batch(cells.T.astype(np.int32), np.full(len(cells), -np.inf))
    for vertex, value in enumerate(values):
        tree.assign_filtration([vertex], value)
    tree.make_filtration_non_decreasing()
    tree.compute_persistence(homology_coeff_field=2, persistence_dim_max=True, min_persistence=0.0)
    return collections.Counter((dimension, *ends) for dimension, ends in tree.persistence() if ends[0] < ends[1])


@pytest.mark.parametrize("mesh", ["triangles", "tetrahedra"])
@pytest.mark.parametrize("levels", [None, 2])
def test_pairs_are_those_of_gudhi(mesh, levels, request):
    gudhi = pytest.importorskip("gudhi", reason="GUDHI is not installed")
    points, cells, values = request.getfixturevalue(mesh)
    if levels is not None:
        # Few levels, so plateaus and ties.
        values = np.round(levels * values) / levels
    pairs = morsmooth.persistence_pairs((points, cells), values)
    found = collections.Counter(zip(pairs.dimension.tolist(), pairs.birth.tolist(), pairs.death.tolist()))
    found = collections.Counter({pair: count for pair, count in found.items() if pair[1] < pair[2]})
    assert found == lower_star_diagram(gudhi, values, cells) and sum(found.values()) > 30


@pytest.mark.parametrize("order", [1, 2])
def test_linear_weights_are_those_of_libigl(order, triangles):
    igl = pytest.importorskip("igl", reason="libigl is not installed")
    points, cells, _ = triangles
    handles = {"a": [0], "b": [480], "c": [960]}
    ours = morsmooth.weights((points, cells), handles, method="polyharmonic", order=order, partition="free").weights
    fixed = np.array([0, 480, 960])
    theirs = igl.harmonic(points, cells.astype(np.int64), fixed, np.eye(3), order)
    assert np.abs(ours - theirs).max() < 1e-6

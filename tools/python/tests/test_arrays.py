"""Plain arrays in and out: types, shapes, layouts, and what the results promise."""

import numpy as np
import pytest

import morsmooth


def test_the_result_has_exactly_the_wanted_extrema(triangles, count_extrema):
    points, cells, values = triangles
    report = {}
    smooth = morsmooth.smooth((points, cells), values, extrema=7, report=report)
    minima, maxima, stray = count_extrema(smooth, cells)
    assert len(minima) + len(maxima) == 7 and not stray
    assert {entry["point"] for entry in report["wanted"]["minima"]} == minima
    assert {entry["point"] for entry in report["wanted"]["maxima"]} == maxima
    assert report["audit"]["passed"] and report["smooth"]["before"]["minima"] > 20
    for point in minima | maxima:
        assert smooth[point] == values[point]


def test_simplify_changes_little_and_keeps_wanted_values(tetrahedra, count_extrema):
    points, cells, values = tetrahedra
    simple = morsmooth.simplify((points, cells), values, persistence_abs=1.0)
    minima, maxima, stray = count_extrema(simple, cells)
    before = count_extrema(values, cells)
    assert minima < before[0] and maxima < before[1] and not stray
    assert all(simple[point] == values[point] for point in minima | maxima)


def test_keep_names_the_extrema(triangles, count_extrema):
    points, cells, values = triangles
    low, high = int(values.argmin()), int(values.argmax())
    smooth = morsmooth.smooth((points, cells), values, keep=[low, high], extremum_values="free")
    assert count_extrema(smooth, cells)[:2] == ({low}, {high})


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_floating_point_types_are_kept(triangles, dtype, count_extrema):
    points, cells, values = triangles
    smooth = morsmooth.smooth((points[:, :2], cells), values.astype(dtype), persistence="30%")
    assert smooth.dtype == dtype and not count_extrema(smooth, cells)[2]


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64])
def test_integers_are_read_as_float64(dtype):
    values = np.array([0, 9, 3, 4, 1, 60, 20], dtype)
    simple = morsmooth.simplify(array=values, persistence_abs=5)
    assert simple.dtype == np.float64
    assert (simple == morsmooth.simplify(array=values.astype(float), persistence_abs=5)).all()


def test_layout_and_byte_order_do_not_matter(equal):
    values = np.random.default_rng(1).standard_normal((12, 9, 5))
    expected = morsmooth.simplify(array=values, extrema=4)
    for same in (np.asfortranarray(values), values.astype(">f8"), np.repeat(values, 2, axis=1)[:, ::2]):
        assert equal(morsmooth.simplify(array=same, extrema=4), expected)
    assert values.flags.c_contiguous, "the input is not touched"


def test_axes_of_a_grid_are_x_y_z(triangles):
    # A ridge along the second axis; distances count by the spacing of each axis.
    values = np.add.outer(np.array([0.0, 3.0, 0.5]), np.linspace(0, 1, 6))
    pairs = morsmooth.persistence_pairs(array=values, spacing=(1.0, 100.0))
    # VTK's numbers have x fastest: the lowest value of the last row is at x = 2, y = 0.
    assert pairs.birth_point.tolist()[:2] == [0, 2] and pairs.death_point.tolist()[:2] == [-1, 1]
    assert pairs.birth.tolist()[:2] == [0.0, 0.5] and pairs.death.tolist()[:2] == [np.inf, 3.0]


def test_nan_and_masks_are_holes(equal):
    values = np.random.default_rng(2).standard_normal((20, 15))
    values[5:8, 4:9] = np.nan
    smooth = morsmooth.smooth(array=values, extrema=3)
    assert (np.isnan(smooth) == np.isnan(values)).all()
    filled = np.where(np.isnan(values), 7.0, values)
    masked = morsmooth.smooth(array=filled, mask=~np.isnan(values), extrema=3)
    assert equal(np.where(filled == 7.0, np.nan, masked), smooth) and (masked[np.isnan(values)] == 7.0).all()
    assert equal(morsmooth.smooth(array=filled, mask=(~np.isnan(values)).astype(np.int16), extrema=3), masked)


def test_a_mask_may_be_one_of_cells():
    values = np.random.default_rng(2).standard_normal((6, 5))
    mask = np.ones((5, 4), bool)
    mask[2:, :] = False
    smooth = morsmooth.smooth(array=values, mask=mask, extrema=2)
    assert (smooth[3:] == values[3:]).all() and (smooth[:3] != values[:3]).any()


def test_threads_do_not_change_a_bit(triangles, equal):
    points, cells, values = triangles
    one, three = (morsmooth.smooth((points, cells), values, persistence=0.2, threads=threads) for threads in (1, 3))
    assert equal(one, three)


def test_pairs_are_columns_of_one_length(tetrahedra):
    points, cells, values = tetrahedra
    pairs = morsmooth.persistence_pairs((points, cells), values)
    assert len({len(column) for column in pairs}) == 1
    assert [column.dtype for column in pairs] == [np.int8, np.float64, np.float64, np.int64, np.int64]
    finite = pairs.death_point >= 0
    assert (values[pairs.birth_point] == pairs.birth).all() and (values[pairs.death_point[finite]] == pairs.death[finite]).all()
    assert (~finite).sum() == 1 and pairs.dimension[~finite] == 0, "a block has one component and nothing else"
    assert set(pairs.dimension) == {0, 1, 2} and (np.diff(pairs.birth) >= 0).all()


def test_weights_without_a_mesh_library(triangles):
    points, cells, _ = triangles
    found = morsmooth.weights((points, cells), {"left": [0.0, 0.5, 0.0], "right": [1.0, 0.5, 0.0], "base": {"region": [0, 1, 2]}})
    assert found.names == ["left", "right", "base"] and found.weights.shape == (len(points), 3)
    assert (found.weights[:3] == [0, 0, 1]).all() and np.abs(found.weights.sum(axis=1) - 1).max() < 1e-5
    assert found.pivots[2] == pytest.approx(points[:3].mean(axis=0))
    assert found.weights.min() == 0 and found.weights.max() == 1


def test_deformed_triangles_keep_their_orientation(triangles):
    points, cells, _ = triangles
    # The base is an array of whole numbers, and so a region; the top is one place.
    handles = {"base": np.flatnonzero(points[:, 1] < 0.1), "top": [0.5, 1.0, 0.0]}
    pose = {"top": {"rotation_degrees": 90, "translation": [0.3, 0.1, 0]}}
    report = {}
    moved = morsmooth.deform((points, cells), handles, pose, report=report)
    corners = moved[cells][:, :, :2]
    (x, y), (u, v) = ((corners[:, place] - corners[:, 0]).T for place in (1, 2))
    area = x * v - y * u
    assert (area > 0).all() and report["optimal"] and moved.shape == points.shape
    top = np.abs(points - handles["top"]).sum(axis=1).argmin()
    assert moved[top] == pytest.approx(points[top] + [0.3, 0.1, 0], abs=0.05)
    given = morsmooth.weights((points, cells), handles, partition="free").weights
    assert (morsmooth.deform((points, cells), handles, pose, weights=given) == moved).all()


def test_distances_in_a_plane(triangles):
    points, cells, _ = triangles
    distances = morsmooth.geodesic((points, cells), [3])
    straight = np.linalg.norm(points - points[3], axis=1)
    # The sheet is not quite convex at its jittered border.
    assert (distances >= straight - 1e-12).all() and np.abs(distances - straight).max() < 0.02
    inside = morsmooth.geodesic((points, cells), [0.5, 0.5, 0.0])
    assert inside == pytest.approx(np.linalg.norm(points - [0.5, 0.5, 0], axis=1), abs=1e-9)
    heat = morsmooth.geodesic((points, cells), 3, method="heat")
    assert np.abs(heat - distances).max() < 0.15


def test_handles_are_not_guessed(triangles):
    points, cells, _ = triangles
    with pytest.raises(morsmooth.InputError, match=r'handle "a" is \[0, 1, 0\], which may be a place or point numbers\nhint: write \[0.0, 1.0, 0.0\]'):
        morsmooth.weights((points, cells), {"a": [0, 1, 0], "b": [1.0, 1.0, 0.0]})
    with pytest.raises(morsmooth.InputError, match='handle "a" is .*; expected a point'):
        morsmooth.weights((points, cells), {"a": [[[1.0]]], "b": [1.0, 1.0, 0.0]})
    with pytest.raises(TypeError, match="found handles of type int"):
        morsmooth.weights((points, cells), 3)

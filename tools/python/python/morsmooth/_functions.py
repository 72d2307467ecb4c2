"""The functions. Their options are those of the program's commands; each has the program's defaults."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, Optional, Union

import numpy as np

from . import _native
from ._calls import Progress, control, fraction, handles_source, pose_source, scene, told, wishes
from ._errors import InputError
from ._mesh import open_mesh


class Pairs(NamedTuple):
    """A persistence diagram, one entry a pair, by rising birth.

    Attributes:
        dimension: of the class, 0 component, 1 tunnel, 2 void; int8.
        birth: value at which it begins, in the units of the field; float64.
        death: value at which it ends; infinite for a class that never dies; float64.
        birth_point: number of the point at which it begins; int64.
        death_point: number of the point at which it ends, -1 for a class that never dies; int64.
    """

    dimension: np.ndarray
    birth: np.ndarray
    death: np.ndarray
    birth_point: np.ndarray
    death_point: np.ndarray


class Weights(NamedTuple):
    """Weights of handles.

    Attributes:
        weights: ``n x h``, point by point.
        names: of the handles, in the order of the columns.
        pivots: ``h x 3``, the places about which the handles turn.
    """

    weights: np.ndarray
    names: list[str]
    pivots: np.ndarray


class Fault(NamedTuple):
    """Something unusual about a mesh.

    Attributes:
        text: what, where, and what is made of it.
        is_cut: whether it says that points lie on each other, where the domain is cut: along the pieces of a parallel data set that
            were read without being merged, for one.
    """

    text: str
    is_cut: bool


def smooth(
    mesh: Any = None,
    array: Any = None,
    *,
    persistence: Union[float, str, None] = None,
    persistence_abs: Optional[float] = None,
    extrema: Optional[int] = None,
    keep: Any = None,
    select: Literal["data", "smooth"] = "data",
    extremum_values: Union[Literal["keep", "free"], float] = "keep",
    keep_also: Optional[Literal["saddles", "separatrices", "both"]] = None,
    order: int = 2,
    length: Union[float, str, None] = None,
    length_abs: Optional[float] = None,
    confidence: Any = None,
    smoothness: Any = None,
    representative: Literal["smooth-then-simplify", "flood", "separatrix", "harmonic"] = "smooth-then-simplify",
    edges: Literal["minimal", "all"] = "minimal",
    refine: int = 0,
    gap: float = 1e-8,
    raw: bool = False,
    mask: Any = None,
    spacing: Any = None,
    origin: Any = None,
    output_array: Optional[str] = None,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
    report: Optional[dict[str, Any]] = None,
) -> Any:
    """Smooths a scalar field so that it has exactly the wanted minima and maxima.

    The result ``f`` minimises ``l^(2k) E_k(f) + (f - h)^T D (f - h)`` among all fields with exactly the wanted extrema; ``E_k`` is
    the polyharmonic energy of order k, l the smoothing length, D the confidence times the mass. What is returned has been audited.

    Args:
        mesh: a data set of PyVista or VTK; or a pair (points, cells) with points ``n x 3`` (or ``n x 2``) and cells ``m x 2`` lines,
            ``m x 3`` triangles or ``m x 4`` tetrahedra, or the pair (list of cells ``[n, p0, ...]``, types) of VTK; or None for a grid.
        array: name of a point array of the mesh (not needed where it has one scalar array), or ``n`` values. For a grid, the values
            as a 1-, 2- or 3-D array; its first axis is x. float32 and float64 keep their type; integers are read as float64.
            NaN marks holes, which keep their NaN.
        persistence, persistence_abs, extrema, keep: which extrema are wanted, one of the four. Those whose persistence exceeds a
            part of the range (0.1 or "10%"); those whose persistence exceeds a value, in the units of the field; so many, the most
            persistent ones; those at these point numbers.
        select: whether extrema are measured on the data or on the unconstrained smooth field (for noisy data).
        extremum_values: "keep" the values at wanted extrema, "free", or a part of the range within which they stay.
        keep_also: keep values at saddles, along separatrices, or both, as well.
        order: k, 1 to 4.
        length, length_abs: smoothing length, as a part of the diagonal of the bounding box, or in the units of the points; by
            generalised cross-validation if None.
        confidence: n numbers not below 0, or the name of an array of them.
        smoothness: n numbers from 0 (a spike is allowed) to 1, or the name of an array of them.
        representative, edges, refine, gap: of the solver; see ``morsmooth smooth --help``.
        raw: return the raw optimum. Ties are left where the point numbers break them, so a plain < may see plateaus.
        mask: array on points or cells (or its name) whose zeros are holes.
        spacing, origin: of a grid, in units of length: one number or one an axis; 1 and 0 by default.
        output_array: name of the new array in a mesh; ``<array>_smooth`` by default.
        threads: as many as cores by default. The result has the same bits for any number.
        progress: called as ``progress(text, part)``, part rising from 0 to 1; what it raises ends the call.
        report: a dictionary that is filled with everything measured, as the program's ``--report``.

    Returns:
        The mesh with one more point array (a shallow copy), or the values alone in the shape and type in which they came. Under
        plain <, a wanted minimum is below all its neighbours, a wanted maximum above, and every other vertex has a neighbour
        below and one above. Grids are cut into triangles or tetrahedra by Freudenthal's subdivision, which decides who is a
        neighbour. Of equal input values, that of the lower point number counts as lower.

    Raises:
        InputError: what was given makes no sense; the message says what was found and what was expected.
        GuaranteeError: the audit of the result failed.

    Warns:
        NotOptimalWarning: the solver stopped before the result was proven optimal.
    """
    opened, name = scene(mesh, array, mask, spacing, origin)
    within = extremum_values if isinstance(extremum_values, (int, float)) else 0.0
    options = {
        "array": name,
        "mask": opened.find(mask, "mask", "both"),
        "select": select,
        "values": "within" if isinstance(extremum_values, (int, float)) else extremum_values,
        "within": float(within),
        "keep_also": keep_also,
        "order": order,
        "length": fraction(length),
        "length_abs": length_abs,
        "confidence": opened.find(confidence, "confidence"),
        "smoothness": opened.find(smoothness, "smoothness"),
        "representative": representative,
        "edges": edges,
        "refine": refine,
        "gap": gap,
        "raw": raw,
    }
    wanted = wishes(persistence, persistence_abs, extrema, keep)
    values, text = _native.smooth(opened.native, options, wanted, control(threads, progress))
    told(text, report)
    return opened.with_points({output_array or f"{name}_smooth": values})


def simplify(
    mesh: Any = None,
    array: Any = None,
    *,
    persistence: Union[float, str, None] = None,
    persistence_abs: Optional[float] = None,
    extrema: Optional[int] = None,
    keep: Any = None,
    order_array: bool = False,
    mask: Any = None,
    spacing: Any = None,
    origin: Any = None,
    output_array: Optional[str] = None,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
    report: Optional[dict[str, Any]] = None,
) -> Any:
    """Gives a scalar field exactly the wanted minima and maxima without smoothing it.

    Args:
        mesh, array, persistence, persistence_abs, extrema, keep, mask, spacing, origin, threads, progress, report: as in
            :func:`smooth`.
        order_array: add the array ``<output array>_Order`` to a mesh as well: int32, the rank of every point by (value, point
            number), NaN last, as TTK reads it.
        output_array: name of the new array in a mesh; ``<array>_simplified`` by default.

    Returns:
        As :func:`smooth`. Wanted extrema keep their values; the values are strict under plain <, without plateaus.

    Raises:
        InputError, GuaranteeError: as :func:`smooth`.
    """
    opened, name = scene(mesh, array, mask, spacing, origin)
    wanted = wishes(persistence, persistence_abs, extrema, keep)
    found = opened.find(mask, "mask", "both")
    values, text = _native.simplify(opened.native, name, found, wanted, control(threads, progress))
    told(text, report)
    target = output_array or f"{name}_simplified"
    arrays = {target: values}
    if order_array:
        ranks = np.empty(len(values), np.int32)
        # Both zeros are one value, and NaN comes last.
        ranks[np.argsort(values + 0.0, kind="stable")] = np.arange(len(values), dtype=np.int32)
        arrays[f"{target}_Order"] = ranks
    return opened.with_points(arrays)


def persistence_pairs(
    mesh: Any = None,
    array: Any = None,
    *,
    mask: Any = None,
    spacing: Any = None,
    origin: Any = None,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
) -> Pairs:
    """The persistence diagram of the sublevel sets of a scalar field, in all dimensions.

    Args:
        mesh, array, mask, spacing, origin, threads, progress: as in :func:`smooth`.

    Returns:
        All pairs that begin and end at different points, those of equal values included. The filtration is that of lower stars;
        of equal values, that of the lower point number counts as lower. Coefficients are those modulo 2. Maxima on the boundary of
        the domain are in no pair, since sublevel sets do not see them.

    Raises:
        InputError: as :func:`smooth`.
    """
    opened, name = scene(mesh, array, mask, spacing, origin)
    options = {"array": name, "mask": opened.find(mask, "mask", "both")}
    return Pairs(**_native.persistence_pairs(opened.native, options, control(threads, progress)))


def persistence_diagram(
    mesh: Any,
    array: Any = None,
    *,
    embed: bool = False,
    mask: Any = None,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
) -> Any:
    """The persistence diagram as lines from birth to death, in the layout of the Topology ToolKit.

    Args:
        mesh, array, mask, threads, progress: as in :func:`smooth`.
        embed: put the ends of the lines at their places in the domain, not into the plane of birth and death.

    Returns:
        An unstructured grid of the library that the mesh came from, with the arrays of ``morsmooth persistence``; for plain arrays a
        dictionary of ``points`` (float32), ``lines`` (int64, two a line), ``point_data`` and ``cell_data``.

    Raises:
        InputError: as :func:`smooth`.
    """
    opened, name = scene(mesh, array, mask)
    options = {"array": name, "mask": opened.find(mask, "mask", "both")}
    return opened.lines(_native.persistence_diagram(opened.native, options, embed, control(threads, progress)))


def faults(mesh: Any, *, threads: Optional[int] = None) -> list[Fault]:
    """What is unusual about a mesh: points on each other, edges of three triangles, cells without area and the like.

    Args:
        mesh, threads: as in :func:`smooth`.

    Returns:
        One entry a kind, none for a clean mesh. Computations take all meshes but those with cells without area or volume.

    Raises:
        InputError: as :func:`smooth`.
    """
    return [Fault(*found) for found in _native.faults(open_mesh(mesh).native, control(threads, None))]


def weights(
    mesh: Any,
    handles: Any,
    *,
    method: Literal["monotone", "bounded", "harmonic", "polyharmonic"] = "monotone",
    order: int = 2,
    partition: Literal["normalised", "free", "coupled"] = "normalised",
    strongest: Optional[int] = None,
    mass: Literal["voronoi", "barycentric"] = "voronoi",
    representative: Literal["automatic", "smooth-then-simplify", "harmonic"] = "automatic",
    refine: int = 0,
    gap: float = 1e-6,
    at_once: Optional[int] = None,
    precision: Literal[32, 64] = 64,
    prefix: str = "",
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
    report: Optional[dict[str, Any]] = None,
) -> Any:
    """Skinning weights: a function a handle, 1 on its own vertices and 0 on those of the others.

    Args:
        mesh: as in :func:`smooth`, but no grid; lines, triangles or tetrahedra in which every point is a corner.
        handles: the path of a .json or .tgf file as ``morsmooth weights --handles`` reads it; or what would stand in the .json; or a
            dictionary from names to handles: the coordinates (floats) of a point, two such ends of a bone, point numbers (integers)
            of a region, or ``{"point": ...}``, ``{"bone": ...}``, ``{"region": ...}``; or the name of an array of the mesh whose
            numbers say which points are which handle, as ``{"array": name}``.
        method: "monotone" has no extremum but at handles; "bounded" stays within 0 and 1 (order 2: bounded biharmonic weights);
            "harmonic" and "polyharmonic" are linear.
        order: k of the energy, 1 to 4; of harmonic weights 1 whatever it is.
        partition: divide weights by their sum and keep the guarantee ("normalised"), leave them ("free"), or solve for all handles
            at once ("coupled", for few handles on small meshes).
        strongest: leave only so many weights a point. Monotone weights lose their guarantee.
        mass, representative, refine, gap, at_once: of the solver; see ``morsmooth weights --help``.
        precision: bits in which monotone weights are strict.
        prefix: what comes before the name of a handle in the name of its array.
        threads, progress, report: as in :func:`smooth`.

    Returns:
        The mesh with a float64 (float32) point array a handle; for plain arrays :class:`Weights`.

    Raises:
        InputError: as :func:`smooth`.
        GuaranteeError: the audit found an extremum of monotone weights beside the handles.
    """
    opened = open_mesh(mesh)
    options = {
        "method": method,
        "order": order,
        "partition": partition,
        "strongest": strongest,
        "mass": mass,
        "representative": representative,
        "refine": refine,
        "gap": gap,
        "at_once": at_once,
        "precision": precision,
    }
    given = handle_source(opened, handles)
    rows, names, pivots, text = _native.weights(opened.native, given, options, control(threads, progress))
    told(text, report)
    rows = rows.astype(np.float32 if precision == 32 else np.float64, copy=False)
    if hasattr(opened, "dataset"):
        return opened.with_points({f"{prefix}{name}": rows[:, place] for place, name in enumerate(names)})
    return Weights(rows, names, np.array(pivots).reshape(-1, 3))


def handle_source(opened: Any, handles: Any) -> dict[str, Any]:
    """Handles for the extension module."""
    if isinstance(handles, dict) and set(handles) == {"array"} and isinstance(handles["array"], str):
        return {"path": None, "json": None, "array": opened.find(handles["array"], "handles", "both")}
    return handles_source(handles)


def deform(
    mesh: Any,
    handles: Any,
    pose: Any,
    *,
    weights: Any = None,
    weight_method: Literal["monotone", "bounded", "harmonic", "polyharmonic"] = "monotone",
    weight_order: int = 2,
    hard: bool = False,
    alpha: float = 1e4,
    incompressible: float = 0.0,
    rotation_rounds: int = 0,
    untangle: bool = False,
    gap: float = 1e-6,
    keep_best: bool = False,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
    report: Optional[dict[str, Any]] = None,
) -> Any:
    """Moves a shape by its handles so that no element turns inside out: least energy, certified.

    Args:
        mesh: as in :func:`smooth`, but no grid; triangles in a plane z = constant, or tetrahedra.
        handles: as in :func:`weights`.
        pose: the path of a .json or .dmat file as ``morsmooth deform --pose`` reads it; or what would stand in the .json; or a
            dictionary from names of handles to ``{"rotation_degrees": 90, "axis": [0, 0, 1], "quaternion": [w, x, y, z],
            "translation": [x, y, z], "scale": 1, "pivot": [x, y, z]}``, all of it optional. A point x goes to ``pivot + scale R (x -
            pivot) + translation``; angles are in degrees, right-handed, and whole turns count. Handles that are not named stay.
        weights: ``n x h`` weights in the order of the handles; computed if None.
        weight_method, weight_order: how they are computed.
        hard: handles hold exactly, not by springs.
        alpha: stiffness of the springs.
        incompressible: weight of linearised incompressibility, such as 0.3.
        rotation_rounds, untangle, gap: see ``morsmooth deform --help``.
        keep_best: where handles contradict each other, return the closest shape without inversions that is found.
        threads, progress, report: as in :func:`smooth`.

    Returns:
        The mesh with its points moved and the cell arrays ``det_F``, ``smallest_eigenvalue``, ``energy_density`` and
        ``active_constraint``; for plain arrays the ``n x 3`` places of the points. No element has a negative or zero determinant,
        in 64 bits and rounded to 32 bits, by exact predicates.

    Raises:
        InputError: as :func:`smooth`.
        ContradictionError: no shape without inversions has these handles; the message names them.
        GuaranteeError: the audit found inverted elements.

    Warns:
        NotOptimalWarning: the shape has no inversion but is not the certified optimum of what was asked.
    """
    opened = open_mesh(mesh)
    options = {
        "weight_method": weight_method,
        "weight_order": weight_order,
        "hard": hard,
        "alpha": alpha,
        "incompressible": incompressible,
        "rotation_rounds": rotation_rounds,
        "untangle": untangle,
        "gap": gap,
        "keep_best": keep_best,
    }
    if weights is not None:
        weights = np.ascontiguousarray(weights, np.float64)
        if weights.ndim != 2:
            raise InputError(f"found weights of shape {weights.shape}; expected points x handles")
    sources = handle_source(opened, handles), pose_source(pose)
    points, cells, text = _native.deform(opened.native, *sources, weights, options, control(threads, progress))
    told(text, report)
    return opened.moved(points, cells)


def geodesic(
    mesh: Any,
    sources: Any,
    *,
    method: Literal["exact", "heat"] = "exact",
    heat_time: float = 1.0,
    source_tolerance: Union[float, str] = 0.01,
    mask: Any = None,
    allow_unreached: bool = False,
    output_array: str = "geodesic_distance",
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
) -> Any:
    """Distances along a surface from the nearest of some sources.

    Args:
        mesh: as in :func:`smooth`, but no grid of values.
        sources: a point number, several of them (integers), or ``s x 3`` places (floats), of which the nearest points of the surface
            are sources, in faces, on edges or at vertices.
        method: "exact" for shortest paths on triangles; "heat" is fast and approximate, also on lines and in tetrahedra.
        heat_time: time of the heat flow in units of the squared mean length of the edges.
        source_tolerance: how far a place may lie off the surface, as a part of the diagonal of the bounding box.
        mask: array on points or cells (or its name) whose zeros are holes.
        allow_unreached: NaN where no path from a source arrives, instead of an error.
        output_array: name of the new array in a mesh.
        threads, progress: as in :func:`smooth`.

    Returns:
        The mesh with one more float64 point array, or the n distances, in the units of the points; NaN outside of the domain.

    Raises:
        InputError: as :func:`smooth`.
    """
    opened = open_mesh(mesh)
    given = np.asarray(sources)
    points, places = [], np.zeros((0, 3))
    if given.dtype.kind in "iu" and given.ndim <= 1:
        if given.size and given.min() < 0:
            raise InputError(f"found source {given.min()}; expected point numbers from 0 on")
        points = [int(point) for point in given.reshape(-1)]
    elif given.dtype.kind == "f" and given.ndim in (1, 2) and given.shape[-1:] == (3,):
        places = np.ascontiguousarray(given.reshape(-1, 3), np.float64)
    elif given.size:
        raise InputError(f"found sources of shape {given.shape} and type {given.dtype}; expected point numbers, or places of three floats")
    options = {
        "method": method,
        "heat_time": heat_time,
        "tolerance": fraction(source_tolerance),
        "allow_unreached": allow_unreached,
        "mask": opened.find(mask, "mask", "both"),
    }
    values = _native.geodesic(opened.native, points, places.tolist(), options, control(threads, progress))
    return opened.with_points({output_array: values})

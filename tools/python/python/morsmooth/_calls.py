"""What the functions share: options for the extension module, reports, warnings."""

from __future__ import annotations

import json
import logging
import os
import warnings
from collections.abc import Mapping
from typing import Any, Callable, Optional

import numpy as np

from ._errors import InputError, NotOptimalWarning
from ._mesh import GridMesh, Mesh, open_mesh

Progress = Callable[[str, float], None]
LOG = logging.getLogger("morsmooth")


def scene(mesh: Any, array: Any, mask: Any, spacing: Any = None, origin: Any = None) -> tuple[Mesh, str]:
    """The mesh and the name of the array that is worked on; without a mesh, the array is a grid of its own."""
    if mesh is None:
        if array is None or isinstance(array, str):
            raise InputError("found neither a mesh nor values; expected a mesh, or the values of a grid")
        grid = GridMesh(np.shape(array), spacing, origin)
        return grid, grid.choose(array)
    if spacing is not None or origin is not None:
        raise InputError("found spacing or origin together with a mesh; expected them with a grid of values only")
    opened = open_mesh(mesh)
    return opened, opened.choose(array, mask)


def wishes(persistence: Any, persistence_abs: Any, extrema: Any, keep: Any) -> dict[str, Any]:
    """Which extrema are wanted."""
    if keep is not None:
        keep = np.asarray(keep).reshape(-1)
        if keep.size and (keep.dtype.kind not in "iu" or keep.min() < 0):
            raise InputError("keep has something else than point numbers; expected numbers from 0 on")
        keep = [int(point) for point in keep]
    if extrema is not None and int(extrema) < 0:
        raise InputError(f"extrema is {extrema}; expected a number of extrema")
    return {
        "persistence": fraction(persistence),
        "persistence_abs": None if persistence_abs is None else float(persistence_abs),
        "extrema": None if extrema is None else int(extrema),
        "keep": keep,
    }


def fraction(value: Any) -> Optional[float]:
    """0.1 or "10%"."""
    if isinstance(value, str):
        text = value.strip()
        try:
            return float(text[:-1]) / 100.0 if text.endswith("%") else float(text)
        except ValueError:
            raise InputError(f"found '{value}'; expected a part such as 10% or 0.1") from None
    return None if value is None else float(value)


def control(threads: Optional[int], progress: Optional[Progress]) -> dict[str, Any]:
    """How the call is to run."""
    if threads is not None and threads < 1:
        raise InputError(f"found threads={threads}; expected at least 1")
    return {"threads": threads, "progress": progress}


def told(text: str, report: Optional[dict[str, Any]]) -> dict[str, Any]:
    """Hands on a report: notes to the log, a doubt as a warning, everything to the caller's dictionary."""
    found = json.loads(text)
    for note in found.get("notes", ()):
        LOG.info("%s", note)
    if found.get("optimal") is False:
        warnings.warn("the result keeps its guarantee but is not proven optimal; the report says more", NotOptimalWarning, stacklevel=3)
    if report is not None:
        report.clear()
        report.update(found)
    return found


def pose_source(given: Any) -> dict[str, Any]:
    """A pose: the path of a file, what would stand in one, or transforms by the names of handles."""
    if isinstance(given, Mapping):
        is_file = set(given) == {"handles"} and isinstance(given["handles"], Mapping) and not set(given["handles"]) & TRANSFORM
        return in_json(given if is_file else {"handles": dict(given)})
    return in_file(given, "a pose")


def handles_source(given: Any) -> dict[str, Any]:
    """Handles: the path of a file, what would stand in one, or handles by their names."""
    if isinstance(given, Mapping):
        is_file = isinstance(given.get("handles"), list) and all(isinstance(entry, Mapping) for entry in given["handles"])
        return in_json(given if is_file else {"handles": [handle(name, shape) for name, shape in given.items()]})
    return in_file(given, "handles")


TRANSFORM = {"rotation_degrees", "axis", "quaternion", "translation", "scale", "pivot"}


def in_file(given: Any, what: str) -> dict[str, Any]:
    if isinstance(given, (str, os.PathLike)):
        return {"path": os.fspath(given), "json": None, "array": None}
    raise TypeError(f"found {what} of type {type(given).__name__}; expected the path of a file or a dictionary")


def in_json(content: Mapping[str, Any]) -> dict[str, Any]:
    return {"path": None, "json": json.dumps(content, default=plain), "array": None}


def handle(name: str, shape: Any) -> dict[str, Any]:
    """A handle as it stands in a file; plain numbers are told apart by their shape and type."""
    if isinstance(shape, Mapping):
        return {"name": name, **shape}
    array = np.asarray(shape)
    if array.shape in ((2, 3), (2, 2)):
        return {"name": name, "bone": array.tolist()}
    if array.dtype.kind == "f" and array.shape in ((3,), (2,)):
        return {"name": name, "point": array.tolist()}
    if array.dtype.kind not in "iu" or array.ndim > 1:
        raise InputError(f'handle "{name}" is {shape!r}; expected a point (2 or 3 floats), a bone (2 points), or a list of point numbers')
    if array.size in (2, 3) and not isinstance(shape, np.ndarray):
        text = f'handle "{name}" is {shape!r}, which may be a place or point numbers'
        raise InputError(text, [f'write {[float(part) for part in array]} for a place, {{"region": {array.tolist()}}} for point numbers'])
    return {"name": name, "region": array.reshape(-1).tolist()}


def plain(value: Any) -> Any:
    """Numpy's numbers and arrays in JSON."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"found {type(value).__name__}; expected numbers, texts and lists")

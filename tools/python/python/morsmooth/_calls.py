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


def source(given: Any, what: str, key: str) -> dict[str, Any]:
    """Handles or a pose: the path of a file, or what would stand in one."""
    if isinstance(given, (str, os.PathLike)):
        return {"path": os.fspath(given), "json": None, "array": None}
    if isinstance(given, Mapping):
        content = given if isinstance(given.get(key), (list, Mapping)) and not is_entry(given[key]) else {key: listed(given, key)}
        return {"path": None, "json": json.dumps(content, default=plain), "array": None}
    raise TypeError(f"found {what} of type {type(given).__name__}; expected the path of a file or a dictionary")


def is_entry(value: Any) -> bool:
    """Whether a value is one handle called 'handles', not the list of a file."""
    return isinstance(value, list) and (not value or not isinstance(value[0], Mapping))


def listed(given: Mapping[str, Any], key: str) -> Any:
    """Poses by name as they are; handles by name in the form of the file, told apart by their shape."""
    if all(isinstance(entry, Mapping) for entry in given.values()):
        return [{"name": name, **entry} for name, entry in given.items()] if any(is_handle(entry) for entry in given.values()) else dict(given)
    entries = []
    for name, shape in given.items():
        array = np.asarray(shape)
        kind = "bone" if array.shape in ((2, 3), (2, 2)) else "point" if array.dtype.kind == "f" and array.shape in ((3,), (2,)) else "region"
        entries.append({"name": name, kind: array.reshape(-1).tolist() if kind == "region" else array.tolist()})
    return entries


def is_handle(entry: Mapping[str, Any]) -> bool:
    return bool({"point", "bone", "region"} & set(entry))


def plain(value: Any) -> Any:
    """Numpy's numbers and arrays in JSON."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"found {type(value).__name__}; expected numbers, texts and lists")

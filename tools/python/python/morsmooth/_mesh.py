"""Meshes and grids in the forms in which callers have them, and results in the same form.

Nothing here imports VTK or PyVista: a data set of either brings its own modules with it.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any, Optional

import numpy as np

from ._errors import InputError
from ._native import Mesh as NativeMesh

TRIANGLE, TETRAHEDRON, LINE = 5, 10, 3
CELLS_BY_WIDTH = {2: LINE, 3: TRIANGLE, 4: TETRAHEDRON}
GHOSTS = "vtkGhostType"
IMPLICIT = ("vtkAffineArray", "vtkConstantArray", "vtkCompositeArray", "vtkIndexedArray", "vtkStdFunctionArray")


def is_vtk(mesh: Any) -> bool:
    """Whether an object is a data set of VTK, PyVista's included."""
    return hasattr(mesh, "IsA") and bool(mesh.IsA("vtkDataObject"))


def open_mesh(mesh: Any, spacing: Any = None) -> "Mesh":
    """The mesh behind any of the forms that the functions take."""
    if isinstance(mesh, Mesh):
        return mesh
    if is_vtk(mesh):
        if not mesh.IsA("vtkDataSet"):
            raise InputError(f"found {mesh.GetClassName()}; expected one data set", ["take its blocks one after the other"])
        return VtkMesh(mesh)
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return ArrayMesh(*mesh)
    raise TypeError(
        f"found a mesh of type {type(mesh).__name__}; expected a data set of PyVista or VTK, a pair (points, cells), "
        "or None with the values as a 1-, 2- or 3-D array"
    )


def numbers(values: Any, what: str) -> np.ndarray:
    """Contiguous numbers in native byte order, in the type that they have; booleans as bytes, half floats wider."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise InputError(f"{what} has values of type {array.dtype}; expected numbers")
    if array.dtype.kind == "b":
        array = array.astype(np.uint8)
    elif array.dtype.kind == "f" and array.dtype.itemsize not in (4, 8):
        array = array.astype(np.float32 if array.dtype.itemsize < 4 else np.float64)
    return np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))


def positions(points: Any) -> np.ndarray:
    """``n x 3`` floating-point positions; two coordinates become three."""
    points = numbers(points, "points")
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise InputError(f"found points of shape {points.shape}; expected n x 2 or n x 3")
    if points.dtype.kind != "f":
        points = points.astype(np.float64)
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points), points.dtype)])
    return np.ascontiguousarray(points)


class Mesh:
    """A mesh for the extension module, and what a result looks like for its caller."""

    native: NativeMesh

    def add(self, values: Any, name: str, place: Optional[str] = None) -> str:
        """Adds an array on the points (or, by its length or by ``place``, on the cells) and gives its name."""
        array = numbers(values, name)
        flat = array.reshape(-1)
        points, cells = self.native.point_count, self.native.cell_count
        if place == "cells" or (place is None and flat.size == cells != points):
            self.native.set_cell_array(name, flat)
        elif flat.size == points:
            self.native.set_point_array(name, flat)
        else:
            expected = f"{points}, one a point" + (f", or {cells}, one a cell" if place is None else "")
            raise InputError(f"{name} has {flat.size} values; expected {expected}")
        return name

    def find(self, array: Any, name: str, places: str = "points") -> Optional[str]:
        """Brings an array, given by its name in the mesh or as numbers, into the mesh. ``None`` stays ``None``."""
        if array is None:
            return None
        if isinstance(array, str):
            return self.take(array, places)
        return self.add(array, name, "points" if places == "points" else None)

    def take(self, name: str, places: str) -> str:
        """Brings an array of the data set into the mesh."""
        raise InputError(f"found the name '{name}'; expected an array: a mesh of plain arrays has no names")

    def choose(self, array: Any, mask: Any = None) -> str:
        """The array that is worked on; without a name, the only scalar one that is not the mask."""
        if array is None:
            raise InputError("found no array; expected one to work on")
        name = self.find(array, "values")
        assert name is not None
        return name

    def with_points(self, arrays: dict[str, np.ndarray]) -> Any:
        """The answer to a call that made point arrays."""
        raise NotImplementedError

    def moved(self, points: np.ndarray, cells: dict[str, np.ndarray]) -> Any:
        """The answer to a call that moved the points."""
        raise NotImplementedError

    def lines(self, parts: dict[str, Any]) -> Any:
        """An unstructured grid of lines, in the library that the mesh came from; plain arrays as they are."""
        return parts


class ArrayMesh(Mesh):
    """Points and simplices, or cells in VTK's list ``[n, p0, ... pn-1, n, ...]`` with their types."""

    def __init__(self, points: Any, cells: Any):
        points = positions(points)
        if isinstance(cells, (tuple, list)) and len(cells) == 2 and np.ndim(cells[0]) == 1:
            offsets, connectivity, types = unpack(np.asarray(cells[0]), np.asarray(cells[1]))
        else:
            cells = np.asarray(cells)
            if cells.ndim != 2 or cells.shape[1] not in CELLS_BY_WIDTH or cells.dtype.kind not in "iu":
                raise InputError(
                    f"found cells of shape {cells.shape} and type {cells.dtype}; expected whole numbers, m x 2 lines, m x 3 "
                    "triangles or m x 4 tetrahedra"
                )
            offsets = np.arange(0, cells.size + 1, cells.shape[1], dtype=np.int64)
            connectivity = np.ascontiguousarray(cells.reshape(-1), dtype=np.int64)
            types = np.full(len(cells), CELLS_BY_WIDTH[cells.shape[1]], np.uint8)
        self.native = NativeMesh.grid(points, (offsets, connectivity), types)

    def with_points(self, arrays):
        return next(iter(arrays.values()))

    def moved(self, points, cells):
        return points


def unpack(cells: np.ndarray, types: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Offsets, point numbers and types of VTK's old list of cells."""
    sizes, place = [], 0
    while place < len(cells):
        sizes.append(int(cells[place]))
        place += 1 + max(sizes[-1], 0)
    offsets = np.concatenate([[0], np.cumsum(sizes, dtype=np.int64)]).astype(np.int64)
    is_point = np.ones(len(cells), bool)
    is_point[(offsets[:-1] + np.arange(len(sizes)))] = False
    return offsets, np.ascontiguousarray(cells[is_point], dtype=np.int64), np.ascontiguousarray(types, dtype=np.uint8)


class GridMesh(Mesh):
    """A regular grid around an array of values. The first axis of the array is x."""

    def __init__(self, shape: tuple[int, ...], spacing: Any = None, origin: Any = None):
        if not 1 <= len(shape) <= 3 or 0 in shape:
            raise InputError(f"found values of shape {tuple(shape)}; expected a 1-, 2- or 3-D array for a grid, or a mesh")
        self.shape = tuple(int(length) for length in shape)
        dims = self.shape + (1,) * (3 - len(shape))
        extent = [bound for length in dims for bound in (0, length - 1)]
        spacing = triple(spacing, 1.0, len(shape), "spacing")
        origin = triple(origin, 0.0, len(shape), "origin")
        self.native = NativeMesh.image(extent, origin, spacing, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])

    def add(self, values, name, place=None):
        array = numbers(values, name)
        cells = tuple(max(length - 1, 1) for length in self.shape)
        if array.shape == self.shape and place != "cells":
            # VTK counts points with x fastest.
            self.native.set_point_array(name, np.ascontiguousarray(array.reshape(-1, order="F")))
        elif place is None and array.shape == cells:
            self.native.set_cell_array(name, np.ascontiguousarray(array.reshape(-1, order="F")))
        else:
            expected = f"{self.shape}" + (f", or {cells} for cells" if place is None else "")
            raise InputError(f"{name} has the shape {array.shape}; expected {expected}")
        return name

    def with_points(self, arrays):
        return next(iter(arrays.values())).reshape(self.shape, order="F")


def triple(values: Any, default: float, axes: int, what: str) -> list[float]:
    """Three numbers from one, one an axis, or none."""
    if values is None:
        return [default] * 3
    flat = np.asarray(values, np.float64).reshape(-1)
    if flat.size == 1:
        return [float(flat[0])] * 3
    if flat.size not in (axes, 3):
        raise InputError(f"{what} has {flat.size} numbers; expected 1 or {axes}")
    return [float(value) for value in flat] + [default] * (3 - flat.size)


class VtkMesh(Mesh):
    """A data set of VTK; of PyVista or ParaView, which is the same."""

    def __init__(self, dataset: Any):
        self.dataset = dataset
        self.package = vtk_package(dataset)
        self.support = self._module("util.numpy_support")
        self.native = self._geometry()
        for place in ("Point", "Cell"):
            ghosts = self._array(place, GHOSTS)
            if ghosts is not None:
                getattr(self.native, f"set_{place.lower()}_array")(GHOSTS, numbers(ghosts, GHOSTS))

    def _module(self, name: str) -> Any:
        """A module of the VTK that the data set is of."""
        return importlib.import_module(f"{self.package}.{name}")

    def _geometry(self) -> NativeMesh:
        data = self.dataset
        if data.IsA("vtkImageData"):
            matrix = data.GetDirectionMatrix() if hasattr(data, "GetDirectionMatrix") else None
            direction = [matrix.GetElement(i, j) if matrix else float(i == j) for i in range(3) for j in range(3)]
            return NativeMesh.image(list(data.GetExtent()), list(data.GetOrigin()), list(data.GetSpacing()), direction)
        if data.IsA("vtkRectilinearGrid"):
            axes = (data.GetXCoordinates(), data.GetYCoordinates(), data.GetZCoordinates())
            return NativeMesh.rectilinear(list(data.GetExtent()), *(np.ascontiguousarray(self._numpy(axis), np.float64) for axis in axes))
        points = data.GetPoints()
        places = positions(self._numpy(points.GetData())) if points and points.GetNumberOfPoints() else np.zeros((0, 3))
        if data.IsA("vtkStructuredGrid"):
            return NativeMesh.structured(list(data.GetExtent()), places)
        if data.IsA("vtkPolyData"):
            return NativeMesh.poly(places, *(self._cells(part) for part in (data.GetVerts(), data.GetLines(), data.GetPolys(), data.GetStrips())))
        if data.IsA("vtkUnstructuredGrid"):
            try:
                types = data.GetCellTypes()
            except TypeError:
                # VTK before 9.6.
                types = data.GetCellTypesArray()
            types = self._numpy(types) if types and data.GetNumberOfCells() else np.zeros(0, np.uint8)
            return NativeMesh.grid(places, self._cells(data.GetCells()), np.ascontiguousarray(types, np.uint8))
        raise InputError(f"found {data.GetClassName()}; expected image data, a rectilinear, structured or unstructured grid, or poly data")

    def _cells(self, cells: Any) -> tuple[np.ndarray, np.ndarray]:
        if cells is None or cells.GetNumberOfCells() == 0:
            return np.zeros(1, np.int64), np.zeros(0, np.int64)
        offsets, connectivity = cells.GetOffsetsArray(), cells.GetConnectivityArray()
        return tuple(np.ascontiguousarray(self._numpy(part), np.int64) for part in (offsets, connectivity))

    def _numpy(self, array: Any) -> np.ndarray:
        if any(kind in array.GetClassName() for kind in IMPLICIT):
            # Numbers that are computed when they are asked for have no memory to look at.
            plain = self.support.create_vtk_array(array.GetDataType())
            plain.DeepCopy(array)
            array = plain
        return self.support.vtk_to_numpy(array)

    def _data(self, place: str) -> Any:
        return self.dataset.GetPointData() if place == "Point" else self.dataset.GetCellData()

    def _array(self, place: str, name: str) -> Optional[np.ndarray]:
        array = self._data(place).GetArray(name)
        return None if array is None else self._numpy(array)

    def _names(self, place: str) -> list[str]:
        data = self._data(place)
        return [data.GetArrayName(i) or "" for i in range(data.GetNumberOfArrays()) if data.GetArray(i) is not None]

    def take(self, name, places):
        point = self._array("Point", name)
        cell = self._array("Cell", name) if places == "both" else None
        if point is None and cell is None:
            if places == "both":
                known = ", ".join(self._names("Point") + self._names("Cell"))
                raise InputError(f'found no point or cell array "{name}"; expected one of: {known}')
            hints = [f"scalar point arrays: {', '.join(self._scalars())}"]
            if name in self._names("Cell"):
                hints.append(f"'{name}' is a cell array; turn it into a point array first (ParaView: Cell Data to Point Data)")
            raise InputError(f"found no point array '{name}'; expected one of those in the mesh", hints)
        if point is not None:
            self.native.set_point_array(name, numbers(point, name))
        if cell is not None:
            self.native.set_cell_array(name, numbers(cell, name))
        return name

    def _scalars(self) -> list[str]:
        data = self._data("Point")
        return [name for name in self._names("Point") if data.GetArray(name).GetNumberOfComponents() == 1 and not name.startswith("vtkGhost")]

    def choose(self, array, mask=None):
        if array is not None:
            return super().choose(array)
        found = [name for name in self._scalars() if not (isinstance(mask, str) and name == mask)]
        if len(found) == 1:
            return self.take(found[0], "points")
        if not found:
            raise InputError("found no scalar point array; expected one to work on")
        raise InputError(f"found {len(found)} scalar point arrays; expected array=NAME", [f"scalar point arrays: {', '.join(found)}"])

    def _copy(self) -> Any:
        """The data set with arrays of its own around the same numbers."""
        if hasattr(self.dataset, "copy"):
            return self.dataset.copy(deep=False)
        copy = self.dataset.NewInstance()
        copy.ShallowCopy(self.dataset)
        return copy

    def _set(self, data: Any, name: str, values: np.ndarray) -> None:
        array = self.support.numpy_to_vtk(np.ascontiguousarray(values), deep=False)
        array.SetName(name)
        data.AddArray(array)

    def with_points(self, arrays):
        result = self._copy()
        for name, values in arrays.items():
            self._set(result.GetPointData(), name, values)
        return result

    def moved(self, points, cells):
        result = self._copy()
        old = result.GetPoints()
        # In the numbers that the mesh had.
        dtype = np.float32 if old.GetDataType() == 10 else np.float64
        new = old.NewInstance()
        new.SetData(self.support.numpy_to_vtk(np.ascontiguousarray(points, dtype), deep=False))
        result.SetPoints(new)
        for name, values in cells.items():
            self._set(result.GetCellData(), name, values)
        return result

    def lines(self, parts):
        core, data_model = self._module("vtkCommonCore"), self._module("vtkCommonDataModel")
        grid = data_model.vtkUnstructuredGrid()
        points = core.vtkPoints()
        points.SetData(self.support.numpy_to_vtk(parts["points"], deep=True))
        grid.SetPoints(points)
        ends = parts["lines"].reshape(-1, 2)
        cells = data_model.vtkCellArray()
        offsets = np.arange(0, ends.size + 1, 2, dtype=np.int64)
        to_vtk = lambda values: self.support.numpy_to_vtk(values, deep=True, array_type=self.support.get_vtk_array_type(np.int64))
        cells.SetData(to_vtk(offsets), to_vtk(ends.reshape(-1)))
        grid.SetCells(LINE, cells)
        for data, arrays in ((grid.GetPointData(), parts["point_data"]), (grid.GetCellData(), parts["cell_data"])):
            for name, values in arrays.items():
                self._set(data, name, values)
        pyvista = sys.modules.get("pyvista")
        return pyvista.wrap(grid) if pyvista and isinstance(self.dataset, pyvista.DataSet) else grid


def vtk_package(dataset: Any) -> str:
    """The package that the data set's class comes from; there may be several VTKs in a process."""
    for kind in type(dataset).__mro__:
        package, _, module = kind.__module__.rpartition(".")
        if module == "vtkCommonDataModel":
            return package
    return "vtkmodules"

"""Opens what `morsmooth persistence` and `morsmooth simplify` write with VTK, and checks arrays, types and counts.

    pip install vtk numpy
    python tools/vtk/diagram.py --program target/release/morsmooth datasets/jet.vti --array vorticity_magnitude --mask valid

Types are asserted through SafeDownCast, as TTK does; layout and meaning as TTK documents them.
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

READERS = {
    ".vti": vtk.vtkXMLImageDataReader,
    ".vtu": vtk.vtkXMLUnstructuredGridReader,
    ".vtp": vtk.vtkXMLPolyDataReader,
    ".vtk": vtk.vtkDataSetReader,
}


def read(path):
    reader = READERS[path.suffix]()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def array(attributes, name, kind, components=1):
    """The array of that name; it must downcast to the VTK class that TTK asks for."""
    found = attributes.GetAbstractArray(name)
    assert found is not None, f"no array {name}"
    assert kind.SafeDownCast(found) is not None, f"{name} is {found.GetClassName()}, expected {kind.__name__}"
    assert found.GetNumberOfComponents() == components, name
    return vtk_to_numpy(found)


def check_diagram(path, field, scalar_class, embedded):
    diagram = read(path)
    points, cells = diagram.GetPointData(), diagram.GetCellData()
    assert diagram.GetPoints().GetDataType() == vtk.VTK_FLOAT
    ids = array(points, "ttkVertexScalarField", vtk.vtkIntArray)
    kinds = array(points, "CriticalType", vtk.vtkIntArray)
    identifier = array(cells, "PairIdentifier", vtk.vtkIntArray)
    pair_type = array(cells, "PairType", vtk.vtkIntArray)
    persistence = array(cells, "Persistence", scalar_class).astype(float)
    birth = array(cells, "Birth", scalar_class).astype(float)
    finite = array(cells, "IsFinite", vtk.vtkUnsignedCharArray)
    assert points.HasArray("Coordinates") == (0 if embedded else 1)
    pairs = len(identifier) if embedded else len(identifier) - 1
    assert diagram.GetNumberOfPoints() == 2 * pairs
    assert all(diagram.GetCellType(cell) == vtk.VTK_LINE for cell in range(diagram.GetNumberOfCells()))
    assert np.array_equal(identifier[:pairs], np.arange(pairs))
    low, high = ids[0::2], ids[1::2]
    assert np.array_equal(birth[:pairs], field[low]) and np.allclose(persistence[:pairs], field[high] - field[low], rtol=1e-6)
    order = np.lexsort((np.arange(len(field)), field))
    rank = np.empty(len(field), int)
    rank[order] = np.arange(len(field))
    assert (np.diff(rank[low]) >= 0).all(), "pairs by birth"
    assert finite[0] == 0 and (kinds[0], kinds[1]) == (0, 3) and persistence[0] == persistence[:pairs].max()
    dimension = pair_type.max() + 1
    for kind in range(dimension):
        of_kind = (pair_type[:pairs] == kind) & (finite[:pairs] == 1)
        expected_birth = 2 if dimension == 2 and kind == 1 else kind
        expected_death = 3 if kind == dimension - 1 else kind + 1
        assert (kinds[0::2][of_kind] == expected_birth).all() and (kinds[1::2][of_kind] == expected_death).all()
    where = vtk_to_numpy(diagram.GetPoints().GetData())
    if not embedded:
        assert (identifier[-1], pair_type[-1], finite[-1]) == (-1, -1, 0)
        corners = diagram.GetCell(diagram.GetNumberOfCells() - 1).GetPointIds()
        assert (corners.GetId(0), corners.GetId(1)) == (0, 2 * (pairs - 1))
        assert np.allclose(where[0::2], np.c_[field[low], field[low], 0 * low], rtol=1e-6)
        assert np.allclose(where[1::2], np.c_[field[low], field[high], 0 * low], rtol=1e-6)
    return pairs, dict(zip(*np.unique(pair_type[:pairs], return_counts=True)))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default="target/release/morsmooth")
    parser.add_argument("input", type=Path)
    parser.add_argument("--array")
    parser.add_argument("--mask")
    parser.add_argument("--persistence", default="10%")
    options = parser.parse_args()
    common = [item for flag in ("array", "mask") if getattr(options, flag) for item in (f"--{flag}", getattr(options, flag))]

    def run(*words):
        subprocess.run([options.program, *map(str, words), *common, "--quiet"], check=True)

    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        data = read(options.input)
        scalars = data.GetPointData().GetAbstractArray(options.array) if options.array else data.GetPointData().GetAbstractArray(0)
        field = vtk_to_numpy(scalars).astype(float)
        scalar_class = getattr(vtk, scalars.GetClassName().replace("vtkAOSDataArrayTemplate", "vtkDataArray"))
        for embed in ([], ["--embed"]):
            target = folder / "diagram.vtu"
            run("persistence", options.input, target, *embed)
            print("diagram", "embedded" if embed else "plane", *check_diagram(target, field, scalar_class, bool(embed)))
        target = folder / f"simplified{options.input.suffix}"
        run("simplify", options.input, target, "--persistence", options.persistence, "--order-array", "--output-array", "simple")
        simple = read(target).GetPointData()
        values = vtk_to_numpy(simple.GetArray("simple")).astype(float)
        order = array(simple, "simple_Order", vtk.vtkIntArray)
        assert np.array_equal(np.sort(order), np.arange(len(values)))
        assert np.array_equal(order, np.argsort(np.lexsort((np.arange(len(values)), values))))
        print("simplified: order array is the permutation of its values; largest change", np.abs(values - field).max())


if __name__ == "__main__":
    main()

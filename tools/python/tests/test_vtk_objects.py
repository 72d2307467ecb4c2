"""Every kind of data set of VTK and PyVista in, the same kind out."""

import numpy as np
import pytest

import morsmooth

pv = pytest.importorskip("pyvista", reason="PyVista is not installed")
vtk = pytest.importorskip("vtk", reason="VTK is not installed")


def field(points, seed=5):
    random = np.random.default_rng(seed)
    return np.sin(3 * points[:, 0]) + np.cos(2 * points[:, 1] + points[:, 2]) + 0.2 * random.standard_normal(len(points))


def kinds():
    image = pv.ImageData(dimensions=(9, 7, 6), spacing=(0.4, 0.5, 0.6), origin=(1, 2, 3))
    turned = image.copy()
    turned.direction_matrix = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    shifted = image.extract_subset((2, 8, 1, 6, 0, 5), rebase_coordinates=False) if hasattr(image, "extract_subset") else image
    rectilinear = pv.RectilinearGrid(np.linspace(0, 1, 8) ** 2, np.linspace(0, 2, 7), np.array([0.0, 1.0, 1.5]))
    structured = pv.StructuredGrid(*np.meshgrid(np.linspace(0, 1, 8), np.linspace(0, 1, 9), [0.0], indexing="ij"))
    sphere = pv.Sphere(theta_resolution=14, phi_resolution=12)
    quads = pv.Plane(i_resolution=9, j_resolution=8)
    return {
        "image": image,
        "turned": turned,
        "shifted": shifted,
        "rectilinear": rectilinear,
        "structured": structured,
        "triangles": sphere,
        "quads": quads,
        "strips": sphere.strip(),
        "line": pv.MultipleLines(points=np.column_stack([np.linspace(0, 6, 40), np.zeros(40), np.zeros(40)])),
        "hexahedra": image.cast_to_unstructured_grid(),
        "tetrahedra": sphere.delaunay_3d(),
    }


@pytest.mark.parametrize("kind", kinds())
def test_every_kind_comes_back_as_it_is(kind, program, tmp_path, equal):
    mesh = kinds()[kind]
    mesh["h"] = field(mesh.points)
    mesh.cell_data["number"] = np.arange(mesh.n_cells)
    before = mesh.copy()
    found = morsmooth.smooth(mesh, "h", extrema=4)
    assert type(found) is type(mesh) and mesh == before, "the mesh that was given is left alone"
    assert set(found.array_names) == {*mesh.array_names, "h_smooth"} and equal(found.points, mesh.points)
    extension = {"ImageData": "vti", "RectilinearGrid": "vtr", "StructuredGrid": "vts", "PolyData": "vtp"}.get(type(mesh).__name__, "vtu")
    source, target = tmp_path / f"in.{extension}", tmp_path / f"out.{extension}"
    mesh.save(source)
    program("smooth", source, target, "--array", "h", "--extrema", "4")
    assert equal(found["h_smooth"], pv.read(target)["h_smooth"])


def test_objects_of_plain_vtk():
    from vtkmodules.util import numpy_support

    grid = vtk.vtkImageData()
    grid.SetDimensions(11, 9, 1)
    values = numpy_support.numpy_to_vtk(np.random.default_rng(1).standard_normal(99), deep=True)
    values.SetName("h")
    grid.GetPointData().AddArray(values)
    found = morsmooth.simplify(grid, extrema=3, output_array="simple")
    assert type(found) is type(vtk.vtkImageData()) and found.GetPointData().GetArray("simple").GetNumberOfTuples() == 99
    assert grid.GetPointData().GetArray("simple") is None
    diagram = morsmooth.persistence_diagram(grid)
    assert type(diagram) is type(vtk.vtkUnstructuredGrid()) and diagram.GetCellType(0) == vtk.VTK_LINE
    assert diagram.GetNumberOfPoints() == 2 * (diagram.GetNumberOfCells() - 1)


def test_ghosts_and_masks(equal):
    mesh = pv.ImageData(dimensions=(12, 10, 1))
    mesh["h"] = field(mesh.points)
    keep = mesh.points[:, 0] < 8
    mesh["keep"] = keep
    hidden = mesh.copy()
    hidden["vtkGhostType"] = np.where(keep, 0, 2).astype(np.uint8)
    by_ghosts = morsmooth.smooth(hidden, "h", extrema=3)["h_smooth"]
    by_name = morsmooth.smooth(mesh, "h", extrema=3, mask="keep")["h_smooth"]
    by_array = morsmooth.smooth(mesh, "h", extrema=3, mask=keep)["h_smooth"]
    assert equal(by_ghosts, by_name) and equal(by_ghosts, by_array) and (by_ghosts[~keep] == mesh["h"][~keep]).all()
    whole = morsmooth.smooth(mesh, "h", extrema=3)["h_smooth"]
    assert not equal(by_ghosts, whole)


def test_the_only_scalar_array_is_found():
    mesh = pv.Sphere()
    mesh["h"] = field(mesh.points)
    mesh["keep"] = np.ones(mesh.n_points)
    with pytest.raises(morsmooth.InputError, match="found 2 scalar point arrays; expected array=NAME\nhint: .*h, keep"):
        morsmooth.smooth(mesh, extrema=3)
    assert "h_smooth" in morsmooth.smooth(mesh, extrema=3, mask="keep").array_names


def test_what_cannot_be_done_is_refused():
    mesh = pv.Sphere()
    mesh["h"] = field(mesh.points)
    mesh.cell_data["c"] = np.arange(float(mesh.n_cells))
    cases = [
        (pv.MultiBlock([mesh]), "h", "found (Multi|vtkMulti)", {}),
        (mesh, "Normals", "array 'Normals' has 3 components; expected 1", {}),
        (mesh, "c", "found no point array 'c'.*\n.*\nhint: 'c' is a cell array", {}),
        (mesh, np.zeros(3), "values has 3 values; expected 842, one a point", {}),
        (mesh, np.array(["a"] * 842), "values has values of type <U1; expected numbers", {}),
        (mesh, "h", "mask has 5 values; expected 842, one a point, or 1680, one a cell", {"mask": np.ones(5)}),
        (mesh, "h", "found 2 of persistence, persistence_abs, extrema, keep; expected one", {"persistence": 0.1}),
        (mesh, "h", "spacing", {"spacing": 2.0}),
        (pv.PolyData(), np.zeros(0), "the domain is empty", {}),
        (pv.PolyData(mesh.points), field(mesh.points), "the domain is empty", {}),
    ]
    for given, array, text, more in cases:
        with pytest.raises(morsmooth.InputError, match=text):
            morsmooth.smooth(given, array, extrema=3, **more)
    quadratic = pv.UnstructuredGrid([6, 0, 1, 2, 3, 4, 5], [22], np.random.default_rng(0).random((6, 3)))
    with pytest.raises(morsmooth.InputError, match=r"VTK type 22 \(quadratic triangle\)"):
        morsmooth.smooth(quadratic, np.arange(6.0), extrema=2)
    with pytest.raises(morsmooth.InputError, match="found ImageData, whose points cannot move"):
        morsmooth.deform(pv.ImageData(dimensions=(3, 3, 1)), {"a": [0.0, 0.0, 0.0]}, {})
    with pytest.raises(TypeError, match="found a mesh of type int"):
        morsmooth.smooth(3, "h", extrema=1)


def test_moved_points_have_the_type_of_the_mesh():
    plane = pv.Plane(i_resolution=8, j_resolution=8).triangulate()
    for dtype in (np.float32, np.float64):
        mesh = plane.copy()
        mesh.points = plane.points.astype(dtype)
        moved = morsmooth.deform(mesh, {"l": [-0.5, 0.0, 0.0], "r": [0.5, 0.0, 0.0]}, {"r": {"translation": [0.5, 0.2, 0]}})
        assert moved.points.dtype == dtype and moved["det_F"].min() > 0 and (mesh.points == plane.points).all()


def test_contradicting_handles_are_named():
    mesh = pv.Plane(i_resolution=6, j_resolution=6).triangulate()
    handles = {"left": [-0.5, 0.0, 0.0], "right": [0.5, 0.0, 0.0]}
    mirrored = {"left": {"translation": [3, 0, 0]}, "right": {"translation": [-3, 0, 0]}}
    with pytest.raises(morsmooth.ContradictionError, match="left.*right|right.*left"):
        morsmooth.deform(mesh, handles, mirrored, hard=True)


def test_faults_name_points_on_each_other():
    whole = pv.Plane(i_resolution=6, j_resolution=4)
    assert morsmooth.faults(whole) == []
    halves = pv.merge([whole.extract_cells(range(12)), whole.extract_cells(range(12, 24))], merge_points=False)
    found = morsmooth.faults(halves)
    assert [fault.is_cut for fault in found].count(True) == 1
    assert any(fault.text.startswith("7 points lie exactly on an earlier point") for fault in found)

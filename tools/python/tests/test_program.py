"""The wheel against the program: the same bits, and the same words."""

import numpy as np
import pytest

import morsmooth

pv = pytest.importorskip("pyvista", reason="PyVista is not installed")


@pytest.fixture
def sheet(triangles, tmp_path):
    """The sheet as a file, and as PyVista reads that."""
    points, cells, values = triangles
    mesh = pv.PolyData.from_regular_faces(points, cells)
    mesh["h"] = values
    mesh["narrow"] = values.astype(np.float32)
    mesh["inside"] = (points[:, 0] < 0.8).astype(np.uint8)
    mesh.save(tmp_path / "sheet.vtp")
    return tmp_path / "sheet.vtp", pv.read(tmp_path / "sheet.vtp")


@pytest.fixture
def image(tmp_path):
    grid = pv.ImageData(dimensions=(25, 18, 1), spacing=(0.5, 0.25, 1.0), origin=(3, 1, 2))
    random = np.random.default_rng(8)
    grid["h"] = (np.sin(grid.points[:, 0]) * grid.points[:, 1] + 0.2 * random.standard_normal(grid.n_points)).astype(np.float32)
    grid.save(tmp_path / "image.vti")
    return tmp_path / "image.vti", grid


CASES = [
    ({"persistence": 0.2}, ["--persistence", "20%"]),
    ({"persistence_abs": 0.4, "select": "smooth"}, ["--persistence-abs", "0.4", "--select", "smooth"]),
    ({"extrema": 5, "order": 3, "length": "3%"}, ["--extrema", "5", "--order", "3", "--length", "3%"]),
    ({"extrema": 5, "extremum_values": 0.05, "length_abs": 0.1}, ["--extrema", "5", "--values", "5%", "--length-abs", "0.1"]),
    ({"extrema": 6, "mask": "inside", "keep_also": "saddles"}, ["--extrema", "6", "--mask", "inside", "--keep-also", "saddles"]),
    ({"extrema": 5, "representative": "harmonic", "edges": "all"}, ["--extrema", "5", "--representative", "harmonic", "--edges", "all"]),
    ({"extrema": 5, "refine": 1, "raw": True}, ["--extrema", "5", "--refine", "1", "--raw"]),
    ({"extrema": 5, "confidence": "inside"}, ["--extrema", "5", "--confidence", "inside"]),
]


@pytest.mark.parametrize("array", ["h", "narrow"])
@pytest.mark.parametrize("options, words", CASES, ids=[" ".join(words) for _, words in CASES])
def test_smooth(sheet, program, tmp_path, equal, array, options, words):
    path, mesh = sheet
    program("smooth", path, tmp_path / "out.vtp", "--array", array, *words)
    expected = pv.read(tmp_path / "out.vtp")[f"{array}_smooth"]
    assert equal(morsmooth.smooth(mesh, array, **options)[f"{array}_smooth"], expected)


def test_smooth_a_grid(image, program, tmp_path, equal):
    path, grid = image
    program("smooth", path, tmp_path / "out.vti", "--persistence", "10%")
    expected = pv.read(tmp_path / "out.vti")["h_smooth"]
    assert equal(morsmooth.smooth(grid, persistence="10%")["h_smooth"], expected)
    values = grid["h"].reshape(25, 18, order="F")
    plain = morsmooth.smooth(array=values, spacing=(0.5, 0.25, 1.0), origin=(3, 1, 2), persistence="10%")
    assert equal(plain.reshape(-1, order="F"), expected)


def test_simplify_with_its_order(sheet, program, tmp_path, equal):
    path, mesh = sheet
    program("simplify", path, tmp_path / "out.vtp", "--array", "h", "--extrema", "4", "--order-array")
    expected, found = pv.read(tmp_path / "out.vtp"), morsmooth.simplify(mesh, "h", extrema=4, order_array=True)
    for name in ("h_simplified", "h_simplified_Order"):
        assert equal(found[name], expected[name])


@pytest.mark.parametrize("embed", [False, True])
def test_persistence_diagram(sheet, program, tmp_path, equal, embed):
    path, mesh = sheet
    program("persistence", path, tmp_path / "out.vtu", "--array", "narrow", *["--embed"][: int(embed)])
    expected, found = pv.read(tmp_path / "out.vtu"), morsmooth.persistence_diagram(mesh, "narrow", embed=embed)
    assert isinstance(found, pv.UnstructuredGrid) and found.array_names == expected.array_names
    assert equal(found.points, expected.points) and equal(found.cell_connectivity, expected.cell_connectivity)
    for name in expected.array_names:
        assert equal(found[name], expected[name]), name


def test_weights(sheet, program, tmp_path, equal, as_json):
    path, mesh = sheet
    content = {
        "handles": [{"name": "a", "point": [0, 0.5]}, {"name": "b", "bone": [[0.7, 0.3, 0], [0.9, 0.8, 0]]}, {"name": "c", "region": [30, 61]}]
    }
    handles = as_json("handles.json", content)
    program("weights", path, tmp_path / "out.vtu", "--handles", handles, "--prefix", "w_")
    expected = pv.read(tmp_path / "out.vtu")
    by_name = {"a": (0.0, 0.5), "b": [[0.7, 0.3, 0], [0.9, 0.8, 0]], "c": np.array([30, 61])}
    for given in (handles, content, by_name):
        found = morsmooth.weights(mesh, given, prefix="w_")
        assert all(equal(found[name], expected[name]) for name in ("w_a", "w_b", "w_c"))
    program("weights", path, tmp_path / "out.vtu", "--handles", handles, "--method", "bounded", "--precision", "32")
    found, expected = morsmooth.weights(mesh, handles, method="bounded", precision=32), pv.read(tmp_path / "out.vtu")
    assert equal(found["b"], expected["b"])


def test_handles_from_an_array(sheet, program, tmp_path, equal):
    path, mesh = sheet
    mesh["part"] = np.zeros(mesh.n_points, np.int32)
    mesh["part"][:3], mesh["part"][-3:] = 1, 2
    mesh.save(tmp_path / "parts.vtp")
    program("weights", tmp_path / "parts.vtp", tmp_path / "out.vtu", "--handles", "part")
    expected = pv.read(tmp_path / "out.vtu")
    found = morsmooth.weights(mesh, {"array": "part"})
    assert equal(found["part_1"], expected["part_1"]) and equal(found["part_2"], expected["part_2"])


def test_deform(sheet, program, tmp_path, equal, as_json):
    path, mesh = sheet
    handles = {"handles": [{"name": "a", "point": [0, 0.5, 0]}, {"name": "b", "point": [1, 0.5, 0]}]}
    pose = {"handles": {"b": {"rotation_degrees": 120, "translation": [0.2, 0.3, 0]}}}
    program("deform", path, tmp_path / "out.vtp", "--handles", as_json("h.json", handles), "--pose", as_json("p.json", pose))
    expected = pv.read(tmp_path / "out.vtp")
    found = morsmooth.deform(mesh, handles, pose["handles"])
    assert equal(found.points, expected.points)
    for name in ("det_F", "smallest_eigenvalue", "energy_density", "active_constraint"):
        assert equal(found[name], expected[name]), name


@pytest.mark.parametrize("method", ["exact", "heat"])
def test_geodesic(sheet, program, tmp_path, equal, method):
    path, mesh = sheet
    words = ["--method", method, "--mask", "inside"]
    program("geodesic", path, tmp_path / "out.vtp", "--source", "17,92", *words)
    expected = pv.read(tmp_path / "out.vtp")["geodesic_distance"]
    assert equal(morsmooth.geodesic(mesh, [17, 92], method=method, mask="inside")["geodesic_distance"], expected)
    program("geodesic", path, tmp_path / "out.vtp", "--source-point", "0.3,0.41,0", *words)
    expected = pv.read(tmp_path / "out.vtp")["geodesic_distance"]
    assert equal(morsmooth.geodesic(mesh, [0.3, 0.41, 0.0], method=method, mask="inside")["geodesic_distance"], expected)


def test_errors_have_the_words_of_the_program(sheet, program, tmp_path, as_json):
    path, mesh = sheet
    infinite = mesh.copy()
    infinite["h"][7] = np.inf
    infinite.save(tmp_path / "infinite.vtp")
    flat = mesh.copy()
    flat["h"][:] = 2.5
    flat.save(tmp_path / "flat.vtp")
    handles = as_json("handles.json", {"handles": [{"name": "a", "point": [9, 9, 9]}, {"name": "b", "point": [1, 0, 0]}]})
    wrong = as_json("wrong.json", {"handles": [{"name": "a", "point": [9, 9]}, {"name": "b", "pint": [1, 0, 0]}]})
    out, few = tmp_path / "out.vtp", ["--extrema", "2"]
    cases = [
        (["smooth", tmp_path / "infinite.vtp", out, "--array", "h", *few], lambda: morsmooth.smooth(infinite, "h", extrema=2)),
        (["smooth", tmp_path / "flat.vtp", out, "--array", "h", *few], lambda: morsmooth.smooth(flat, "h", extrema=2)),
        (["smooth", path, out, "--array", "h", "--gap", "-1", *few], lambda: morsmooth.smooth(mesh, "h", extrema=2, gap=-1.0)),
        (["simplify", path, out, "--array", "h", *few, "--mask", "no"], lambda: morsmooth.simplify(mesh, "h", extrema=2, mask="no")),
        (["weights", path, out, "--handles", handles], lambda: morsmooth.weights(mesh, handles)),
        (["weights", path, out, "--handles", wrong], lambda: morsmooth.weights(mesh, wrong)),
    ]
    for words, call in cases:
        said = program(*words, expect=2).stderr
        with pytest.raises(morsmooth.InputError) as raised:
            call()
        assert raised.value.message.split(": ", 1)[-1] in said, (raised.value.message, said)
        assert not out.exists()

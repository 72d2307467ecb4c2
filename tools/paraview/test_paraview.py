"""The filters and the series script inside ParaView itself; skips where pvpython, pvbatch or mpiexec are not installed.

    pytest tools/paraview

Needs the packages morsmooth, vtk and pyvista, and the program in target/release or named by MORSMOOTH_PROGRAM.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np
import pytest

pv = pytest.importorskip("pyvista", reason="PyVista is not installed")
morsmooth = pytest.importorskip("morsmooth", reason="the Python package morsmooth is not installed")

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ.get("MORSMOOTH_PROGRAM", HERE.parents[1] / "target/release/morsmooth")
STEPS = 8


def tool(name):
    found = shutil.which(name)
    if not found:
        pytest.skip(f"{name} is not installed: apt-get install paraview python3-paraview openmpi-bin")
    return found


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """ParaView sees the package morsmooth and the shim, and nothing else of this Python."""
    packages = tmp_path_factory.mktemp("packages")
    (packages / "morsmooth").symlink_to(pathlib.Path(morsmooth.__file__).parent)
    path = os.pathsep.join([str(packages), str(HERE / "debian")])
    words = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV", "OMPI_"))}
    # Root is who tests run as in containers; Open MPI wants to be told so twice.
    root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    # Two ranks also where there is one core.
    slots = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}
    return {**words, "PYTHONPATH": path, **root, **slots}


def run(words, environment, expect=0):
    ended = subprocess.run([str(word) for word in words], capture_output=True, text=True, env=environment, timeout=600)
    assert expect is None or ended.returncode == expect, f"exit code {ended.returncode}\n{ended.stdout}\n{ended.stderr}"
    return ended


def step(number):
    image = pv.ImageData(dimensions=(60, 45, 1), spacing=(0.1, 0.1, 1.0))
    x, y, _ = image.points.T
    noise = np.random.default_rng(number).standard_normal(image.n_points)
    image["h"] = (np.sin(2 * x + 0.3 * number) * np.cos(1.5 * y) + 0.2 * noise).astype(np.float32)
    return image


@pytest.fixture(scope="module")
def series(tmp_path_factory):
    """Eight steps and the .pvd that names them."""
    folder = tmp_path_factory.mktemp("series")
    entries = []
    for number in range(STEPS):
        step(number).save(folder / f"step_{number}.vti")
        entries.append(f'<DataSet timestep="{number / 4}" part="0" file="step_{number}.vti"/>')
    text = f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>{"".join(entries)}</Collection></VTKFile>'
    (folder / "series.pvd").write_text(text)
    return folder / "series.pvd"


FILTERS = """
import json, sys
from paraview.simple import *
LoadPlugin(sys.argv[1], ns=globals())
reader = OpenDataFile(sys.argv[2])
out = sys.argv[3]
smooth = MorsmoothSmooth(Input=reader, Scalars=["POINTS", "h"], Persistence=0.2, Order=3)
assert smooth.KeepExtremaBy == "Persistence as part of the range" and smooth.Length == 0
SaveData(out + "/smooth.vti", proxy=smooth)
simple = MorsmoothSimplify(Input=reader, Scalars=["POINTS", "h"], KeepExtremaBy="Number of extrema", Extrema=6, OutputArray="simple", OrderArray=1)
SaveData(out + "/simple.vti", proxy=simple)
diagram = MorsmoothPersistenceDiagram(Input=reader, Scalars=["POINTS", "h"])
SaveData(out + "/diagram.vtu", proxy=diagram)
bad = MorsmoothSmooth(Input=reader, Scalars=["POINTS", "h"], Persistence=7.0)
bad.UpdatePipeline()
print(json.dumps({"help": smooth.__doc__ or "", "bad": list(bad.PointData.keys())}))
"""


@pytest.mark.parametrize("which", ["pvpython", "pvbatch"])
def test_the_filters_give_what_the_program_gives(which, environment, series, tmp_path):
    words = [tool(which), "--force-offscreen-rendering"] if which == "pvbatch" else [tool(which)]
    (tmp_path / "filters.py").write_text(FILTERS)
    source = series.with_name("step_0.vti")
    said = run([*words, tmp_path / "filters.py", HERE / "morsmooth_plugin.py", source, tmp_path], environment)
    assert "persistence is 7; expected a part of the range from 0 to 1" in said.stderr, "errors have the words of the program"
    told = json.loads(said.stdout.strip().splitlines()[-1])
    assert told["bad"] in ([], ["h"]) and "exactly the wanted minima and maxima" in told["help"]
    ours = {"smooth": ["--persistence", "20%", "--order", "3"], "simplify": ["--extrema", "6", "--name", "simple", "--order-array"]}
    for command, (name, arrays) in {"smooth": ("smooth", ["h_smooth"]), "simplify": ("simple", ["simple", "simple_Order"])}.items():
        run([PROGRAM, command, source, tmp_path / "program.vti", *ours[command]], None)
        expected, found = pv.read(tmp_path / "program.vti"), pv.read(tmp_path / f"{name}.vti")
        assert found["h"].tobytes() == expected["h"].tobytes()
        for array in arrays:
            assert found[array].dtype == expected[array].dtype and found[array].tobytes() == expected[array].tobytes(), array
    run([PROGRAM, "persistence", source, tmp_path / "program.vtu"], None)
    expected, found = pv.read(tmp_path / "program.vtu"), pv.read(tmp_path / "diagram.vtu")
    assert found.points.tobytes() == expected.points.tobytes() and set(expected.array_names) == set(found.array_names)
    assert all(found[name].tobytes() == expected[name].tobytes() for name in expected.array_names)


SPREAD = """
import sys
from paraview.simple import *
LoadPlugin(sys.argv[1], ns=globals())
whole = MorsmoothSmooth(Input=OpenDataFile(sys.argv[2]), Scalars=["POINTS", "h"], Persistence=0.2)
SaveData(sys.argv[3] + "/whole.pvti", proxy=whole)
spread = MorsmoothSmooth(Input=RedistributeDataSet(Input=OpenDataFile(sys.argv[2])), Scalars=["POINTS", "h"], Persistence=0.2)
spread.UpdatePipeline()
"""


def test_a_spread_data_set_is_gathered_or_refused(environment, series, tmp_path):
    words = [tool("mpiexec"), "-n", "2", tool("pvbatch")]
    (tmp_path / "spread.py").write_text(SPREAD)
    said = run([*words, tmp_path / "spread.py", HERE / "morsmooth_plugin.py", series.with_name("step_1.vti"), tmp_path], environment, None)
    assert "the data set is spread over 2 processes; expected it on one" in said.stderr and "series_mpi.py" in said.stderr
    run([PROGRAM, "smooth", series.with_name("step_1.vti"), tmp_path / "program.vti", "--persistence", "20%"], None)
    expected, found = pv.read(tmp_path / "program.vti"), pv.read(tmp_path / "whole.pvti")
    assert found["h_smooth"].tobytes() == expected["h_smooth"].tobytes(), "a reader gives one rank all of it"


def results(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_two_ranks_write_the_bytes_of_one(environment, series, tmp_path):
    script = [HERE / "series_mpi.py", series]
    options = ["--array", "h", "--persistence", "20%"]
    run([tool("pvbatch"), *script, tmp_path / "one", *options], environment)
    said = run([tool("mpiexec"), "-n", "2", tool("pvbatch"), "--sym", *script, tmp_path / "two", *options], environment)
    ranks = {line.split("rank ")[1][0] for line in said.stdout.splitlines() if line.startswith("step")}
    assert ranks == {"0", "1"} and f"{STEPS} of {STEPS} steps" in said.stdout
    one, two = results(tmp_path / "one"), results(tmp_path / "two")
    assert len(one) == STEPS + 1 and one == two
    for number in (0, STEPS - 1):
        found = pv.read(tmp_path / "two" / f"step_{number}.vti")
        assert found["h_smooth"].tobytes() == morsmooth.smooth(step(number), "h", persistence="20%")["h_smooth"].tobytes()
    times = pv.get_reader(tmp_path / "two" / "series.pvd").time_values
    assert times == [number / 4 for number in range(STEPS)]


def test_a_failing_step_is_named_and_finished_ones_are_not_repeated(environment, series, tmp_path):
    folder = tmp_path / "steps"
    shutil.copytree(series.parent, folder)
    (folder / "step_3.vti").write_bytes((folder / "step_3.vti").read_bytes()[:900])
    words = [tool("mpiexec"), "-n", "2", tool("pvbatch"), "--sym", HERE / "series_mpi.py", folder / "series.pvd", tmp_path / "out"]
    options = ["--array", "h", "--extrema", "5", "--simplify"]
    said = run([*words, *options], environment, None)
    assert said.returncode != 0 and "error: step 3 (step_3.vti)" in said.stderr and "7 of 8 steps" in said.stdout
    written = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*.vti")}
    assert len(written) == 7 and (tmp_path / "out" / "step_3.vti.error.txt").exists()
    shutil.copy(series.with_name("step_3.vti"), folder)
    said = run([*words, *options], environment)
    assert said.stdout.count("there already") == 7 and "8 of 8 steps" in said.stdout
    after = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*.vti")}
    assert written.items() < after.items() and not (tmp_path / "out" / "step_3.vti.error.txt").exists()


def test_what_cannot_begin_is_refused(environment, series, tmp_path):
    script = [tool("pvbatch"), HERE / "series_mpi.py"]
    options = ["--array", "h", "--extrema", "5"]
    for words, text in [
        ([tmp_path / "no.pvd", tmp_path / "out"], "no.pvd"),
        ([f"{tmp_path}/no_*.vti", tmp_path / "out"], "found no file"),
        ([series, series.parent], "the results would take the places of the steps"),
    ]:
        said = run([*script, *words, *options], environment, None)
        assert said.returncode != 0 and text in said.stderr, said.stderr
    alone = [tool("mpiexec"), "-n", "2", tool("pvbatch"), *script[1:], series, tmp_path / "out", *options]
    said = run(alone, environment, None)
    assert "only rank 0 runs the script; expected all of them: pvbatch --sym" in said.stderr and not (tmp_path / "out").exists()


def test_pieces_that_are_not_joined_are_refused(environment, tmp_path):
    sphere = pv.Sphere(theta_resolution=20, phi_resolution=20).cast_to_unstructured_grid()
    sphere["h"] = sphere.points[:, 0] + 0.3 * np.random.default_rng(1).standard_normal(sphere.n_points)
    low = sphere.cell_centers().points[:, 2] < 0
    for number, part in enumerate((low, ~low)):
        sphere.extract_cells(np.flatnonzero(part)).save(tmp_path / f"piece_{number}.vtu")
    (tmp_path / "halves.pvtu").write_text(
        '<?xml version="1.0"?><VTKFile type="PUnstructuredGrid" version="0.1"><PUnstructuredGrid GhostLevel="0">'
        '<PPointData><PDataArray type="Float64" Name="h"/></PPointData><PPoints><PDataArray type="Float32" NumberOfComponents="3"/></PPoints>'
        '<Piece Source="piece_0.vtu"/><Piece Source="piece_1.vtu"/></PUnstructuredGrid></VTKFile>'
    )
    words = [tool("pvbatch"), HERE / "series_mpi.py", tmp_path / "halves.pvtu", tmp_path / "out", "--array", "h", "--extrema", "4"]
    said = run(words, environment, None)
    assert said.returncode != 0 and "its pieces are not joined" in said.stderr and "morsmooth convert halves.pvtu halves.vtu" in said.stderr
    run([PROGRAM, "convert", tmp_path / "halves.pvtu", tmp_path / "halves.vtu"], None)
    words[2] = tmp_path / "halves.vtu"
    assert "1 of 1 steps" in run(words, environment).stdout


def test_the_shim_is_one_line():
    lines = (HERE / "debian/sitecustomize.py").read_text().splitlines()
    assert len([line for line in lines if not line.startswith("#")]) == 1
    ended = subprocess.run([sys.executable, "-c", "import inspect; inspect.getargspec"], env={"PYTHONPATH": str(HERE / "debian")})
    assert ended.returncode == 0

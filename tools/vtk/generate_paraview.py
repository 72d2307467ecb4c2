"""Writes small files of every kind with ParaView's SaveData: serial, as time steps, and on two ranks with ghost cells.

    python tools/vtk/generate_paraview.py FOLDER

`roundtrip.py FOLDER` then compares. Runs itself in pvpython, and in `mpiexec -n 2 pvbatch`; says so where they are not installed
(apt-get install paraview python3-paraview openmpi-bin) and writes nothing then.
"""

import os
import shutil
import subprocess
import sys

OUT = os.path.abspath(sys.argv[1])
PACKERS = ("None", "ZLib", "LZ4", "LZMA")
FORMS = {"ascii": {"DataMode": "Ascii"}, "inline": {"DataMode": "Binary", "CompressorType": "ZLib"}}
FORMS.update({f"raw_{packer}".lower(): {"DataMode": "Appended", "EncodeAppendedData": 0, "CompressorType": packer} for packer in PACKERS})
FORMS["base64"] = {"DataMode": "Appended", "EncodeAppendedData": 1, "CompressorType": "ZLib"}
EXTENSIONS = {"image": "vti", "rectilinear": "vtr", "structured": "vts", "poly": "vtp", "unstructured": "vtu"}
# A triangle that grows with time.
INFORMATION = """
info = self.GetExecutive().GetOutputInformation(0)
info.Set(self.GetExecutive().TIME_STEPS(), [0.0, 0.5, 2.0], 3)
info.Set(self.GetExecutive().TIME_RANGE(), [0.0, 2.0], 2)
"""
SCRIPT = """
time = self.GetExecutive().GetOutputInformation(0).Get(self.GetExecutive().UPDATE_TIME_STEP())
points = vtk.vtkPoints()
for place in ((0, 0, 0), (1, 0, 0), (0, 1, time)):
    points.InsertNextPoint(place)
polys = vtk.vtkCellArray()
polys.InsertNextCell(3, [0, 1, 2])
self.GetPolyDataOutput().SetPoints(points)
self.GetPolyDataOutput().SetPolys(polys)
"""


def store(proxy, name, **options):
    from paraview.simple import SaveData

    SaveData(os.path.join(OUT, name), proxy=proxy, **options)
    assert any(entry.startswith(name.rsplit(".", 1)[0]) for entry in os.listdir(OUT)), name


def producer(dataset):
    """A data set of this process as a source of ParaView's."""
    from paraview.simple import TrivialProducer

    result = TrivialProducer()
    result.GetClientSideObject().SetOutput(dataset)
    result.UpdatePipeline()
    return result


def serial():
    import samples
    from paraview import simple

    made = {"turned": ("vti", samples.turned), "polyhedron": ("vtu", lambda: samples.unstructured(True))}
    made.update({kind: (extension, samples.KINDS[kind]) for kind, extension in EXTENSIONS.items()})
    for kind, (extension, make) in made.items():
        source = producer(make())
        for form, options in FORMS.items():
            store(source, f"{kind}_{form}.{extension}", **options)
        store(source, f"{kind}_default.{extension}")
        for file_type in ("Ascii", "Binary"):
            store(source, f"{kind}_{file_type.lower()}.vtk", FileType=file_type)
        store(source, f"{kind}.pvd", DataMode="Ascii")
        store(source, f"{kind}_pieces.p{extension}")
    grouped = simple.GroupDatasets(Input=[producer(make()) for _, make in made.values()])
    store(grouped, "blocks.vtm", DataMode="Appended")
    sphere = simple.Sphere(ThetaResolution=6, PhiResolution=5)
    for extension in ("ply", "stl"):
        for file_type in ("Ascii", "Binary"):
            store(sphere, f"sphere_{file_type.lower()}.{extension}", FileType=file_type)
    store(sphere, "sphere.obj")
    store(sphere, "points.csv", Precision=17)
    store(sphere, "cells.tsv", FieldAssociation="Cell Data", Precision=17)
    # Filters of ParaView's own: their arrays and their cells of many kinds.
    for number, kind in enumerate(("Tet", "Wedge", "Hex", "Pyramid", "Quadratic Hex", "Lagrange Tetrahedron", "Bezier Triangle")):
        cells = simple.UnstructuredCellTypes(CellType=kind, BlocksDimensions=[2, 1, 1])
        store(cells, f"cells_{number}.vtu", CompressorType="LZ4")
    wavelet = simple.Wavelet(WholeExtent=[-2, 2, -1, 1, 0, 2])
    store(simple.Contour(Input=wavelet, ContourBy=["POINTS", "RTData"], Isosurfaces=[200.0]), "contour.vtp")
    store(simple.Threshold(Input=wavelet, Scalars=["POINTS", "RTData"], UpperThreshold=250.0, LowerThreshold=100.0), "threshold.vtu")
    store(simple.Tetrahedralize(Input=wavelet), "tetrahedra.vtu")
    steps = simple.ProgrammableSource(OutputDataSetType="vtkPolyData", ScriptRequestInformation=INFORMATION, Script=SCRIPT)
    store(steps, "series.pvd", WriteTimeSteps=1)
    store(steps, "steps.vtp", Writetimestepsasfileseries=1)


def parallel():
    """Each rank has its part, with a layer of ghost cells around it."""
    from paraview import simple

    wavelet = simple.Wavelet(WholeExtent=[-3, 3, -2, 2, 0, 2])
    pieces = {
        "wavelet.pvti": wavelet,
        "tetrahedra.pvtu": simple.Tetrahedralize(Input=wavelet),
        "contour.pvtp": simple.Contour(Input=wavelet, ContourBy=["POINTS", "RTData"], Isosurfaces=[180.0]),
        "curved.pvts": simple.WarpByScalar(Input=wavelet, Scalars=["POINTS", "RTData"], ScaleFactor=0.01),
    }
    for name, source in pieces.items():
        stem, extension = name.split(".")
        # Its name until version 5.11, and its name since.
        ghosts = (getattr(simple, "GhostCellsGenerator", None) or simple.GhostCells)(Input=source, BuildIfRequired=0)
        for form in ("raw_none", "raw_zlib", "ascii"):
            simple.SaveData(os.path.join(OUT, f"two_{stem}_{form}.{extension}"), proxy=source, **FORMS[form])
            # Of a curved grid, ParaView 5.11 writes pieces that leave out a corner of the whole.
            if extension != "pvts":
                simple.SaveData(os.path.join(OUT, f"ghost_{stem}_{form}.{extension}"), proxy=ghosts, **FORMS[form])
        simple.SaveData(os.path.join(OUT, f"two_{stem}.pvd"), proxy=source)


def main():
    if "paraview" in sys.modules or os.environ.get("MORSMOOTH_INSIDE"):
        return {"serial": serial, "parallel": parallel}[os.environ["MORSMOOTH_INSIDE"]]()
    missing = [name for name in ("pvpython", "pvbatch", "mpiexec") if not shutil.which(name)]
    if missing:
        return print(f"skipped: {', '.join(missing)} not installed (apt-get install paraview python3-paraview openmpi-bin)")
    os.makedirs(OUT, exist_ok=True)
    here = os.path.dirname(os.path.abspath(__file__))
    words = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV", "OMPI_"))}
    # Root is who tests run as in containers; two ranks also where there is one core.
    words.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1", PYTHONPATH=here)
    own = [os.path.abspath(__file__), OUT]
    subprocess.run(["pvpython", *own], env={**words, "MORSMOOTH_INSIDE": "serial"}, check=True)
    subprocess.run(["mpiexec", "-n", "2", "pvbatch", *own], env={**words, "MORSMOOTH_INSIDE": "parallel"}, check=True)
    print(len(os.listdir(OUT)), "files")


if __name__ in ("__main__", "__vtkconsole__"):
    main()

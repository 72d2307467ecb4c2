#!/usr/bin/env python3
"""Reading and writing of large VTK files, beside VTK's own readers and writers in the same run.

Usage:  cargo build --release --example vtk_probe
        python tools/bars/io.py [--probe target/release/examples/vtk_probe] [--megabytes 200] [--rounds 3] [--report FILE.json]
Needs:  pip install numpy==2.4.6 vtk==9.7.2

  image   .vti, appended raw, 64-bit headers, not packed: one Float64 array
  grid    .vtu, appended raw, zlib: tetrahedra with two point arrays and one cell array, the same number of bytes unpacked
Bar: ours takes no longer than VTK, reading and writing, by the wall clock, best of the rounds, in which both take turns; processor
time is told beside it. The second bar: the peak memory of a whole process that reads the image is at most 1.3 times the file and 30 MB.
Exit code 1 if a bar is missed.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import vtk
from vtk.util import numpy_support

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def named(name, values):
    array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def image(megabytes):
    side = round((megabytes * 1e6 / 8) ** (1 / 3))
    data = vtk.vtkImageData()
    data.SetDimensions(side, side, side)
    data.GetPointData().AddArray(named("h", np.random.default_rng(1).normal(size=side**3)))
    return data


def grid(megabytes):
    # Per point 24 + 8 + 24 bytes, per tetrahedron 32 + 8 + 1 + 4, six tetrahedra a point.
    side = round((megabytes * 1e6 / (56 + 6 * 45)) ** (1 / 3))
    axis = np.arange(side)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), z.ravel()], 1).astype(float)
    low = ((z * side + y) * side + x)[:-1, :-1, :-1].ravel()
    step = np.array([1, side, side * side])
    cells = []
    for order in ([0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]):
        corners = [low]
        for axis_number in order:
            corners.append(corners[-1] + step[axis_number])
        cells.append(np.stack(corners, 1))
    cells = np.concatenate(cells).astype(np.int64)
    data = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk(places, deep=True))
    data.SetPoints(points)
    listed = vtk.vtkCellArray()
    offsets = numpy_support.numpy_to_vtkIdTypeArray(np.arange(0, 4 * len(cells) + 1, 4), deep=True)
    listed.SetData(offsets, numpy_support.numpy_to_vtkIdTypeArray(cells.ravel(), deep=True))
    data.SetCells(vtk.VTK_TETRA, listed)
    smooth = np.sin(places[:, 0] / 9) * np.cos(places[:, 1] / 7) + 0.1 * places[:, 2]
    data.GetPointData().AddArray(named("h", smooth))
    data.GetPointData().AddArray(named("v", np.round(np.stack([smooth, -smooth, smooth], 1), 3)))
    data.GetCellData().AddArray(named("part", (np.arange(len(cells)) // 1000).astype(np.int32)))
    return data


def clocked(work):
    """Wall and processor seconds."""
    begin, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_SELF)
    work()
    after = resource.getrusage(resource.RUSAGE_SELF)
    return time.perf_counter() - begin, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def vtk_writer(kind, data, path):
    writer = vtk.vtkXMLImageDataWriter() if kind == "image" else vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(data)
    writer.SetFileName(path)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetHeaderTypeToUInt64()
    writer.SetCompressorTypeToNone() if kind == "image" else writer.SetCompressorTypeToZLib()
    return writer


def vtk_reader(kind, path):
    reader = vtk.vtkXMLImageDataReader() if kind == "image" else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    return reader


def child(command):
    """What a child prints. It counts its own memory: the system would count this process's as well."""
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--probe", default=os.path.join(ROOT, "target/release/examples/vtk_probe"))
    parser.add_argument("--megabytes", type=float, default=200)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--report")
    options = parser.parse_args()
    told, missed = {}, False
    with tempfile.TemporaryDirectory() as folder:
        for kind, make, extension, mode in (("image", image, "vti", "--write"), ("grid", grid, "vtu", "--pack")):
            data = make(options.megabytes)
            path, copy = os.path.join(folder, f"a.{extension}"), os.path.join(folder, f"b.{extension}")
            rows = {key: [] for key in ("vtk write", "ours write", "vtk read", "ours read")}
            for _ in range(options.rounds):
                rows["vtk write"].append(clocked(vtk_writer(kind, data, path).Write))
                rows["vtk read"].append(clocked(vtk_reader(kind, path).Update))
                both = child([options.probe, mode, path, copy])
                alone = child([options.probe, "--read", path])
                rows["ours read"] += [both["read"], alone["read"]]
                rows["ours write"].append(both["write"])
            sizes = [os.path.getsize(file) for file in (path, copy)]
            print(f"{kind}: {sizes[0] / 1e6:.0f} MB as VTK writes it, {sizes[1] / 1e6:.0f} MB as we do")
            peak = alone["peak"]
            told[kind] = {"bytes": sizes, "peak": peak}
            for what in ("read", "write"):
                best = {who: min(rows[f"{who} {what}"]) for who in ("vtk", "ours")}
                cpu = {who: min(row[1] for row in rows[f"{who} {what}"]) for who in ("vtk", "ours")}
                ratio = best["ours"][0] / best["vtk"][0]
                verdict = "ok" if ratio <= 1.0 else "MISSED"
                missed |= ratio > 1.0
                print(f"  {what:<6} ours {best['ours'][0]:.3f} s (processor {cpu['ours']:.2f}), VTK {best['vtk'][0]:.3f} s "
                      f"(processor {cpu['vtk']:.2f}), ratio {ratio:.2f}  {verdict}")
                told[kind][what] = {"ours": best["ours"], "vtk": best["vtk"], "processor": cpu, "ratio": ratio}
            if kind == "image":
                bound = 1.3 * sizes[0] + 30e6
                missed |= peak > bound
                print(f"  memory of a process that reads it: {peak / 1e6:.0f} MB, bar {bound / 1e6:.0f} MB  {'ok' if peak <= bound else 'MISSED'}")
    if options.report:
        with open(options.report, "w") as file:
            json.dump(told, file, indent=1)
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())

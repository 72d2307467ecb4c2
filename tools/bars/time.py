#!/usr/bin/env python3
"""Wall time and peak memory of whole runs of the program, reading and writing included, beside public peers.

Usage:  cargo build --release; cargo build --release --example export_qp
        python tools/bars/time.py [--program target/release/morsmooth] [--export target/release/examples/export_qp]
                                  [--data ../shared/data] [--runs 5] [--threads N] [--no-peers] [--report FILE.json]
Needs:  pip install numpy==2.4.6 scipy==1.17.1 vtk==9.7.2 pyvista==0.49.1 gudhi==3.13.0 clarabel==0.11.1

  jet        --select data --persistence 20%, 15,399 vertices                       bar 1.5 s, 400 MB
  noisy      --select data --persistence 25%, 121 x 121 points, 28,800 triangles:
             a planted field (tools/quality/planted.py) with noise of +-10 %        bar 2 s, 400 MB
  elevation  --select data --persistence 5%, 138,632 vertices                       bar 25 s, memory reported
All with the automatic smoothing length. The bars are meant for two quiet cores. Medians of the runs; wall time from start to exit,
peak memory and processor time as the system counts them for the child, as /usr/bin/time -v does.

Peers, in the same run on the same fields: GUDHI's extremum pairs of h and -h, from a simplex tree that is there already,
beside our stage `extrema`, and clarabel on the same quadratic problem with P formed, relative gap 1e-8, beside our stage `solve`.
Ours is the median of the runs, theirs is one run. Exit code 1 if a bar is missed.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import pyvista as pv

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path[:0] = [os.path.join(ROOT, "tools", name) for name in ("quality", "check", "bars", "reference")]
import planted  # noqa: E402

# name: (file, array, mask, threshold, seconds, megabytes)
CASES = {
    "jet": ("flow/jet_pivmat.vti", "vorticity_magnitude", "valid", 0.20, 1.5, 400),
    "noisy": (None, "noisy", None, 0.25, 2.0, 400),
    "elevation": ("images/jacksboro_dem.vti", "elevation", "valid", 0.05, 25.0, None),
}


def noisy_field(path):
    side, step = 121, 0.01
    grid = pv.ImageData(dimensions=(side, side, 1), spacing=(step, step, 1.0))
    size = (side - 1) * step
    # The planted field stretched to the square.
    x, y = grid.points[:, 0] / size * planted.WIDTH, grid.points[:, 1] / size * planted.HEIGHT
    value = planted.sample(planted.truth(0)[2], x, y)
    value = (value - value.min()) / np.ptp(value)
    grid.point_data["noisy"] = value + 0.1 * np.random.default_rng(29).uniform(-1.0, 1.0, len(value))
    grid.save(path)


def run(call):
    """Wall seconds, processor seconds, peak megabytes of one child."""
    begin = time.perf_counter()
    child = subprocess.Popen(call)
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - begin
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise SystemExit(f"exit code {child.returncode}: {' '.join(call)}")
    unit = 1 if sys.platform == "darwin" else 1024
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * unit / 1e6


def gudhi_seconds(path, array, mask):
    from gudhi_pairs import load, pairs
    values, simplices = load(path, array, mask)
    begin = time.perf_counter()
    pairs(values, simplices)
    pairs(-values, simplices)
    return time.perf_counter() - begin


def clarabel_seconds(given, path, array, mask, threshold, length):
    import clarabel
    import scipy.sparse as sp
    from optimum import Problem
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([given.export, path, folder, f"array={array}", *([f"mask={mask}"] if mask else []), "order=2", "select=data",
                        f"persistence={threshold}", f"length={length!r}", "solve=no"], check=True, capture_output=True)
        problem = Problem(folder)
    fixed = np.flatnonzero(~problem.free)
    choose = sp.csc_array((np.ones(len(fixed)), (np.arange(len(fixed)), fixed)), (len(fixed), len(problem.fixed)))
    settings = clarabel.DefaultSettings()
    # Its absolute gap would stop it early: the objective is small.
    settings.verbose, settings.tol_gap_abs, settings.tol_gap_rel, settings.tol_feas = False, 1e-14, 1e-8, 1e-8
    arguments = (sp.csc_matrix(sp.triu(problem.P)), problem.q, sp.csc_matrix(sp.vstack([choose, -problem.A])),
                 np.r_[problem.fixed[fixed], problem.b],
                 [clarabel.ZeroConeT(len(fixed)), clarabel.NonnegativeConeT(len(problem.b))], settings)
    begin = time.perf_counter()
    answer = clarabel.DefaultSolver(*arguments).solve()
    return time.perf_counter() - begin, answer.iterations, str(answer.status)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target/release/morsmooth"))
    parser.add_argument("--export", default=os.path.join(ROOT, "target/release/examples/export_qp"))
    parser.add_argument("--data", default=os.path.join(ROOT, "../shared/data"))
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--threads", type=int, help="of the program; all cores by default")
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--no-peers", action="store_true")
    parser.add_argument("--report", help="write every figure to this JSON file")
    given = parser.parse_args()
    rows, missed = [], []
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, medians of {given.runs} runs\n")
    print("| field | vertices | wall, s (least to most) | bar | processor, s | peak memory, MB | bar | extrema, s | GUDHI, s | solve, s "
          "(iterations) | clarabel, s (iterations) |\n|---|---|---|---|---|---|---|---|---|---|---|")
    for name in given.only:
        file, array, mask, threshold, seconds, megabytes = CASES[name]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(given.data, file) if file else os.path.join(folder, "noisy.vti")
            if not file:
                noisy_field(path)
            report = os.path.join(folder, "report.json")
            call = [given.program, "smooth", path, os.path.join(folder, "out.vti"), "--array", array,
                    *(["--mask", mask] if mask else []), "--select", "data", "--persistence", f"{100 * threshold:g}%", "--quiet",
                    "--report", report, *(["--threads", str(given.threads)] if given.threads else [])]
            measured, stages = [], []
            for _ in range(given.runs):
                measured.append(run(call))
                with open(report) as text:
                    said = json.load(text)["smooth"]
                stages.append(dict(said["timing"]["stages"]))
            length = said["length"]["of_diagonal"]
            peers = (None, (None, None, None)) if given.no_peers else (
                gudhi_seconds(path, array, mask), clarabel_seconds(given, path, array, mask, threshold, length))
        wall, processor, memory = (statistics.median(column) for column in zip(*measured))
        ours = {stage: statistics.median(times[stage] for times in stages) for stage in stages[0]}
        rows.append({"field": name, "wall": [m[0] for m in measured], "processor": [m[1] for m in measured],
                     "megabytes": [m[2] for m in measured], "stages": ours, "iterations": said["solver"]["iterations"],
                     "gudhi": peers[0], "clarabel": peers[1], "load": os.getloadavg()[0]})
        least, most = min(m[0] for m in measured), max(m[0] for m in measured)
        gudhi = "-" if peers[0] is None else f"{peers[0]:.2f}"
        clarabel = "-" if peers[1][0] is None else f"{peers[1][0]:.2f} ({peers[1][1]}, {peers[1][2]})"
        print(f"| {name} | {said['vertices']} | {wall:.2f} ({least:.2f} to {most:.2f}) | {seconds} | {processor:.2f} | {memory:.0f} | "
              f"{megabytes or '-'} | {ours['extrema']:.3f} | {gudhi} | {ours['solve']:.2f} ({said['solver']['iterations']}) | "
              f"{clarabel} |", flush=True)
        if wall > seconds:
            missed.append(f"{name}: {wall:.2f} s > {seconds} s")
        if megabytes and memory > megabytes:
            missed.append(f"{name}: {memory:.0f} MB > {megabytes} MB")
    if given.report:
        with open(given.report, "w") as text:
            json.dump({"cores": os.cpu_count(), "rows": rows, "missed": missed}, text, indent=1)
    print(f"\n{len(missed)} bars missed" + "".join(f"\n  {text}" for text in missed))
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()

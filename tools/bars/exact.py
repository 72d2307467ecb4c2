#!/usr/bin/env python3
"""Exactly the wanted extrema, on seven measured fields: every threshold, strategy and order, read back with VTK.

Usage:  python tools/bars/exact.py [--program target/release/morsmooth] [--data ../shared/data] [--results FILE.jsonl]
                                   [--fields NAME ...] [--orders 1 2 3 4] [--thresholds 2 20 40] [-j 1] [--table]
Needs:  pip install numpy==2.4.6 vtk==9.7.2 pyvista==0.49.1

Fields: vorticity magnitude of an air jet, a soap film and an urban canopy, curvature, depth and thickness of a cortex,
and the elevation at the Jacksboro fault. Thresholds 2, 20 and 40 % of the range, orders 1 to 4, and
  --select data    all four representative functions
  --select smooth  smooth-then-simplify at each threshold and order; the others at 20 % and order 2
Every run must
  exit with 0,
  want what an own union-find over the field finds above the threshold (--select data; plus those that the program reports as
      unavoidable, each named by it),
  have in the file written, read with VTK and counted by tools/check/count_extrema.py, extrema at exactly the points that the
      report names, under (value, number) order and under plain <,
  keep the values there: bit for bit those of the input (--select data) or those of the report (--select smooth),
  and keep the type of the array.
Anything else is an exception. The smoothing length is 1 % of the diagonal, so that the runs do not spend their time on choosing
one; elevation (138,632 vertices) at orders 3 and 4 runs with 0.5 % and a duality gap of 1e-4, since the guarantee depends on
neither. That a run used another representative function because the asked one contradicted the wanted values, or that the
solver ended before its gap was reached, is counted and shown, but is no exception.

Results go to a file of JSON lines, one a run; a run found there with the same program (its hash) is not repeated. --table
prints what is there and runs nothing. Exit code 1 if there was an exception or a run is missing.
"""
import argparse
import collections
import concurrent.futures
import functools
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
import pyvista as pv

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tools", "check"))
from count_extrema import edges, extrema  # noqa: E402
from persistence import wanted as exceeding  # noqa: E402

FIELDS = {
    "jet": ("flow/jet_pivmat.vti", "vorticity_magnitude", "valid"),
    "soap": ("flow/soap_film.vti", "vorticity_magnitude", "valid"),
    "urban": ("flow/urban_canopy.vti", "vorticity_magnitude", "valid"),
    "curv": ("surfaces/fsaverage5_pial_left.vtp", "curv", None),
    "sulc": ("surfaces/fsaverage5_pial_left.vtp", "sulc", None),
    "thick": ("surfaces/fsaverage5_pial_left.vtp", "thick", None),
    "elevation": ("images/jacksboro_dem.vti", "elevation", "valid"),
}
THRESHOLDS = (2, 20, 40)
STRATEGIES = ("smooth-then-simplify", "flood", "separatrix", "harmonic")
TIMEOUT = 3600

Run = collections.namedtuple("Run", "field threshold strategy order select")


def plan(fields, orders, thresholds):
    """All runs, cheap ones first."""
    runs = []
    for field in fields:
        for order in orders:
            for threshold in thresholds:
                for strategy in STRATEGIES:
                    runs.append(Run(field, threshold, strategy, order, "data"))
                    if strategy == STRATEGIES[0] or (threshold, order) == (20, 2):
                        runs.append(Run(field, threshold, strategy, order, "smooth"))
    return sorted(runs, key=lambda run: (run.field == "elevation", run.order if run.field == "elevation" else 0))


def command(run, program, data, out, report):
    path, array, mask = FIELDS[run.field]
    slow = run.field == "elevation" and run.order >= 3
    return [program, "smooth", os.path.join(data, path), out, "--array", array, *(["--mask", mask] if mask else []),
            "--persistence", f"{run.threshold}%", "--representative", run.strategy, "--order", str(run.order),
            "--select", run.select, "--length", "0.5%" if slow else "1%", *(["--gap", "1e-4"] if slow else []),
            "--threads", "1", "--quiet", "--report", report]


@functools.cache
def source(data, field):
    """The field as VTK reads it, with the extrema above each threshold."""
    path, array, mask = FIELDS[field]
    mesh = pv.read(os.path.join(data, path))
    value = np.asarray(mesh.point_data[array])
    edge = edges(mesh, valid(mesh, value, mask))
    span = value[np.unique(edge)].astype(float)
    span = span.max() - span.min()
    return value, {percent: exceeding(edge, value, percent / 100 * span) for percent in THRESHOLDS}


def valid(mesh, value, mask):
    return np.isfinite(value) & ((np.asarray(mesh.point_data[mask]) != 0) if mask else True)


def judge(run, data, out, report):
    """What is wrong with the file written, in words."""
    faults = []
    _, array, mask = FIELDS[run.field]
    before, above = source(data, run.field)
    mesh = pv.read(out)
    value = np.asarray(mesh.point_data[f"{array}_smooth"])
    if value.dtype != before.dtype:
        faults.append(f"type {value.dtype}, that of the input is {before.dtype}")
    asked = [sorted(entry["point"] for entry in report["wanted"][kind]) for kind in ("minima", "maxima")]
    found = [ids.tolist() for ids in extrema(edges(mesh, valid(mesh, value, mask)), value)]
    for ids, name in zip(found, ("minima", "maxima", "minima under plain <", "maxima under plain <")):
        ask = asked[name.startswith("maxima")]
        if ids != ask:
            more, less = sorted(set(ids) - set(ask)), sorted(set(ask) - set(ids))
            faults.append(f"{len(ids)} {name}, {len(ask)} wanted: {len(more)} more {more[:5]}, {len(less)} missing {less[:5]}")
    if run.select == "data":
        for kind, ids, ask in zip(("minima", "maxima"), above[run.threshold], asked):
            if set(ids) - set(ask):
                faults.append(f"{kind} above the threshold not wanted: {sorted(set(ids) - set(ask))[:5]}")
        extra = sum(map(len, asked)) - sum(map(len, above[run.threshold]))
        if extra != report["smooth"]["unavoidable"]:
            faults.append(f"{extra} wanted below the threshold, {report['smooth']['unavoidable']} said to be unavoidable")
    for kind in ("minima", "maxima"):
        for entry in report["wanted"][kind]:
            expected = before[entry["point"]] if run.select == "data" else value.dtype.type(entry["value"])
            if value[entry["point"]] != expected:
                faults.append(f"value {value[entry['point']]!r} at {entry['point']}, {expected!r} was to be kept")
    return faults[:8], [len(ids) for ids in asked]


def perform(run, program, digest, data):
    with tempfile.TemporaryDirectory() as folder:
        out, report = os.path.join(folder, "out" + os.path.splitext(FIELDS[run.field][0])[1]), os.path.join(folder, "r.json")
        call = command(run, program, data, out, report)
        record = {"program": digest, **run._asdict(), "command": " ".join(call).replace(folder, "OUT")}
        begin = time.perf_counter()
        try:
            done = subprocess.run(call, capture_output=True, text=True, timeout=TIMEOUT)
            record |= {"exit": done.returncode}
            faults = [] if done.returncode == 0 else [f"exit code {done.returncode}: {done.stderr.strip()[-400:]}"]
        except subprocess.TimeoutExpired:
            faults = [f"not done after {TIMEOUT} s"]
        record["seconds"] = round(time.perf_counter() - begin, 2)
        if os.path.exists(report):
            with open(report) as text:
                said = json.load(text)
            smooth = said["smooth"]
            status = smooth["solver"]["status"]
            record |= {"status": status if isinstance(status, str) else next(iter(status)),
                       "used": smooth["representative"]["used"], "iterations": smooth["solver"]["iterations"],
                       "unavoidable": smooth["unavoidable"], "above_bound": smooth["energy"]["above_bound"],
                       "gap": smooth["solver"]["kkt"]["duality_gap"]}
            if os.path.exists(out):
                found, record["wanted"] = judge(run, data, out, said)
                faults += found
        if not os.path.exists(out):
            faults.append("nothing was written")
        record["faults"] = faults
    return record


def mark(record):
    if record is None:
        return "-"
    if record["faults"]:
        return "X"
    return ("f" if record["used"] != record["strategy"] else ".") if record["status"] == "solved" else "s"


def table(runs, records):
    """Markdown, one row a field, threshold and selection."""
    print("| field | select | threshold | wanted minima + maxima | " + " | ".join(STRATEGIES) + " |")
    print("|---|---|---|---|" + "---|" * len(STRATEGIES))
    orders = sorted({run.order for run in runs})
    for field, select, threshold in dict.fromkeys((r.field, r.select, r.threshold) for r in sorted(runs, key=lambda r: r.select)):
        chosen = {(r.strategy, r.order): records.get(r) for r in runs if (r.field, r.select, r.threshold) == (field, select, threshold)}
        counts = sorted({tuple(c["wanted"]) for c in chosen.values() if c and "wanted" in c})
        cells = ["".join(mark(chosen[strategy, order]) if (strategy, order) in chosen else " " for order in orders)
                 for strategy in STRATEGIES]
        wanted = f"{counts[0][0]} + {counts[0][1]}" + (f" to {counts[-1][0]} + {counts[-1][1]}" if len(counts) > 1 else "") \
            if counts else "-"
        print(f"| {field} | {select} | {threshold} % | {wanted} | " + " | ".join(cell.strip() for cell in cells) + " |")
    print(f"\nOne mark an order, {', '.join(map(str, orders))}. `.` exactly the wanted extrema; `f` the same, with another function than "
          "the one asked for, as its order contradicts the wanted values; `s` the same, but the solver did "
          "not reach its tolerance; `X` exception; `-` not run.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target/release/morsmooth"))
    parser.add_argument("--data", default=os.path.join(ROOT, "../shared/data"))
    parser.add_argument("--results", default=os.path.join(ROOT, "target/exact.jsonl"))
    parser.add_argument("--fields", nargs="+", choices=FIELDS, default=list(FIELDS))
    parser.add_argument("--orders", nargs="+", type=int, default=[1, 2, 3, 4])
    parser.add_argument("--thresholds", nargs="+", type=int, choices=THRESHOLDS, default=list(THRESHOLDS), metavar="PERCENT")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="programs at a time, each with one thread")
    parser.add_argument("--table", action="store_true", help="run nothing")
    given = parser.parse_args()
    given.program, given.data = os.path.relpath(given.program), os.path.relpath(given.data)
    with open(given.program, "rb") as binary:
        digest = hashlib.sha256(binary.read()).hexdigest()[:12]
    given.program = os.path.join(".", given.program)
    runs, records = plan(given.fields, given.orders, given.thresholds), {}
    if os.path.exists(given.results):
        with open(given.results) as lines:
            for record in map(json.loads, lines):
                if record["program"] == digest:
                    records[Run(*(record[name] for name in Run._fields))] = record
    todo = [] if given.table else [run for run in runs if run not in records]
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool, open(given.results, "a") as lines:
        futures = {pool.submit(perform, run, given.program, digest, given.data): run for run in todo}
        for number, future in enumerate(concurrent.futures.as_completed(futures), 1):
            record = records[futures[future]] = future.result()
            print(json.dumps(record), file=lines, flush=True)
            if record["faults"]:
                print(f"EXCEPTION {record['command']}\n  " + "\n  ".join(record["faults"]), flush=True)
            elif number % 20 == 0 or record["seconds"] > 60:
                print(f"{number} of {len(todo)}: {' '.join(map(str, futures[future]))}, {record['seconds']} s", flush=True)
    table(runs, records)
    done = [records[run] for run in runs if run in records]
    exceptions = [record for record in done if record["faults"]]
    for record in exceptions:
        print(f"EXCEPTION {record['command']}\n  " + "\n  ".join(record["faults"]))
    marks = collections.Counter(map(mark, done))
    print(f"{len(done)} runs, {len(exceptions)} exceptions ({len(runs) - len(done)} runs missing; {marks['f']} with another function instead "
          f"of the one asked for, {marks['s']} in which the solver did not reach its tolerance)")
    sys.exit(1 if exceptions or len(done) < len(runs) else 0)


if __name__ == "__main__":
    main()

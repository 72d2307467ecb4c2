#!/usr/bin/env python3
"""Check datasets/ against MANIFEST.toml: size and SHA-256 of every file, and no file unlisted.

Usage:  python tools/datasets/manifest.py            check what is there
        python tools/datasets/manifest.py --rebuild  run every script into a temporary folder and compare arrays

--rebuild compares what VTK reads, not bytes: another version of VTK or zlib may pack the same arrays otherwise.
Needs:  Python 3.11; --rebuild also pip install numpy scipy pyvista
"""
import hashlib
import os
import subprocess
import sys
import tempfile
import tomllib

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
FOLDER = os.path.join(ROOT, "datasets")


def same(path_a, path_b):
    if path_a.endswith((".csv", ".json")):
        return open(path_a, "rb").read() == open(path_b, "rb").read()
    import numpy as np
    import pyvista as pv
    a, b = pv.read(path_a), pv.read(path_b)
    return (type(a) is type(b) and np.array_equal(a.points, b.points) and a.array_names == b.array_names
            and all(a[k].dtype == b[k].dtype and np.array_equal(a[k], b[k]) for k in a.array_names)
            and (isinstance(a, pv.ImageData) or np.array_equal(np.r_[a.lines, a.faces], np.r_[b.lines, b.faces])))


def main():
    with open(os.path.join(FOLDER, "MANIFEST.toml"), "rb") as text:
        entries = tomllib.load(text)["dataset"]
    wrong = 0
    for entry in entries:
        path = os.path.join(FOLDER, entry["file"])
        data = open(path, "rb").read()
        ok = len(data) == entry["bytes"] and hashlib.sha256(data).hexdigest() == entry["sha256"]
        if ok and "--rebuild" in sys.argv[1:]:
            with tempfile.TemporaryDirectory() as folder:
                rebuilt = os.path.join(folder, entry["file"])
                subprocess.run([sys.executable, *entry["command"].split()[1:], rebuilt], check=True, cwd=ROOT,
                               stdout=subprocess.DEVNULL)
                ok = same(path, rebuilt)
        print("ok   " if ok else "WRONG", entry["file"])
        wrong += not ok
    listed = {e[key] for e in entries for key in ("file", "licence_file") if key in e} | {"MANIFEST.toml"}
    there = {os.path.relpath(os.path.join(f, n), FOLDER) for f, _, names in os.walk(FOLDER) for n in names}
    unlisted = there - listed
    if unlisted:
        print("WRONG unlisted:", *sorted(unlisted))
    sys.exit(bool(wrong or unlisted))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Draw the pictures of the README again.

Usage:  python tools/pictures/readme.py [--program target/release/morsmooth]
Needs:  pip install pillow

Runs the README's commands with --plots and keeps before_after.png or complex.png of each, reduced to 128 colours.
"""
import argparse
import os
import subprocess
import tempfile

from PIL import Image

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
# name: command, its output, its options, the picture that it draws
RUNS = {
    "jet_select_smooth.png": ("smooth", "out.vti", ["--select", "smooth", "--persistence", "10%"], "before_after.png"),
    "jet_select_data.png": ("smooth", "out.vti", ["--select", "data", "--persistence", "20%"], "before_after.png"),
    "jet_complex.png": ("complex", "complex", ["--persistence", "20%"], "complex.png"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target", "release", "morsmooth"))
    program = parser.parse_args().program
    for name, (command, output, options, drawn) in RUNS.items():
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(
                [program, command, os.path.join(ROOT, "datasets", "jet.vti"), os.path.join(folder, output),
                 "--array", "vorticity_magnitude", "--mask", "valid", *options, "--plots", folder, "--quiet"],
                check=True,
            )
            picture = Image.open(os.path.join(folder, drawn)).convert("RGB")
            picture = picture.resize((1200, round(1200 * picture.height / picture.width)), Image.LANCZOS)
            picture.quantize(128, dither=Image.Dither.NONE).save(os.path.join(HERE, name), optimize=True)
            print(name, os.path.getsize(os.path.join(HERE, name)), "bytes")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""datasets/italy.csv: the outline of Italy's mainland, a ring of places x, y.

Source: npm world-atlas 2.0.2, countries-50m.json (Natural Earth 4.1, public domain; the package is ISC).
Needs:  npm on the path (it fetches the package; nothing of it is run)
Usage:  python tools/datasets/italy.py [OUTPUT]

The largest polygon of the country with the ISO number 380, its outer ring, x = longitude times the cosine of the middle latitude, y = latitude,
in degrees of latitude, six digits, counter-clockwise.
"""
import json
import math
import os
import subprocess
import sys
import tarfile

import archive

PACKAGE, MEMBER, COUNTRY = "world-atlas-2.0.2.tgz", "package/countries-50m.json", "380"


def topology():
    os.makedirs(archive.CACHE, exist_ok=True)
    path = os.path.join(archive.CACHE, PACKAGE)
    if not os.path.exists(path):
        subprocess.run(["npm", "pack", "--silent", "world-atlas@2.0.2"], cwd=archive.CACHE, check=True, stdout=subprocess.DEVNULL)
    with tarfile.open(path) as packed:
        return json.load(packed.extractfile(MEMBER))


def arcs(world):
    scale, shift = world["transform"]["scale"], world["transform"]["translate"]
    for arc in world["arcs"]:
        x = y = 0
        places = []
        for dx, dy in arc:
            x, y = x + dx, y + dy
            places.append((x * scale[0] + shift[0], y * scale[1] + shift[1]))
        yield places


def ring(numbers, lines):
    """The places of a ring; a number ~n is arc n backwards, and arcs share their ends."""
    places = []
    for number in numbers:
        line = lines[number] if number >= 0 else lines[~number][::-1]
        places += line[1:]
    return places


def area(places):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(places, places[1:] + places[:1])) / 2


def main():
    world = topology()
    lines = list(arcs(world))
    country = next(g for g in world["objects"]["countries"]["geometries"] if g.get("id") == COUNTRY)
    polygons = country["arcs"] if country["type"] == "MultiPolygon" else [country["arcs"]]
    outer = max((ring(polygon[0], lines) for polygon in polygons), key=lambda places: abs(area(places)))
    if area(outer) < 0:
        outer.reverse()
    latitudes = [y for _, y in outer]
    narrow = math.cos(math.radians((min(latitudes) + max(latitudes)) / 2))
    text = "x,y\n" + "".join(f"{x * narrow:.6f},{y:.6f}\n" for x, y in outer)
    path = archive.output("italy.csv")
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(text)
    print(path, len(outer))


if __name__ == "__main__":
    main()

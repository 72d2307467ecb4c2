#!/usr/bin/env python3
"""datasets/co2.vtp: weekly carbon dioxide in the air at Mauna Loa, 1958 to 2001, as one polyline.

Source: PyPI statsmodels 0.15.0, statsmodels/datasets/co2/co2.csv ("This is public domain", says its data.py).
Needs:  pip install numpy pyvista
Usage:  python tools/datasets/co2.py [OUTPUT]

A vertex for each week with a measurement, x = years of 365.25 days since 1958-03-29; weeks without one are bridged.
  co2   ppm by volume
  date  YYYYMMDD
"""
import csv
import datetime
import io

import numpy as np
import pyvista as pv

import archive


def main():
    text = archive.member(archive.fetch("statsmodels", "0.15.0"), "datasets/co2/co2.csv").decode("ascii")
    rows = [(r["date"], float(r["co2"])) for r in csv.DictReader(io.StringIO(text)) if r["co2"].strip()]
    days = [datetime.datetime.strptime(date, "%Y%m%d").toordinal() for date, _ in rows]
    x = (np.array(days) - days[0]) / 365.25
    assert (np.diff(x) > 0).all()
    line = pv.PolyData(np.stack([x, 0 * x, 0 * x], -1), lines=np.r_[len(x), np.arange(len(x))])
    line.point_data["co2"] = np.array([value for _, value in rows])
    line.point_data["date"] = np.array([int(date) for date, _ in rows], np.int32)
    line.set_active_scalars("co2")
    line.save(archive.output("co2.vtp"))
    print(line.n_points, line.n_cells, rows[0], rows[-1])


if __name__ == "__main__":
    main()

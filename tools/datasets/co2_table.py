#!/usr/bin/env python3
"""datasets/co2.csv: weekly carbon dioxide in the air at Mauna Loa, 1958 to 2001, as a table with dates.

Source: PyPI statsmodels 0.15.0, statsmodels/datasets/co2/co2.csv ("This is public domain", says its data.py).
Needs:  only Python
Usage:  python tools/datasets/co2_table.py [OUTPUT]

A row for each week, in the source's order; an empty cell where no measurement was made.
  date  YYYY-MM-DD
  co2   ppm by volume, as the source writes it
"""
import csv
import io

import archive


def main():
    text = archive.member(archive.fetch("statsmodels", "0.15.0"), "datasets/co2/co2.csv").decode("ascii")
    rows = [(r["date"], r["co2"].strip()) for r in csv.DictReader(io.StringIO(text))]
    with open(archive.output("co2.csv"), "w", newline="") as table:
        table.write("date,co2\n")
        for date, value in rows:
            table.write(f"{date[:4]}-{date[4:6]}-{date[6:]},{value}\n")
    print(len(rows), rows[0], rows[-1])


if __name__ == "__main__":
    main()

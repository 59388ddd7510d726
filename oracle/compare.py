"""Recomputes the tables of crates/amontons/tests/reference and compares them: one row of output per table.
Exits with 1 if a difference is above its tolerance. Needs numpy and scipy (requirements.txt); runs on one thread.

    python3 oracle/compare.py                    everything; about 40 minutes of one core, half of them for (5.2)
    python3 oracle/compare.py --quick            n = 16 and the like, a few seconds
    python3 oracle/compare.py --table paper      one table
    python3 oracle/compare.py --write FOLDER     also writes the recomputed tables
"""

import argparse
import csv
import os
import sys
import time
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"                                     # before numpy is loaded

import numpy as np

import constants
import manufactured
import paper
from scheme import Mesh

REFERENCE = Path(__file__).resolve().parent.parent / "crates/amontons/tests/reference"
TOLERANCE = 1e-10
COUNTS = {"open", "stick", "slip", "slip+", "slip-"}                    # have to be equal
# Each function yields the rows of a table with their values by column, or none for a row that --quick leaves out.
# `round_off` among the values holds, by column, what an error is granted besides 1e-10 of itself: an error is the
# difference of two nearly equal fields, which two programs know to the round-off of their solves only (README.md).


def paper_rows(rows, quick):
    for row in rows:
        n = int(row["n"])
        if quick and n > 16:
            yield row, None
            continue
        yield row, paper.summary(row["reading"], float(row["theta_F"]), n, int(row["steps"]))


def convergence_rows(rows, quick):
    studies = {}
    for row in rows:
        studies.setdefault((row["reading"], float(row["theta_F"])), {})[int(row["level"])] = row
    for (reading, theta_F), levels in studies.items():
        if quick:
            yield from ((row, None) for row in levels.values())
            continue
        errors, round_off = paper.study(reading, theta_F, list(levels), 256)
        before, names = None, ["error_w", "error_u", "error_theta", "error"]
        for n, row in levels.items():
            values = dict(zip(names, errors[n])) | {"round_off": dict(zip(names, round_off))}
            if before is not None:
                values["order"] = round(np.log2(before / values["error"]), 4)
            before = values["error"]
            yield row, values


def constants_rows(rows, quick):
    for row in rows:
        n = int(row["n"])
        yield row, None if quick and n > 32 else constants.row(row["diag"], n)


def manufactured_rows(rows, quick):
    for row in rows:
        n, steps = int(row["n"]), int(row["N"])
        points = None if row["bquad"] == "lumped" else int(row["bquad"])
        yield row, None if quick and (n > 16 or steps > 16) else manufactured.errors(row["case"], n, steps, points)


def loads_rows(rows, quick):
    for row in rows:
        exact, mesh, node = manufactured.Exact(row["case"]), Mesh(int(row["n"])), int(row["node"])
        force, source = manufactured.loads(exact, manufactured.Integrals(mesh), 0.5, 0.5)
        yield row, {"Fx(t=0.5)": force[2 * node], "Fy(t=0.5)": force[2 * node + 1], "Q(t=0.5)": source[node]}


TABLES = {
    "paper": paper_rows,
    "convergence": convergence_rows,
    "constants": constants_rows,
    "manufactured": manufactured_rows,
    "manufactured_loads": loads_rows,
}


def difference(row, name, values):
    """The difference as a share of what is allowed, and relative to the value unless that is zero or round-off."""
    if name in COUNTS:
        return (0.0, 0.0) if int(row[name]) == values[name] else (np.inf, 1.0)
    apart, value = abs(values[name] - float(row[name])), abs(float(row[name]))
    if apart == 0.0:
        return 0.0, 0.0
    allowed = TOLERANCE * value + values.get("round_off", {}).get(name, 0.0)
    return apart / allowed if allowed else np.inf, apart / value if value > 1e-12 else 0.0


def compare(table, quick, folder):
    """Prints the row of a table and says whether it agrees."""
    start = time.time()
    with open(REFERENCE / f"{table}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    worst, worst_relative, where, count, done, written = 0.0, 0.0, "", 0, 0, []
    for row, values in TABLES[table](rows, quick):
        written.append(row)
        if values is None:
            continue
        done += 1
        names = [name for name in row if name in values]
        for name in names:
            count += 1
            now, relative = difference(row, name, values)
            worst_relative = max(worst_relative, relative)
            if not now <= worst:                                        # also where it is not a number
                worst, where = now, f"{name} in row {rows.index(row) + 1}"
        written[-1] = row | {name: values[name] if name in COUNTS else f"{values[name]:.12e}" for name in names}
    verdict = "left to the full run" if not done else "agrees" if worst <= 1 else f"DIFFERS at {where}"
    numbers = f"{count:>10}{worst_relative:>10.1e}{worst:>11.1e}{time.time() - start:>8.1f}"
    print(f"{table:<19}{done:>4} of {len(rows):<3}{numbers if done else ' ' * 39}  {verdict}", flush=True)
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
        with open(folder / f"{table}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(written)
    return worst <= 1


def main():
    parser = argparse.ArgumentParser(description="Recompute the tables of crates/amontons/tests/reference and compare.")
    parser.add_argument("--quick", action="store_true", help="coarse rows only, a few seconds")
    parser.add_argument("--table", choices=TABLES, action="append", help="compare this table only; may be repeated")
    parser.add_argument("--write", type=Path, metavar="FOLDER", help="write the recomputed tables there")
    arguments = parser.parse_args()
    titles = f"{'quantities':>10}{'to value':>10}{'of allowed':>11}{'s':>8}"
    print(f"{'table':<19}{'rows':>11}{titles}  verdict")
    verdicts = [compare(table, arguments.quick, arguments.write) for table in arguments.table or TABLES]
    sys.exit(0 if all(verdicts) else 1)


if __name__ == "__main__":
    main()

"""Compares what CalculiX prints of decks with runs of the imported cases: compare.py PROGRAM FOLDER NAME…

The folder has for each name the deck, its `.dat` file of CalculiX, and its case in SI; decks are in mm, N, MPa. Compared
are all total forces, displacements and temperatures of nodes in the `.dat` file, within 1.5 % of the largest of their set.
"""

import csv
import re
import subprocess
import sys
from pathlib import Path

TOLERANCE = 0.015
# CalculiX writes forces of bodies of revolution for two of 360 degrees.
SECTOR = {"bar": 180.0}
HEAD = re.compile(r"(total force|displacements|temperatures).* for set (\S+) and time +(\S+)")
QUANTITY = {"displacements": ("displacement", 1e-3), "temperatures": ("temperature", 1.0)}


def printed(path):
    """Blocks of a `.dat` file: what, set, time, rows of numbers."""
    blocks = []
    for line in path.read_text().splitlines():
        head = HEAD.search(line)
        if head:
            blocks.append((head[1], head[2], float(head[3]), []))
        elif line.strip() and " for set " in line:
            blocks.append((None, None, 0.0, []))
        elif line.strip() and blocks:
            blocks[-1][3].append([float(word) for word in line.split()])
    return [block for block in blocks if block[0]]


def nodes(path):
    """Coordinates of the nodes of a deck, by their numbers."""
    found, inside = {}, False
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            inside = line.upper().startswith("*NODE,") or line.upper() == "*NODE"
        elif inside:
            number, *point = (word.strip() for word in line.split(","))
            found[int(number)] = [float(x) for x in point]
    return found


def compare(program, folder, name):
    """Differences of a deck, relative to the largest number of their block."""
    points, blocks = nodes(folder / f"{name}.inp"), printed(folder / f"{name}.dat")
    if not blocks:
        raise SystemExit(f"{name}: CalculiX has printed nothing")
    case = folder / f"{name}.toml"
    text = case.read_text()
    shift = re.search(r"^# Temperatures count from (\S+),", text, re.M)
    shift = float(shift[1]) if shift else 0.0
    wanted = {row[0] for what, _, _, rows in blocks if what != "total force" for row in rows}
    kinds = {QUANTITY[what][0] for what, _, _, _ in blocks if what != "total force"}
    for number in sorted(wanted):
        for kind in kinds:
            at = [x * 1e-3 for x in points[int(number)]]
            text += f'\n[[probe]]\nname = "{kind}-{int(number)}"\nquantity = "{kind}"\nat = {at}\n'
    case.write_text(text)
    out = folder / f"{name}-results"
    subprocess.run([program, "run", case, "--out", out, "--no-certificate", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    with open(out / "probes.csv") as file:
        table = list(csv.DictReader(file))
    worst, count = 0.0, 0
    for what, of, time, rows in blocks:
        near = [row for row in table if abs(float(row["t"]) - time) < 1e-6]
        if not near:
            continue
        column = lambda name, d: float(near[0].get(name, near[0].get(f"{name}_{'xyz'[d]}", "nan")))
        pairs = []
        for row in rows:
            if what == "total force":
                if f"reaction-{of}_x" in near[0]:
                    factor = SECTOR.get(name, 1.0)
                    pairs += [(factor * row[d], column(f"reaction-{of}", d)) for d in range(3) if f"reaction-{of}_{'xyz'[d]}" in near[0]]
                continue
            kind, unit = QUANTITY[what]
            numbers = row[1:] if what == "temperatures" else row[1 : 1 + len([d for d in "xyz" if f"{kind}-{int(row[0])}_{d}" in near[0]])]
            for d, value in enumerate(numbers):
                pairs.append((value * unit, column(f"{kind}-{int(row[0])}", d) + (shift if kind == "temperature" else 0.0)))
        if not pairs:
            continue
        scale = max(abs(a) for a, _ in pairs)
        differences = [abs(a - b) / scale for a, b in pairs]
        worst, count = max(worst, *differences), count + len(pairs)
    if count == 0:
        raise SystemExit(f"{name}: nothing to compare")
    return worst, count


def main(program, folder, *names):
    failed = False
    for name in names:
        worst, count = compare(program, Path(folder), name)
        holds = worst <= TOLERANCE
        failed |= not holds
        print(f"{name:16}{count:5} numbers, at most {100 * worst:.3f} % apart{'' if holds else ': FAILED'}")
    sys.exit(failed)


main(*sys.argv[1:])

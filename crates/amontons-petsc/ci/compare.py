#!/usr/bin/env python3
"""Compares the results of two runs by the largest difference of each field, relative to the size of the field.

    compare.py ONE OTHER [TOLERANCE]

Reads the last fields that both folders hold (VTU), the last tables of the contact sides and the history. Needs nothing
but Python. Ends with 1 if a difference is above the tolerance, by default 1e-8.
"""

import array
import base64
import csv
import pathlib
import re
import sys
import zlib

# What is no result: counts, which a point without force may change by round-off, the time and what is made of it, and
# the centre of the contact forces, which is a moment over a force that may vanish: both are compared.
PASSED = re.compile(
    r"newton|passes|contraction|closing_error|contact_center|^(open|stick|slip|status|parts|step|t|k|node|side)(@|$)"
)
# Quantities that have one scale: what is round-off beside the others is not compared with itself.
KINDS = [
    ("temperature", re.compile(r"temperature")),
    ("heat", re.compile(r"heat")),
    ("energy", re.compile(r"kinetic|elastic|dissipation|energy|work")),
    ("moment", re.compile(r"moment")),
    ("force", re.compile(r"force")),
    ("velocity", re.compile(r"velocity")),
    ("displacement", re.compile(r"displacement|penetration|gap|wear")),
    ("stress", re.compile(r"stress|mises|pressure|traction|bound")),
]


def kind(name):
    """The kind of a quantity; any other has a kind of its own."""
    return next((word for word, names in KINDS if names.search(name)), name)


def arrays(path):
    """The real fields of a VTU file by name."""
    text = path.read_text()
    found = {}
    for kind, name, data in re.findall(r'<DataArray type="(\w+)" Name="([^"]+)"[^>]*format="binary">([^<]*)<', text):
        if kind == "Float64":
            found[name] = decoded(data.strip())
    return found


def decoded(data):
    """Numbers in blocks that are compressed one by one, behind their lengths."""
    head = array.array("Q", base64.b64decode(data[:12])[:8])
    blocks = head[0]
    length = (8 * (3 + blocks) + 2) // 3 * 4
    sizes = array.array("Q", base64.b64decode(data[:length])[: 8 * (3 + blocks)])[3:]
    packed, values, at = base64.b64decode(data[length:]), array.array("d"), 0
    for size in sizes:
        values.frombytes(zlib.decompress(packed[at : at + size]))
        at += size
    return values


def columns(path):
    """The columns of a table, by name."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    names = rows[0].keys() if rows else []
    return {name: array.array("d", [number(row[name]) for row in rows]) for name in names}


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        # A status by name, or nothing.
        return float(zlib.crc32((text or "").encode()))


def last(folder, pattern, which=None):
    """The last file that matches, by name, or all of them."""
    found = sorted(path.relative_to(folder) for path in folder.glob(pattern))
    return found if which is all else found[-1:]


def fields(folder, other):
    """The fields of both folders: file, name, and the values of each."""
    for name in last(folder, "fields/*.vtu") + last(folder, "contact/*.csv") + last(folder, "*.csv", all):
        read = arrays if name.suffix == ".vtu" else columns
        own, others = read(folder / name), read(other / name)
        for field, values in own.items():
            yield str(name), field, values, others.get(field, [])


def differences(one, other):
    """The largest difference of each field, relative to the largest value of its kind."""
    found = list(fields(one, other))
    scales = {}
    for _, name, values, _ in found:
        largest = max((abs(x) for x in values if x == x), default=0.0)
        scales[kind(name)] = max(scales.get(kind(name), 0.0), largest)
    # A body that comes to rest has the velocity of its motion as scale.
    end = max((max(values) for file, name, values, _ in found if name == "t" and len(values)), default=0.0)
    if end > 0:
        scales["velocity"] = max(scales.get("velocity", 0.0), scales.get("displacement", 0.0) / end)
    for file, name, values, others in found:
        scale = scales[kind(name)]
        if PASSED.search(name) or scale == 0:
            continue
        if len(values) != len(others):
            yield file, name, float("inf")
            continue
        # What is no number in one of them has to be none in the other.
        apart = (abs(a - b) if a == a and b == b else float("inf") for a, b in zip(values, others) if a == a or b == b)
        yield file, name, max(apart, default=0.0) / scale


def main():
    one, other = (pathlib.Path(name) for name in sys.argv[1:3])
    tolerance = float(sys.argv[3]) if len(sys.argv) > 3 else 1e-8
    found = sorted(differences(one, other), key=lambda row: -row[2])
    if not found:
        sys.exit(f"{one}: nothing to compare")
    file, name, worst = found[0]
    print(f"{worst:.1e}  {name} in {file}")
    for file, name, difference in found:
        if not difference <= tolerance:
            print(f"    {difference:.1e}  {name} in {file}")
    sys.exit(0 if worst <= tolerance else 1)


if __name__ == "__main__":
    main()

"""The benchmarks `pair-quadratic-friction-heat` and `pair-turned-cube-heat` as inputs of CalculiX.

    python3 contact_heat_calculix.py FOLDER

Writes `slide-4.inp`, `slide-6.inp` and `slide-8.inp`, a cube that slides on another one with faces of 4, 6 and 8 nodes,
and `turned-nodes.inp` and `turned-faces.inp`, two cubes whose contact is a surface of nodes or of faces. Run `ccx NAME`
there. The heats in `slide-*.dat` sum to the power of friction, 0.2 · 10 · 3 = 6 in the closed form; at the end of
`turned-*.dat` stand the temperatures of the nodes, 160 and 200 at the contact in the closed form.
"""

import sys
from itertools import permutations, product
from pathlib import Path

SLIDE = """*MATERIAL, NAME=CUBE
*ELASTIC
1e6, 0
*DENSITY
1
*EXPANSION
0
*CONDUCTIVITY
1
*SPECIFIC HEAT
1
*SOLID SECTION, ELSET=ALL, MATERIAL=CUBE
*SURFACE INTERACTION, NAME=RUBS
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1e8,
*FRICTION
0.2, 1e7
*GAP CONDUCTANCE
1000,
*GAP HEAT GENERATION
1, 0.5, 3
*CONTACT PAIR, INTERACTION=RUBS, TYPE=SURFACE TO SURFACE
HIGH_BACK, LOW_FRONT
*INITIAL CONDITIONS, TYPE=TEMPERATURE
NODES, 0
*STEP, INC=1000
*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
1, 1
*BOUNDARY
LOW, 1, 3, 0
HIGH, 1, 1, 0.01
HIGH, 2, 2, 0
LOW_BACK, 11, 11, 0
HIGH_FRONT, 11, 11, 0
*DLOAD
{loads}
*NODE PRINT, NSET=LOW_BACK, TOTALS=ONLY
RFL
*NODE PRINT, NSET=HIGH_FRONT, TOTALS=ONLY
RFL
*END STEP
"""

TURNED = """*NODE, NSET=NODES
{nodes}
*ELEMENT, TYPE=C3D8, ELSET=ALL
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 9, 10, 11, 12, 13, 14, 15, 16
*SURFACE, NAME=LARGE
1, S2
{surface}
*MATERIAL, NAME=CUBE
*ELASTIC
210000, 0.3
*DENSITY
7.8e-9
*CONDUCTIVITY
0.01
*SPECIFIC HEAT
1000
*SOLID SECTION, ELSET=ALL, MATERIAL=CUBE
*SURFACE INTERACTION, NAME=TOUCHES
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1e7, 3
*GAP CONDUCTANCE
1,
*CONTACT PAIR, INTERACTION=TOUCHES, TYPE=NODE TO SURFACE
SMALL, LARGE
*INITIAL CONDITIONS, TYPE=TEMPERATURE
NODES, 0
*STEP
*HEAT TRANSFER, STEADY STATE
1, 1
*BOUNDARY
{cold}
{hot}
*NODE PRINT, NSET=NODES
NT
*END STEP
"""

# Local corners of the cells, faces as CalculiX numbers them, and edges whose middles are nodes.
HEXAHEDRON = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
FACES = {
    8: [(0, 1, 2, 3), (4, 7, 6, 5)],
    4: [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
}
EDGES = {
    8: [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
    4: [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
}


def determinant(a, b, c):
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


def cells(n, tetrahedra):
    """The corners of the cells of the unit cube."""
    for corner in product(range(n), repeat=3):
        if not tetrahedra:
            yield [tuple((c + d) / n for c, d in zip(corner, local)) for local in HEXAHEDRON]
            continue
        for order in permutations(range(3)):
            at = list(corner)
            points = [tuple(c / n for c in at)]
            for axis in order:
                at[axis] += 1
                points.append(tuple(c / n for c in at))
            edges = [[p - q for p, q in zip(point, points[0])] for point in points[1:]]
            if determinant(*edges) < 0:
                points[1], points[2] = points[2], points[1]
            yield points


def slide(kind):
    """Two cubes whose contact faces have 4, 6 or 8 nodes."""
    tetrahedra, quadratic = kind == 6, kind != 4
    numbers, elements, sides = {}, [], {"LOW_FRONT": [], "HIGH_BACK": [], "TOP": []}
    for body, (n, bottom) in enumerate([(2, 0.0), (3, 1.0 - 1e-9)]):
        for points in cells(n, tetrahedra):
            placed = [(x, y, z + bottom) for x, y, z in points]
            if quadratic:
                middle = lambda a, b: tuple((p + q) / 2 for p, q in zip(placed[a], placed[b]))
                placed = placed + [middle(a, b) for a, b in EDGES[len(points)]]
            key = lambda point: (body, *(round(c, 7) for c in point))
            elements.append([numbers.setdefault(key(p), (len(numbers) + 1, p))[0] for p in placed])
            for number, face in enumerate(FACES[len(points)], 1):
                heights = {round(points[i][2], 7) for i in face}
                for side, owner, height in [("LOW_FRONT", 0, 1.0), ("HIGH_BACK", 1, 0.0), ("TOP", 1, 1.0)]:
                    if body == owner and heights == {height}:
                        sides[side].append((len(elements), number))
    lines = ["*NODE, NSET=NODES"] + [f"{i}, {p[0]:.10g}, {p[1]:.10g}, {p[2]:.10g}" for i, p in numbers.values()]
    lines.append(f"*ELEMENT, TYPE={ {4: 'C3D8', 6: 'C3D10', 8: 'C3D20'}[kind] }, ELSET=ALL")
    for i, nodes in enumerate(elements, 1):
        row = [str(v) for v in [i, *nodes]]
        lines.append(", ".join(row[:11]) + ("," if len(row) > 11 else ""))
        lines += [", ".join(row[11:])] if len(row) > 11 else []
    sets = {
        "LOW": lambda k, p: k[0] == 0,
        "HIGH": lambda k, p: k[0] == 1,
        "LOW_BACK": lambda k, p: k[0] == 0 and p[2] < 1e-6,
        "HIGH_FRONT": lambda k, p: k[0] == 1 and p[2] > 2 - 1e-6,
    }
    for name, holds in sets.items():
        lines += [f"*NSET, NSET={name}"] + [f"{i}," for k, (i, p) in numbers.items() if holds(k, p)]
    for side in ["LOW_FRONT", "HIGH_BACK"]:
        lines += [f"*SURFACE, NAME={side}"] + [f"{cell}, S{face}" for cell, face in sides[side]]
    loads = "\n".join(f"{cell}, P{face}, 10" for cell, face in sides["TOP"])
    return "\n".join(lines) + "\n" + SLIDE.format(loads=loads)


def turned(faces):
    """A cube of 0.2 on one of 1, turned by 45°. It begins 1e-6 inside: without overlap CalculiX takes no contact."""
    half = 0.1 * 2**0.5
    foot = [(0.5, 0.5 - half), (0.5 + half, 0.5), (0.5, 0.5 + half), (0.5 - half, 0.5)]
    points = [(float(x), float(y), float(z)) for x, y, z in HEXAHEDRON]
    points += [(x, y, z) for z in [1 - 1e-6, 1.2] for x, y in foot]
    surface = "*SURFACE, NAME=SMALL\n2, S1" if faces else "*SURFACE, NAME=SMALL, TYPE=NODE\n9,\n10,\n11,\n12,"
    return TURNED.format(
        nodes="\n".join(f"{i}, {x:.10g}, {y:.10g}, {z:.10g}" for i, (x, y, z) in enumerate(points, 1)),
        surface=surface,
        cold="\n".join(f"{i}, 11, 11, 0" for i in range(1, 5)),
        hot="\n".join(f"{i}, 11, 11, 1000" for i in range(13, 17)),
    )


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for kind in (4, 6, 8):
        (folder / f"slide-{kind}.inp").write_text(slide(kind))
    (folder / "turned-nodes.inp").write_text(turned(False))
    (folder / "turned-faces.inp").write_text(turned(True))


main()

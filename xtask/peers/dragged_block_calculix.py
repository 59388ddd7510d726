"""The benchmark `pair-dragged-block` as an input of CalculiX, in mm, N and MPa, whose keywords are those of Abaqus.

    python3 dragged_block_calculix.py FOLDER [SLOPE [STICK]]

Writes `mesh.inp` and `block.inp` into the folder; run `ccx block` there. SLOPE is the pressure per overclosure and STICK the
traction per slip of a sticking point, N/mm³. `block.dat` has the forces on the bottom of the base, N per mm of thickness.
"""

import sys
from pathlib import Path

STEP = """*INCLUDE, INPUT=mesh.inp
*MATERIAL, NAME=STEEL
*ELASTIC
210000, 0.3
*SOLID SECTION, ELSET=BASE, MATERIAL=STEEL
1
*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL
1
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{slope}, 1
*FRICTION
0.3, {stick}
*CONTACT PAIR, INTERACTION=DRY, TYPE=SURFACE TO SURFACE
BLOCK_BOTTOM, BASE_TOP
*BOUNDARY
BASE_BOTTOM, 1, 2
*AMPLITUDE, NAME=PRESS
0, 0, 1, 1, 2, 1
*AMPLITUDE, NAME=DRAG
0, 0, 1, 0, 2, 1
*STEP, INC=1000
*STATIC
0.1, 2, 1e-5, 0.1
*BOUNDARY, AMPLITUDE=PRESS
BLOCK_TOP, 2, 2, -0.01
*BOUNDARY, AMPLITUDE=DRAG
BLOCK_TOP, 1, 1, 0.02
*NODE PRINT, NSET=BASE_BOTTOM, TOTALS=ONLY
RF
*END STEP
"""


def block(corner, size, cells, first):
    """Lines of nodes and of elements, and the numbers of the nodes by column and row."""
    (columns, rows) = cells
    number = lambda i, j: first + 1 + j * (columns + 1) + i
    nodes = [
        f"{number(i, j)}, {corner[0] + size[0] * i / columns:.10g}, {corner[1] + size[1] * j / rows:.10g}, 0"
        for j in range(rows + 1)
        for i in range(columns + 1)
    ]
    elements = [
        f"{first + 1 + j * columns + i}, {number(i, j)}, {number(i + 1, j)}, {number(i + 1, j + 1)}, {number(i, j + 1)}"
        for j in range(rows)
        for i in range(columns)
    ]
    return nodes, elements, number


def main(folder, slope="1e8", stick="1e7"):
    nodes, elements, number = block((0, 0), (60, 20), (45, 15), 0)
    more_nodes, more_elements, more_number = block((20, 20), (20, 20), (20, 20), 10000)
    lines = ["*NODE", *nodes, *more_nodes]
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=BASE", *elements, "*ELEMENT, TYPE=CPE4, ELSET=BLOCK", *more_elements]
    lines += ["*NSET, NSET=BASE_BOTTOM", *(str(number(i, 0)) for i in range(46))]
    lines += ["*NSET, NSET=BLOCK_TOP", *(str(more_number(i, 20)) for i in range(21))]
    lines += ["*SURFACE, NAME=BASE_TOP, TYPE=ELEMENT", *(f"{14 * 45 + i + 1}, S3" for i in range(45))]
    lines += ["*SURFACE, NAME=BLOCK_BOTTOM, TYPE=ELEMENT", *(f"{10000 + i + 1}, S1" for i in range(20))]
    folder = Path(folder)
    (folder / "mesh.inp").write_text("\n".join(lines) + "\n")
    (folder / "block.inp").write_text(STEP.format(slope=slope, stick=stick))


main(*sys.argv[1:])

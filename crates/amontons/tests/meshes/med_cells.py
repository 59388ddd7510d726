"""Writes MED files of one cell each with the library of the format: `python med_cells.py`, which needs the packages
medcoupling and numpy. Where the middle nodes lie is said by the faces that the library has for each type of cell.
"""

import medcoupling as mc
import numpy as np

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
above = lambda base: base + [(x, y, 1) for x, y, _ in base]
# Name of the file, type, number of nodes, vertices as the library orients cells.
CELLS = [
    ("quadrilateral9", mc.NORM_QUAD9, 9, SQUARE),
    ("triangle7", mc.NORM_TRI7, 7, TRIANGLE),
    ("pyramid13", mc.NORM_PYRA13, 13, SQUARE[:1] + SQUARE[:0:-1] + [(0, 0, 1)]),
    ("prism18", mc.NORM_PENTA18, 18, above([TRIANGLE[i] for i in (0, 2, 1)])),
    ("hexahedron27", mc.NORM_HEXA27, 27, above(SQUARE[:1] + SQUARE[:0:-1])),
]
SHEAR = np.array([[2.0, 0.0, 0.125], [0.25, 1.0, 0.0], [0.0, -0.25, 0.5]])


def mesh(kind, points):
    grid = mc.MEDCouplingUMesh("part", 3 if kind not in (mc.NORM_QUAD9, mc.NORM_TRI7) else 2)
    grid.setCoords(mc.DataArrayDouble(np.ascontiguousarray(points)))
    grid.allocateCells(1)
    grid.insertNextCell(kind, list(range(len(points))))
    grid.finishInsertingCells()
    return grid


def facets(grid):
    """The nodes of each facet: vertices, middles of the edges, centre."""
    built = grid.buildDescendingConnectivity()[0]
    return [list(built.getNodeIdsOfCell(i)) for i in range(built.getNumberOfCells())]


for name, kind, count, vertices in CELLS:
    points = np.full((count, 3), np.nan)
    points[: len(vertices)] = np.array(vertices, float) @ SHEAR
    blank = np.arange(3.0 * count).reshape(count, 3)
    for nodes in facets(mesh(kind, blank)):
        corners = {2: 1, 3: 2, 6: 3, 8: 4, 9: 4}[len(nodes)]
        if len(nodes) == 3:
            points[nodes[2]] = points[nodes[:2]].mean(axis=0)
            continue
        for i in range(corners):
            points[nodes[corners + i]] = points[[nodes[i], nodes[(i + 1) % corners]]].mean(axis=0)
        if len(nodes) == 9:
            points[nodes[8]] = points[nodes[:4]].mean(axis=0)
    inner = np.isnan(points[:, 0])
    assert inner.sum() <= 1, (name, np.flatnonzero(inner))
    points[inner] = points[: len(vertices)].mean(axis=0)
    if kind in (mc.NORM_QUAD9, mc.NORM_TRI7):
        points = points[:, :2]
    grid = mesh(kind, points)
    if grid.getMeshDimension() == 3:
        linear = grid.deepCopy()
        linear.convertQuadraticCellsToLinear()
        assert linear.findAndCorrectBadOriented3DCells().getNumberOfTuples() == 0, name
    mc.WriteUMesh(f"{name}.med", grid, True)

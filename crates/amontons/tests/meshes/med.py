"""Writes the MED files beside it with h5py, as the format describes them: `python med.py`.

Coordinates come as all x, all y, all z; the nodes of cells as all first ones, all second ones and so on, from 1; cells in
space with the first face seen from inside, the mirror image of VTK's.
"""

import itertools

import h5py
import numpy as np


def write(path, points, cells, families, node_families=None, major=4, steps=True):
    points = np.asarray(points, float)
    count, dim = points.shape
    with h5py.File(path, "w") as file:
        info = file.create_group("INFOS_GENERALES")
        info.attrs.update({"MAJ": np.int32(major), "MIN": np.int32(0), "REL": np.int32(0)})
        mesh = file.create_group("ENS_MAA/part")
        mesh.attrs.update({"DIM": np.int32(dim), "ESP": np.int32(dim), "TYP": np.int32(0)})
        step = mesh.create_group("-0000000000000000001-0000000000000000001") if steps else mesh
        step.create_dataset("NOE/COO", data=points.T.ravel())
        nodes = np.zeros(count, "i4") if node_families is None else np.asarray(node_families, "i4")
        step.create_dataset("NOE/FAM", data=nodes)
        for kind, (listed, of) in cells.items():
            listed = np.asarray(listed, "i4") + 1
            compressed = {"compression": "gzip"} if len(listed) > 20 else {}
            step.create_dataset(f"MAI/{kind}/NOD", data=listed.T.ravel(), **compressed)
            step.create_dataset(f"MAI/{kind}/FAM", data=np.asarray(of, "i4"))
        file.create_group("FAS/part/FAMILLE_ZERO").attrs["NUM"] = np.int32(0)
        for number, groups in families.items():
            where = "NOEUD" if number > 0 else "ELEME"
            family = file.create_group(f"FAS/part/{where}/FAM_{number}")
            family.attrs["NUM"] = np.int32(number)
            names = np.zeros((len(groups), 80), "i1")
            for row, group in zip(names, groups):
                row[: len(group)] = np.frombuffer(group.encode(), "i1")
            kind = h5py.h5t.array_create(h5py.h5t.NATIVE_INT8, (80,))
            space = h5py.h5s.create_simple((len(groups),))
            data = h5py.h5d.create(family.create_group("GRO").id, b"NOM", kind, space)
            data.write(space, space, names, kind)


def plate():
    """Quadrilaterals and triangles in two regions; a corner has a name, and the nodes of a side have."""
    points = [(0.5 * i, 0.25 * j) for j in range(3) for i in range(4)]
    n = lambda i, j: 4 * j + i
    quads = [(n(i, j), n(i + 1, j), n(i + 1, j + 1), n(i, j + 1)) for j in range(2) for i in range(2)]
    corners = [(n(2, j), n(3, j), n(3, j + 1), n(2, j + 1)) for j in range(2)]
    triangles = [t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))]
    lines = [(n(i, 0), n(i + 1, 0)) for i in range(3)] + [(n(i, 2), n(i + 1, 2)) for i in range(3)]
    lines += [(n(0, j), n(0, j + 1)) for j in range(2)]
    cells = {"QU4": (quads, [-1] * 4), "TR3": (triangles, [-2] * 4), "SE2": (lines, [-3] * 3 + [-4] * 3 + [-5] * 2)}
    families = {-1: ["steel"], -2: ["rubber"], -3: ["bottom"], -4: ["top", "free"], -5: ["left"], 1: ["corner", "right"]}
    nodes = [0] * 12
    nodes[n(3, 2)] = 1
    families[2] = ["right"]
    nodes[n(3, 0)] = nodes[n(3, 1)] = 2
    write("plate.med", points, cells, families, nodes)
    write("plate-2.med", points, cells, families, nodes, major=2, steps=False)


def brick():
    """Hexahedra with 20 nodes on a grid that is not aligned with the axes of its cells."""
    index, points = {}, []

    def node(*at):
        if at not in index:
            index[at] = len(points)
            x, y, z = (0.5 * c for c in at)
            points.append((2.0 * x + 0.3 * y, y - 0.2 * z, 0.5 * z + 0.1 * x))
        return index[at]

    corners = [(0, 0, 0), (0, 2, 0), (2, 2, 0), (2, 0, 0), (0, 0, 2), (0, 2, 2), (2, 2, 2), (2, 0, 2)]
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    local = corners + [tuple((a + b) // 2 for a, b in zip(corners[i], corners[j])) for i, j in edges]
    cells = []
    for at in itertools.product(range(2), range(2), range(1)):
        cells.append([node(*(2 * a + l for a, l in zip(at, place))) for place in local])
    face = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    bottom = [[node(2 * i + a, 2 * j + b, 0) for a, b in face] for i in range(2) for j in range(2)]
    cells = {"H20": (cells, [-1] * 4), "QU8": (bottom, [-2] * 4)}
    write("brick.med", points, cells, {-1: ["brick"], -2: ["below"]})


def mixed():
    """One tetrahedron of the second order, a prism and a pyramid of the first order, without groups of cells."""
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
    write("prism.med", points, {"PE6": ([[0, 2, 1, 3, 5, 4]], [0])}, {})
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
    write("pyramid.med", points, {"PY5": ([[0, 3, 2, 1, 4]], [0])}, {})
    corners = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (0, 0, 1)]
    edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    middle = [tuple((a + b) / 2 for a, b in zip(corners[i], corners[j])) for i, j in edges]
    write("tetrahedron.med", corners + middle, {"T10": ([list(range(10))], [0])}, {})


plate()
brick()
mixed()

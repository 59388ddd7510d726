"""Writes the Exodus files beside it with netCDF4, as the format describes them, and into `exodus.txt` what the reader of
VTK makes of those of single cells: `python exodus.py`, which needs the packages netCDF4 and vtk.
"""

import netCDF4
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOExodus import vtkExodusIIReader


def write(path, points, blocks, sides=(), nodes=(), form="NETCDF4", long=False, old=False):
    """Blocks, sides and nodes by (number, name, ...); classic files may have their coordinates in one array."""
    points = np.asarray(points, float)
    integer = "i8" if long else "i4"
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.setncatts({"api_version": np.float32(8.0), "version": np.float32(8.0), "floating_point_word_size": 8})
        file.setncatts({"file_size": 1, "title": "made for tests", "int64_status": 3 if long else 0})
        file.createDimension("len_name", 33)
        file.createDimension("time_step", None)
        file.createDimension("num_dim", points.shape[1])
        file.createDimension("num_nodes", points.shape[0])
        file.createDimension("num_elem", sum(len(listed) for *_, listed in blocks))
        file.createVariable("time_whole", "f8", ("time_step",))
        if old:
            file.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = points.T
        else:
            for axis, values in zip("xyz", points.T):
                file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values

        def sets(short, dimension, members):
            if not members:
                return
            file.createDimension(dimension, len(members))
            file.createVariable(f"{short}_status", "i4", (dimension,))[:] = 1
            numbers = file.createVariable(f"{short}_prop1", integer, (dimension,))
            numbers.setncattr("name", "ID")
            numbers[:] = [member[0] for member in members]
            if any(member[1] for member in members):
                text = np.zeros((len(members), 33), "S1")
                for row, member in zip(text, members):
                    row[: len(member[1])] = [c.encode() for c in member[1]]
                file.createVariable(f"{short}_names", "S1", (dimension, "len_name"))[:] = text

        sets("eb", "num_el_blk", blocks)
        for at, (*_, kind, listed) in enumerate(blocks, 1):
            listed = np.asarray(listed) + 1
            file.createDimension(f"num_el_in_blk{at}", listed.shape[0])
            file.createDimension(f"num_nod_per_el{at}", listed.shape[1])
            packed = {"zlib": True, "shuffle": True} if form == "NETCDF4" and len(listed) > 3 else {}
            connect = file.createVariable(f"connect{at}", integer, (f"num_el_in_blk{at}", f"num_nod_per_el{at}"), **packed)
            connect.elem_type = kind
            connect[:] = listed
        sets("ss", "num_side_sets", sides)
        for at, (*_, listed) in enumerate(sides, 1):
            file.createDimension(f"num_side_ss{at}", len(listed))
            for name, column in zip(("elem", "side"), np.asarray(listed).T):
                file.createVariable(f"{name}_ss{at}", integer, (f"num_side_ss{at}",))[:] = column
        sets("ns", "num_node_sets", nodes)
        for at, (*_, listed) in enumerate(nodes, 1):
            file.createDimension(f"num_nod_ns{at}", len(listed))
            file.createVariable(f"node_ns{at}", integer, (f"num_nod_ns{at}",))[:] = np.asarray(listed) + 1


def plate():
    """Quadrilaterals and triangles in two blocks; sets of sides, of nodes of a side and of one node."""
    points = [(0.5 * i, 0.25 * j) for j in range(3) for i in range(4)]
    n = lambda i, j: 4 * j + i
    quads = [(n(i, j), n(i + 1, j), n(i + 1, j + 1), n(i, j + 1)) for j in range(2) for i in range(2)]
    corners = [(n(2, j), n(3, j), n(3, j + 1), n(2, j + 1)) for j in range(2)]
    triangles = [t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))]
    blocks = [(1, "steel", "QUAD4", quads), (7, "", "TRI3", triangles)]
    sides = [(1, "bottom", [(1, 1), (2, 1), (5, 1)]), (3, "left", [(1, 4), (3, 4)]), (9, "", [(3, 3), (4, 3), (8, 2)])]
    nodes = [(1, "right", [n(3, j) for j in range(3)]), (2, "corner", [n(3, 2)]), (4, "", [n(1, 1)])]
    nodes.append((5, "left", [n(0, 0), n(0, 1), n(0, 2), n(1, 0)]))
    for form, long, old in [("NETCDF3_CLASSIC", False, True), ("NETCDF3_64BIT_OFFSET", False, False),
                            ("NETCDF3_64BIT_DATA", True, False), ("NETCDF4", False, False)]:
        name = form.removeprefix("NETCDF").replace("_", "-").lower()
        write(f"plate-{name}.e", points, blocks, sides, nodes, form, long, old)


# Corners of the cells in space, then the pairs, faces and the whole that the further nodes are the middle of.
CELLS = {
    "TETRA10": ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)], 4),
    "PYRAMID14": (
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 1), (1, 2), (2, 3), (0, 3), (0, 4), (1, 4), (2, 4), (3, 4), (0, 1, 2, 3)],
        5,
    ),
    "WEDGE18": (
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
        [(0, 1), (1, 2), (0, 2), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (3, 5), (0, 1, 4, 3), (1, 2, 5, 4), (0, 2, 5, 3)],
        5,
    ),
    "HEX27": (
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        [(0, 1), (1, 2), (2, 3), (0, 3), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (4, 7), tuple(range(8)),
         (0, 1, 2, 3), (4, 5, 6, 7), (0, 3, 4, 7), (1, 2, 5, 6), (0, 1, 4, 5), (2, 3, 6, 7)],
        6,
    ),
}


def single():
    """One cell of each type, with each side as a set of its own, and what VTK reads of it."""
    kinds = {"TETRA4": ("TETRA10", 4), "TETRA10": ("TETRA10", 10)}
    kinds |= {f"PYRAMID{nodes}": ("PYRAMID14", nodes) for nodes in (5, 13, 14)}
    kinds |= {"WEDGE6": ("WEDGE18", 6), "WEDGE15": ("WEDGE18", 15), "WEDGE18": ("WEDGE18", 18)}
    kinds |= {"HEX8": ("HEX27", 8), "HEX20": ("HEX27", 20)}
    kinds["HEX27"] = ("HEX27", 27)
    # Numbers that VTK, which keeps coordinates in single precision, does not round.
    shear = np.array([[2.0, 0.0, 0.125], [0.25, 1.0, 0.0], [0.0, -0.25, 0.5]])
    told = []
    for kind, (like, count) in kinds.items():
        corners, middle, faces = CELLS[like]
        corners = np.array(corners, float) @ shear
        points = np.array([*corners, *(corners[list(of)].mean(axis=0) for of in middle)])[:count]
        sides = [(at, f"side-{at}", [(1, at)]) for at in range(1, faces + 1)]
        path = f"{kind.lower()}.e"
        write(path, points, [(1, "cell", kind, [list(range(count))])], sides, form="NETCDF3_64BIT_OFFSET")
        reader = vtkExodusIIReader()
        reader.SetFileName(path)
        reader.UpdateInformation()
        for _, name, _ in sides:
            reader.SetSideSetArrayStatus(name, 1)
        reader.Update()
        cells, side_sets = reader.GetOutput().GetBlock(0), reader.GetOutput().GetBlock(4)
        told.append(f"cell {kind.lower()} {cells.GetBlock(0).GetCellType(0)}")
        told += [f"node {x:.17g} {y:.17g} {z:.17g}" for x, y, z in nodes_of(cells.GetBlock(0))]
        for at, (_, name, _) in enumerate(sides):
            nodes = nodes_of(side_sets.GetBlock(at))
            told.append(f"side {name} " + " ".join(f"{x:.17g}" for node in nodes for x in node))
    with open("exodus.txt", "w") as file:
        file.write("\n".join(told) + "\n")


def nodes_of(grid):
    """The coordinates of the nodes of the one cell of a grid, in the order of VTK."""
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    return [points[grid.GetCell(0).GetPointId(i)].tolist() for i in range(grid.GetCell(0).GetNumberOfPoints())]


if __name__ == "__main__":
    plate()
    single()

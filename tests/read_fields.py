"""Reads fields.pvd and contact.pvd with their .vtu files with another program, meshio, and with VTK's own reader where
it is installed, and compares them with summary.json, history.csv and contact.csv. Reads fields.vtkhdf with VTK's own
reader, and compares every bit with the .vtu files where these are there, too.

    python tests/read_fields.py RESULTS
"""

import csv
import json
import math
import pathlib
import sys
import tomllib
import xml.etree.ElementTree as xml

import meshio
import numpy as np


def close(name, found, expected, scale=None):
    scale = scale or max(1e-300, float(np.max(np.abs(expected))))
    error = float(np.max(np.abs(np.asarray(found) - np.asarray(expected)))) / scale
    if not error <= 1e-14:
        sys.exit(f"{name}: found {found}, expected {expected}, off by {error:.1e} of its scale")


def with_meshio(path):
    mesh = meshio.read(path)
    cells = {name: np.concatenate(blocks) for name, blocks in mesh.cell_data.items()}
    # meshio makes reals of unsigned numbers.
    connectivity = [block.data.astype(int) for block in mesh.cells]
    return mesh.points, connectivity, {block.type for block in mesh.cells}, mesh.point_data, cells


def with_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetErrorCode():
        sys.exit(f"{path}: VTK's reader reports error {reader.GetErrorCode()}")
    return of_grid(reader.GetOutput())


def of_grid(grid):
    """What VTK has read."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    def arrays(data):
        return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).copy() for i in range(data.GetNumberOfArrays())}

    types = {meshio._vtk_common.vtk_to_meshio_type[t] for t in {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}}
    all_nodes, ends = vtk_to_numpy(grid.GetCells().GetConnectivityArray()), vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    connectivity = np.split(all_nodes.copy(), ends[1:-1])
    connectivity = [np.array(connectivity)] if len(types) == 1 else [cell[None, :] for cell in connectivity]
    return vtk_to_numpy(grid.GetPoints().GetData()).copy(), connectivity, types, arrays(grid.GetPointData()), arrays(grid.GetCellData())


def packed(path):
    """The times of a file of VTKHDF, and what VTK reads at each of them."""
    import h5py
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    if times is None:
        # VTK takes one snapshot for one without a time.
        with h5py.File(path) as file:
            times = file["VTKHDF/Steps/Values"][:]
        assert len(times) == 1, f"{path}: VTK finds none of the times {times}"
    grids = []
    for t in times:
        if not reader.UpdateTimeStep(t) or reader.GetErrorCode():
            sys.exit(f"{path}: VTK's reader reports error {reader.GetErrorCode()} at t = {t}")
        grids.append(of_grid(reader.GetOutput()))
    return list(times), grids


def same_bits(name, found, expected):
    if found.dtype != expected.dtype or found.shape != expected.shape or found.tobytes() != expected.tobytes():
        sys.exit(f"{name}: {found.dtype}{found.shape} in fields.vtkhdf is not {expected.dtype}{expected.shape} of the .vtu file")


def check_packed(folder, times, grids, sets):
    """A file of VTKHDF against the .vtu files of the same run, and its layout."""
    import h5py

    for t, grid, (other, path) in zip(times, grids, sets, strict=True):
        points, connectivity, types, at_points, in_cells = with_vtk(path)
        assert (t, grid[2]) == (other, types), f"times and types of cells: {t}, {grid[2]}, {other}, {types}"
        same_bits(f"points at t = {t}", grid[0], points)
        for found, expected in zip(grid[1], connectivity, strict=True):
            same_bits(f"cells at t = {t}", found, expected)
        for found, expected in ((grid[3], at_points), (grid[4], in_cells)):
            assert sorted(found) == sorted(expected), f"{path}: arrays {sorted(found)}, expected {sorted(expected)}"
            for name, array in expected.items():
                same_bits(f"{name} at t = {t}", found[name], array)
    manifest = json.loads((folder / "manifest.json").read_text())
    with h5py.File(folder / "fields.vtkhdf") as file:
        root = file["VTKHDF"]
        assert list(root.attrs["Version"]) == [2, 0] and root.attrs["Type"] == b"UnstructuredGrid"
        assert len(root["Points"]) == len(grids[0][0]), "the mesh is there once"
        assert len(root["CellData/region"]) == len(root["Types"]), "and so is what does not change"
        for group in ("PointData", "CellData"):
            for name, array in root[group].items():
                unit = array.attrs["units"].decode() if "units" in array.attrs else None
                assert unit == manifest["columns"]["fields.vtkhdf"].get(name), f"unit of {name}: {unit}"
                assert array.compression == "gzip", f"{name} is not compressed"


def von_mises(stress):
    xx, yy, zz, xy, yz, zx = stress.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + zx**2))


def tensors(six):
    xx, yy, zz, xy, yz, zx = six.T
    return np.stack([np.stack([xx, xy, zx], axis=1), np.stack([xy, yy, yz], axis=1), np.stack([zx, yz, zz], axis=1)], axis=1)


def check_fields(path, fields, at_points, in_cells):
    """What a file has beside the fields of every file, and how it fits the stress."""
    of_points = {"nodal-stress": ["nodal_stress"]}
    directions = [f"principal_direction_{c}" for c in (1, 2, 3)]
    of_cells = {"stress": ["stress"], "strain": ["strain"], "principal": ["principal", *directions], "heat-flux": ["heat_flux"]}
    expected = [
        sorted([*always, *(name for field in fields for name in names.get(field, []))])
        for always, names in ((["displacement", "nodal_von_mises", "temperature", "velocity"], of_points), (["region", "von_mises"], of_cells))
    ]
    if [sorted(at_points), sorted(in_cells)] != expected:
        sys.exit(f"{path}: found {sorted(at_points)} and {sorted(in_cells)}, expected {expected[0]} and {expected[1]}")
    if "principal" in fields and "stress" in fields:
        axes = np.stack([in_cells[name] for name in directions], axis=1)
        close("lengths and angles of directions", axes @ axes.transpose(0, 2, 1), np.broadcast_to(np.eye(3), axes.shape))
        close("stress of its principal axes", np.einsum("nc,nci,ncj->nij", in_cells["principal"], axes, axes), tensors(in_cells["stress"]))
    if "nodal-stress" in fields:
        close("von Mises stress at nodes", von_mises(at_points["nodal_stress"]), at_points["nodal_von_mises"])
    if "strain" in fields:
        assert in_cells["strain"].shape == in_cells["stress"].shape, "strains have six components"


def check_last(read, path, summary, fields):
    points, connectivity, types, at_points, in_cells = read(path)
    end, dim = summary["final"], summary["dimension"]
    check_fields(path, fields, at_points, in_cells)
    u, w, theta = at_points["displacement"], at_points["velocity"], at_points["temperature"]
    assert points.shape == u.shape == w.shape == (len(theta), 3), "vectors have three components"
    cells = sum(len(block) for block in connectivity)
    assert in_cells["stress"].shape == (cells, 6), "stresses have six components"
    assert min(block.min() for block in connectivity) == 0 and max(block.max() for block in connectivity) == len(points) - 1
    close("displacement_min", u.min(axis=0)[:dim], end["displacement_min"])
    close("displacement_max", u.max(axis=0)[:dim], end["displacement_max"])
    close("velocity_max", w.max(axis=0)[:dim], end["velocity_max"])
    close("temperature_min", theta.min(), end["temperature_min"], scale=1.0)
    close("temperature_max", theta.max(), end["temperature_max"])
    close("von_mises_max", in_cells["von_mises"].max(), end["von_mises_max"])
    close("von Mises stress of the stress", von_mises(in_cells["stress"]), in_cells["von_mises"])
    assert not u[:, dim:].any() and not w[:, dim:].any(), "no components beyond the dimension"
    if types in ({"triangle"}, {"tetra"}):
        # On linear simplices, from the coordinates alone: the gradient of u, and the norm of V.
        nodes = connectivity[0]
        edges = np.stack([points[nodes[:, i], :dim] - points[nodes[:, 0], :dim] for i in range(1, dim + 1)], axis=1)
        steps = np.stack([u[nodes[:, i], :dim] - u[nodes[:, 0], :dim] for i in range(1, dim + 1)], axis=1)
        gradient = np.linalg.solve(edges, steps)
        strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
        measure = np.linalg.det(edges) / math.factorial(dim)
        assert measure.min() > 0, "cells are oriented"
        norm = math.sqrt(float(np.sum(measure * np.sum(strain**2, axis=(1, 2)))))
        error = abs(norm - end["norms"]["displacement_v"]) / norm
        assert error < 1e-12, f"displacement_v is off by {error:.1e}"
        if "strain" in fields:
            close("strain", tensors(in_cells["strain"])[:, :dim, :dim], strain)
    return sorted(types)


def check_contact(read, path, table, manifest):
    """The sides of contact against the table of the contact points."""
    points, connectivity, _, at_points, in_cells = read(path)
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    numbers = {name: np.array([float(row[name] or 0.0) for row in rows]) for name in rows[0] if name not in ("node", "status", "side")}
    on_sides = {}
    for number, cell in zip(in_cells["side"], (cell for block in connectivity for cell in block)):
        on_sides.setdefault(int(number), set()).update(int(node) for node in cell)
    assert sorted(on_sides) == list(range(len(manifest["sides"]))), f"{path}: sides {sorted(on_sides)}"
    for number, nodes in on_sides.items():
        nodes, name = sorted(nodes), manifest["sides"][number]
        own = [i for i, row in enumerate(rows) if row["side"] == name]
        if not own:
            # The side that faces another one: what acts on this acts back on it.
            continue
        weight = at_points["weight"][nodes]
        close(f"area of {name}", weight.sum(), numbers["weight"][own].sum())
        close(f"force on {name}", (weight * at_points["pressure"][nodes]).sum(), (numbers["weight"] * numbers["pressure"])[own].sum())
        if len(own) == len(nodes):
            place = {tuple(points[node]): node for node in nodes}
            at = [place[tuple(float(rows[i].get(axis) or 0.0) for axis in "xyz")] for i in own]
            for column, array in (("pressure", "pressure"), ("temperature", "temperature"), ("heat_flux", "heat_flux"), ("wear", "wear")):
                if array in at_points and numbers[column][own].any():
                    close(f"{column} on {name}", at_points[array][at], numbers[column][own])
            close(f"gap on {name}", at_points["gap"][at], -numbers["penetration"][own])
            words = ["open", "stick", "slip"]
            assert [words[int(code)] for code in at_points["status"][at]] == [rows[i]["status"] for i in own], f"status on {name}"


def main(folder):
    summary = json.loads((folder / "summary.json").read_text())
    fields = tomllib.loads((folder / "case.toml").read_text()).get("output", {}).get("fields", ["stress"])
    sets, (packed_times, grids) = [], ([], [])
    if (folder / "fields.pvd").exists():
        collection = xml.parse(folder / "fields.pvd").getroot()
        assert collection.tag == "VTKFile" and collection.get("type") == "Collection"
        sets = [(float(entry.get("timestep")), folder / entry.get("file")) for entry in collection.iter("DataSet")]
    if (folder / "fields.vtkhdf").exists():
        packed_times, grids = packed(folder / "fields.vtkhdf")
        assert sets or not (folder / "fields").exists(), "without fields.pvd there are no files in fields"
    times = [t for t, _ in sets] or packed_times
    with open(folder / "history.csv", newline="") as file:
        known = [0.0] + [float(row["t"]) for row in csv.DictReader(file)]
    assert times == sorted(set(times)) and set(times) <= set(known), f"times of steps, ascending: {times}"
    assert times[-1] == summary["time"]
    readers = [with_meshio]
    try:
        import vtkmodules.vtkIOXML  # noqa: F401
        readers.append(with_vtk)
    except ImportError:
        pass
    for read in readers if sets else []:
        for _, path in sets:
            read(path)
        types = check_last(read, sets[-1][1], summary, fields)
    if grids:
        types = check_last(lambda _: grids[-1], folder / "fields.vtkhdf", summary, fields)
        if sets:
            check_packed(folder, packed_times, grids, sets)
        against = ", as the .vtu files to the bit" if sets else ""
        print(f"{len(grids)} snapshots of fields.vtkhdf read by VTK, as summary.json says{against}")
    surfaces = folder / "contact.pvd"
    if surfaces.exists():
        manifest = json.loads((folder / "manifest.json").read_text())
        files = [folder / entry.get("file") for entry in xml.parse(surfaces).getroot().iter("DataSet")]
        for read in readers:
            for path in files:
                check_contact(read, path, path.with_suffix(".csv"), manifest)
        print(f"{len(files)} files of contact, as contact/*.csv says")
    if sets:
        print(f"{len(sets)} files of fields with cells {', '.join(types)} read by {' and '.join(r.__name__.removeprefix('with_') for r in readers)}, as summary.json says")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))

"""Reads fields.pvd and its .vtu files with another program, meshio, and with VTK's own reader where it is
installed, and compares them with summary.json and history.csv.

    python tests/read_fields.py RESULTS
"""

import csv
import json
import math
import pathlib
import sys
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
    connectivity = np.concatenate([block.data for block in mesh.cells]).astype(int)
    return mesh.points, connectivity, mesh.point_data, cells


def with_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetErrorCode():
        sys.exit(f"{path}: VTK's reader reports error {reader.GetErrorCode()}")
    grid = reader.GetOutput()

    def arrays(data):
        return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(grid.GetNumberOfCells(), -1)
    return vtk_to_numpy(grid.GetPoints().GetData()), connectivity, arrays(grid.GetPointData()), arrays(grid.GetCellData())


def von_mises(stress):
    xx, yy, zz, xy, yz, zx = stress.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + zx**2))


def check_last(read, path, summary):
    points, connectivity, at_points, in_cells = read(path)
    end, dim = summary["final"], summary["dimension"]
    if sorted(at_points) != ["displacement", "temperature", "velocity"] or sorted(in_cells) != ["region", "stress", "von_mises"]:
        sys.exit(f"{path}: found {sorted(at_points)} and {sorted(in_cells)}")
    u, w, theta = at_points["displacement"], at_points["velocity"], at_points["temperature"]
    assert points.shape == u.shape == w.shape == (len(theta), 3), "vectors have three components"
    assert in_cells["stress"].shape == (len(connectivity), 6), "stresses have six components"
    assert connectivity.min() == 0 and connectivity.max() == len(points) - 1
    close("displacement_min", u.min(axis=0)[:dim], end["displacement_min"])
    close("displacement_max", u.max(axis=0)[:dim], end["displacement_max"])
    close("velocity_max", w.max(axis=0)[:dim], end["velocity_max"])
    close("temperature_min", theta.min(), end["temperature_min"], scale=1.0)
    close("temperature_max", theta.max(), end["temperature_max"])
    close("von_mises_max", in_cells["von_mises"].max(), end["von_mises_max"])
    close("von Mises stress of the stress", von_mises(in_cells["stress"]), in_cells["von_mises"])
    assert not u[:, dim:].any() and not w[:, dim:].any(), "no components beyond the dimension"
    if connectivity.shape[1] == 3:
        # On linear triangles, from the coordinates alone: the gradient of u, and the norm of V.
        a, b, c = (points[connectivity[:, i], :2] for i in range(3))
        edges = np.stack([b - a, c - a], axis=1)
        steps = np.stack([u[connectivity[:, 1]] - u[connectivity[:, 0]], u[connectivity[:, 2]] - u[connectivity[:, 0]]], axis=1)[:, :, :2]
        gradient = np.linalg.solve(edges, steps)
        strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
        area = 0.5 * np.linalg.det(edges)
        norm = math.sqrt(float(np.sum(area * np.sum(strain**2, axis=(1, 2)))))
        error = abs(norm - end["norms"]["displacement_v"]) / norm
        assert error < 1e-12, f"displacement_v is off by {error:.1e}"


def main(folder):
    summary = json.loads((folder / "summary.json").read_text())
    collection = xml.parse(folder / "fields.pvd").getroot()
    assert collection.tag == "VTKFile" and collection.get("type") == "Collection"
    sets = [(float(entry.get("timestep")), folder / entry.get("file")) for entry in collection.iter("DataSet")]
    times = [t for t, _ in sets]
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
    for read in readers:
        for _, path in sets:
            read(path)
        check_last(read, sets[-1][1], summary)
    print(f"{len(sets)} files of fields read by {' and '.join(r.__name__.removeprefix('with_') for r in readers)}, as summary.json says")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))

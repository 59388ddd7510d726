"""The mesh of the paper's square for GetFEM: n × n squares, each cut from lower left to upper right."""

import getfem as gf
import numpy as np

BOTTOM, TOP, SIDES = 1, 2, (3, 4)


def square(n):
    x, y = np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n)
    points = np.stack([x.ravel(), y.ravel()])
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    b, c, d = a + 1, a + n + 1, a + n + 2
    cells = np.concatenate([np.column_stack(t) for t in ((a, b, d), (a, d, c))])
    mesh = gf.Mesh("empty", 2)
    mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), points[:, cells.T].reshape(2, 3, -1))
    faces, pts = mesh.outer_faces(), mesh.pts()
    for region, (axis, value) in zip((BOTTOM, TOP, *SIDES), ((1, 0.0), (1, 1.0), (0, 0.0), (0, 1.0))):
        on = np.abs(pts[axis] - value) < 1e-9
        mesh.set_region(region, mesh.faces_from_pid(np.flatnonzero(on)))
        both = mesh.region(region)
        outer = {tuple(f) for f in faces.T}
        keep = np.array([f for f in both.T if tuple(f) in outer]).T
        mesh.delete_region(region)
        mesh.set_region(region, keep)
    return mesh

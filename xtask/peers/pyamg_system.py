"""Solves one linear system with pyamg: python pyamg_system.py FOLDER, which `xtask bench --peer pyamg` has filled.

Smoothed aggregation with rigid-body modes and blocks of 3 × 3, conjugate gradients to a residual of 1e-10; prints what it
took as JSON.
"""

import json
import resource
import sys
import time
from pathlib import Path

import numpy as np
import pyamg
from scipy.sparse import bsr_matrix

folder = Path(sys.argv[1])
starts, columns = (np.fromfile(folder / name, np.int32) for name in ("starts", "columns"))
blocks, right, points = (np.fromfile(folder / name, np.float64) for name in ("blocks", "right", "points"))
points = points.reshape(-1, 3)
matrix = bsr_matrix((blocks.reshape(-1, 3, 3), columns, starts))

modes = np.zeros((len(points), 3, 6))
modes[:, [0, 1, 2], [0, 1, 2]] = 1.0
x, y, z = points.T
modes[:, 0, 3], modes[:, 1, 3] = -y, x
modes[:, 1, 4], modes[:, 2, 4] = -z, y
modes[:, 2, 5], modes[:, 0, 5] = -x, z

begin = time.perf_counter()
levels = pyamg.smoothed_aggregation_solver(matrix, B=modes.reshape(-1, 6))
made = time.perf_counter()
residuals = []
solution = levels.solve(right, tol=1e-10, accel="cg", residuals=residuals)
solved = time.perf_counter()
left = np.linalg.norm(right - matrix @ solution) / np.linalg.norm(right)
peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({"setup": made - begin, "solve": solved - made, "iterations": len(residuals) - 1, "left": left,
                  "peak_memory_bytes": peak, "version": pyamg.__version__}))

"""Writes `pyramid13.vtu` with VTK, whose edges say which nodes their middles are: `python vtk_cells.py`."""

import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_PYRAMID, vtkQuadraticPyramid, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

points = np.full((13, 3), np.nan)
shear = np.array([[2.0, 0.0, 0.125], [0.25, 1.0, 0.0], [0.0, -0.25, 0.5]])
points[:5] = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)], float) @ shear
cell = vtkQuadraticPyramid()
for i in range(13):
    cell.GetPointIds().SetId(i, i)
for i in range(cell.GetNumberOfEdges()):
    first, last, middle = (cell.GetEdge(i).GetPointId(k) for k in range(3))
    points[middle] = points[[first, last]].mean(axis=0)

places, grid, writer = vtkPoints(), vtkUnstructuredGrid(), vtkXMLUnstructuredGridWriter()
places.SetDataTypeToDouble()
for point in points:
    places.InsertNextPoint(point)
grid.SetPoints(places)
grid.InsertNextCell(VTK_QUADRATIC_PYRAMID, 13, list(range(13)))
writer.SetFileName("pyramid13.vtu")
writer.SetInputData(grid)
writer.SetDataModeToAscii()
writer.Write()

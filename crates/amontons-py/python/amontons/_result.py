"""What a run came to."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Optional

import numpy as np

from . import _amontons
from ._errors import RequestError
from ._optional import package, pandas

if TYPE_CHECKING:
    import pandas as pd
    import pyvista as pv

_COUNTS = ("step", "open", "stick", "slip", "newton_mechanics", "newton_heat", "passes", "parts")


def _frame(columns: list[str], values: np.ndarray, purpose: str) -> pd.DataFrame:
    """A table of numbers as a frame: counts as integers."""
    frame = pandas(purpose).DataFrame(values, columns=columns)
    counts = {name: "int64" for name in columns if name.partition("@")[0] in _COUNTS}
    return frame.astype(counts)


class Fields(Mapping[str, np.ndarray]):
    """The fields of a snapshot by name, as arrays that cannot be written to.

    | field | shape | measures |
    |---|---|---|
    | `displacement`, `velocity` | nodes × d | u, w |
    | `temperature` | nodes | θ |
    | `stress`, `strain` | cells × 6 | components xx yy zz xy yz zx at the centres |
    | `von_mises` | cells | von Mises stress at the centres |
    | `heat_flux` | cells × 3 | q at the centres |
    """

    def __init__(self, snapshot: _amontons.Snapshot) -> None:
        self._snapshot = snapshot

    def __getitem__(self, name: str) -> np.ndarray:
        return self._snapshot.field(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._snapshot.field_names)

    def __len__(self) -> int:
        return len(self._snapshot.field_names)

    def __repr__(self) -> str:
        return f"<amontons.Fields {', '.join(self)}>"


class Snapshot:
    """A run at one time."""

    def __init__(self, snapshot: _amontons.Snapshot) -> None:
        self._snapshot = snapshot

    @property
    def step(self) -> int:
        """Number of the step, n."""
        return self._snapshot.step

    @property
    def t(self) -> float:
        """Time t_n in s."""
        return self._snapshot.t

    @property
    def fields(self) -> Fields:
        """The fields of the body."""
        return Fields(self._snapshot)

    @property
    def history(self) -> dict[str, float]:
        """The row of the step in the history, by column; empty at t = 0."""
        return self._snapshot.history_row()

    @property
    def contact(self) -> pd.DataFrame:
        """The contact points, a row each, with the columns of `contact.csv`; no rows at t = 0."""
        pd = pandas("a table of contact points")
        frame = pd.DataFrame(self._snapshot.contact_columns())
        return frame.astype({"node": "int64"}) if "node" in frame else frame

    def __repr__(self) -> str:
        return f"<amontons.Snapshot, step {self.step}, t = {self.t:g}>"


class Cells(NamedTuple):
    """Cells of one element and one region."""

    element: str
    """Name of the element."""
    vtk: int
    """Its cell type in VTK; a quadratic pyramid of VTK, type 27, has the first 13 of the 14 nodes."""
    region: str
    """Name of the region."""
    nodes: np.ndarray
    """The nodes of each cell, a row per cell."""


class Mesh:
    """The mesh of a run."""

    def __init__(self, run: _amontons.Run) -> None:
        self._run = run

    @property
    def dimension(self) -> int:
        """Dimension d of the body."""
        return self._run.dimension

    @property
    def points(self) -> np.ndarray:
        """Coordinates of the nodes in m, three per node."""
        return self._run.points

    @property
    def cells(self) -> list[Cells]:
        """The cells by element and region, in the order of the fields of cells."""
        return [Cells(*block) for block in self._run.blocks()]

    @property
    def sides(self) -> dict[str, np.ndarray]:
        """The nodes of each named side, ascending."""
        return {name: np.asarray(nodes) for name, nodes in self._run.sides()}

    def __repr__(self) -> str:
        cells = sum(len(block.nodes) for block in self.cells)
        return f"<amontons.Mesh, {len(self.points)} nodes, {cells} cells, d = {self.dimension}>"


class Picture:
    """A picture, which notebooks show."""

    def __init__(self, svg: str, png: bytes) -> None:
        self.svg = svg
        """The picture as SVG."""
        self.png = png
        """The picture as PNG."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture; the name ends with .svg or .png."""
        name = os.fspath(path)
        if name.endswith(".svg"):
            data = self.svg.encode()
        elif name.endswith(".png"):
            data = self.png
        else:
            raise RequestError(f"found the file name {name!r}, expected one that ends with .svg or .png")
        with open(name, "wb") as file:
            file.write(data)

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        return f"<amontons.Picture, {len(self.png)} bytes as PNG>"


class Result:
    """What a run came to. Tables and arrays are made when they are asked for."""

    def __init__(self, run: _amontons.Run, folder: Optional[str] = None) -> None:
        self._run = run
        self.folder = folder
        """The results folder; None for a run without one."""
        self.summary: dict[str, Any] = json.loads(run.summary_json or "{}")
        """`summary.json` as a dict."""
        self.notes: list[str] = run.notes
        """What the writers of the results folder have to say."""

    @property
    def outcome(self) -> str:
        """`done`, `interrupted`, `not converged` or `unsound`."""
        return self.summary.get("outcome", "interrupted")

    @property
    def findings(self) -> list[dict[str, Any]]:
        """The findings of the certificate: id, status, value, needed, message, where."""
        return self.summary.get("findings", [])

    @property
    def history(self) -> pd.DataFrame:
        """A row per step, with the columns of `history.csv`."""
        return _frame(*self._run.history_table, "a table of the history")

    @property
    def probes(self) -> pd.DataFrame:
        """A row per step, with the columns of `probes.csv`; no rows in a case without probes."""
        return _frame(*self._run.probes_table, "a table of the probes")

    @property
    def snapshots(self) -> list[Snapshot]:
        """The run at the times that `output.every` asks for, and at its end."""
        return [Snapshot(snapshot) for snapshot in self._run.snapshots]

    @property
    def contact(self) -> pd.DataFrame:
        """The contact points of all snapshots: `step`, `t` and the columns of `contact.csv`."""
        pd = pandas("a table of contact points")
        frames = []
        for snapshot in self.snapshots:
            frame = snapshot.contact
            if len(frame):
                frame.insert(0, "t", snapshot.t)
                frame.insert(0, "step", snapshot.step)
                frames.append(frame)
        return pd.concat(frames, ignore_index=True) if frames else pd.DataFrame()

    @property
    def fields(self) -> Fields:
        """The fields at the end of the run."""
        return self._last().fields

    @property
    def mesh(self) -> Mesh:
        """The mesh."""
        return Mesh(self._run)

    def _last(self) -> Snapshot:
        snapshots = self.snapshots
        if not snapshots:
            raise RequestError("the run ended before its first step and has no fields")
        return snapshots[-1]

    def _chosen(self, snapshot: int) -> Snapshot:
        snapshots = self.snapshots
        try:
            return snapshots[snapshot]
        except IndexError:
            raise RequestError(f"found the snapshot {snapshot}, expected one of {len(snapshots)}") from None

    def picture(self, kind: str = "deformed", snapshot: int = -1, pixels: float = 2.0) -> Picture:
        """Draws `deformed`, `temperature`, `von-mises`, `contact`, `wear` or `history`, as `amontons plot` does.

        `snapshot` is the index of the snapshot, `pixels` the pixels of the PNG per 1/96 inch.
        """
        if not pixels > 0:
            raise RequestError(f"pixels: found {pixels}, expected a positive number")
        return Picture(*_amontons.picture(self._run, self._chosen(snapshot)._snapshot, kind, pixels))

    def to_pyvista(self, snapshot: int = -1) -> pv.UnstructuredGrid:
        """The body at a snapshot with its fields as a grid of PyVista; vectors have three components."""
        pv = package("pyvista", "to_pyvista()", "pyvista")
        chosen, cells, types = self._chosen(snapshot), [], []
        for block in self.mesh.cells:
            # A quadratic pyramid of VTK has no node in the middle of its base, the last one here.
            nodes = block.nodes[:, :13] if block.vtk == 27 else block.nodes
            count, size = nodes.shape
            cells.append(np.hstack([np.full((count, 1), size, dtype=np.int64), nodes]).ravel())
            types.append(np.full(count, block.vtk, dtype=np.uint8))
        grid = pv.UnstructuredGrid(np.concatenate(cells), np.concatenate(types), np.array(self.mesh.points))
        for name, values in chosen.fields.items():
            if name in ("displacement", "velocity"):
                values = np.pad(values, ((0, 0), (0, 3 - values.shape[1])))
            data = grid.point_data if name in ("displacement", "velocity", "temperature") else grid.cell_data
            data[name] = np.array(values)
        return grid

    def __repr__(self) -> str:
        summary = self.summary
        name, steps, time = summary.get("case", "?"), summary.get("steps", 0), summary.get("time", 0.0)
        return f"<amontons.Result {name!r}, {self.outcome}, {steps} steps, t = {time:g}>"

    def _repr_html_(self) -> str:
        final = self.summary.get("final", {})
        contact = final.get("contact") or {}
        rows = [
            ("outcome", self.outcome),
            ("steps", self.summary.get("steps")),
            ("time", self.summary.get("time")),
            ("largest temperature", final.get("temperature_max")),
            ("largest von Mises stress", final.get("von_mises_max")),
            ("contact force", contact.get("force")),
            ("largest contact pressure", contact.get("pressure_max")),
            ("heat flow through the contact", contact.get("heat_flow")),
            ("open, stick, slip", [contact.get(name) for name in ("open", "stick", "slip")] if contact else None),
            ("energy identity, relative error", self.summary.get("energy", {}).get("closing_error")),
        ]
        rows += [(f"{f['id']}: {f['status']}", f["message"]) for f in self.findings if f["status"] == "fails"]
        cells = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
            f"<td style='text-align:left'>{html.escape(_shown(value))}</td></tr>"
            for name, value in rows
            if value is not None
        )
        return f"<h4>{html.escape(str(self.summary.get('case', '')))}</h4><table>{cells}</table>{self._svg()}"

    def _svg(self) -> str:
        """The deformed body; nothing for one that has no picture."""
        try:
            return self.picture("deformed", pixels=0.1).svg
        except RequestError:
            return ""


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_shown, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)

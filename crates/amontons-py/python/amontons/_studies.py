"""Runs, checks, convergence studies and verifications."""

from __future__ import annotations

import html
import json
import os
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

from . import _amontons
from ._case import Case, CaseLike, Overrides
from ._errors import Interrupted, RequestError, RunError
from ._laws import Laws, describe
from ._optional import pandas
from ._result import Result, Snapshot, _shown

if TYPE_CHECKING:
    import pandas as pd

Callback = Callable[[Snapshot], Optional[bool]]


class _Request:
    """Arguments as the compiled part reads them."""

    def __init__(self, **arguments: Any) -> None:
        self.__dict__.update(arguments)


def _threads(threads: Optional[int]) -> Optional[int]:
    if threads is not None and not (isinstance(threads, int) and threads > 0):
        raise RequestError(f"threads: found {threads!r}, expected a positive number, or None for all cores")
    return threads


def run(
    case: CaseLike,
    overrides: Optional[Overrides] = None,
    *,
    out: Optional[Union[str, os.PathLike[str]]] = None,
    force: bool = False,
    threads: Optional[int] = None,
    certificate: Optional[bool] = None,
    callback: Optional[Callback] = None,
    laws: Optional[Laws] = None,
    **keywords: Any,
) -> Result:
    """Solves a case.

    `case` is a path, the text of a case file, a dict, or a `Case`; `overrides` and keywords change single keys
    (`mesh__n=32` for `mesh.n`). Results stay in memory; `out` names a folder that gets the usual files as well, those
    of an earlier run being replaced only with `force`. Results do not depend on `threads`. `certificate=False` leaves
    out the hypotheses that take factorizations, `True` evaluates them, and without it they are evaluated where that is at
    most about a tenth of the run.

    `callback(snapshot)` is called after each step by the thread that called `run`; if it returns `False` the run stops,
    and an exception in it ends the run. Ctrl-C ends the run by `Interrupted`, which has the result up to then.

    `laws` puts laws of your own in the place of those of the case: `{"friction": law}`, or of single sides or regions
    `{"friction": {"bottom": law}}`.

    Raises `CaseError` for faults of the case and `RunError` if the run does not reach its end.
    """
    made = Case(case, overrides, **keywords)
    described = describe(laws)
    if described and out is not None:
        raise RequestError(
            "out: found a results folder for a run with laws in Python, which its case file cannot name; "
            "expected none: keep the result, or save its pictures and grids"
        )
    if callback is not None and not callable(callback):
        raise TypeError(f"callback: found {type(callback).__name__}, expected a function of a snapshot")
    folder = None if out is None else os.fspath(out)
    request = _Request(
        out=folder,
        force=force,
        threads=_threads(threads),
        certificate=certificate,
        callback=None if callback is None else lambda snapshot: callback(Snapshot(snapshot)),
        laws=described,
    )
    done = _amontons.run(made._checked, request)
    result = Result(done, folder)
    error = done.take_error()
    if error is None:
        return result
    if type(error) is KeyboardInterrupt:
        steps = result.summary.get("steps")
        error = Interrupted("interrupted before a step was made" if steps is None else f"interrupted after step {steps}")
    if isinstance(error, (RunError, Interrupted)) and result.summary:
        error.result = result
    raise error


class Check:
    """What `check` finds: the certificate and the size of the model."""

    def __init__(self, report: dict[str, Any]) -> None:
        self.report = report
        """All of it, as `amontons check --format json` prints it."""

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Hypotheses and conditions: id, status, value, needed, message, where."""
        return self.report["findings"]

    @property
    def holds(self) -> bool:
        """Whether none of them fails."""
        return all(finding["status"] != "fails" for finding in self.findings)

    @property
    def constants(self) -> dict[str, Any]:
        """The constants of the theory by their names."""
        return self.report["constants"]

    @property
    def skipped(self) -> list[dict[str, Any]]:
        """What the mesh file has besides the mesh: what, count, line, and file if it is an included one."""
        return self.report["skipped"]

    @property
    def model(self) -> dict[str, Any]:
        """Sizes, time scales and cost of the model."""
        return self.report["model"]

    @property
    def table(self) -> pd.DataFrame:
        """The findings as a frame."""
        return pandas("a table of findings").DataFrame(self.findings)

    def __repr__(self) -> str:
        failing = [finding["id"] for finding in self.findings if finding["status"] == "fails"]
        return f"<amontons.Check {self.report['case']!r}, {', '.join(failing) + ' fail' if failing else 'nothing fails'}>"

    def _repr_html_(self) -> str:
        return _html(["id", "status", "value", "needed", "message"], self.findings)


def _html(columns: list[str], rows: list[dict[str, Any]]) -> str:
    def cell(value: Any) -> str:
        return "<td style='text-align:left'>" + html.escape("" if value is None else _shown(value)) + "</td>"

    head = "".join(f"<th style='text-align:left'>{html.escape(column)}</th>" for column in columns)
    body = "".join("<tr>" + "".join(cell(row.get(column)) for column in columns) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def check(
    case: CaseLike, overrides: Optional[Overrides] = None, *, laws: Optional[Laws] = None, **keywords: Any
) -> Check:
    """Reads and checks a case and evaluates the hypotheses of the theory with numbers; solves nothing."""
    made = Case(case, overrides, **keywords)
    return Check(json.loads(_amontons.check(made._checked, describe(laws))))


class Study:
    """A convergence study (5.2)."""

    def __init__(self, table: dict[str, Any]) -> None:
        self.rows: list[dict[str, Any]] = table["rows"]
        """A dict per level: level, h, k, error_w, error_u, error_theta, error_u_h, error, time_of_error, order."""
        self.slopes: dict[str, float] = {name: slope for name, slope in table["slopes"]}
        """Least-squares orders by name of the error."""
        self.values: dict[str, list[dict[str, Any]]] = {row["name"]: row["levels"] for row in table.get("values", [])}
        """Probes, resultants and energies at the end: by name a dict per level, the reference last, with level, h, k,
        value, and from this level and those before order, limit and its error (None if there is none) and remark."""

    @property
    def values_table(self) -> pd.DataFrame:
        """The numbers at the end as a frame: quantity, level, h, k, value, order, limit, error, remark."""
        rows = [{"quantity": name, **level} for name, levels in self.values.items() for level in levels]
        return pandas("a table of a study").DataFrame(rows)

    @property
    def table(self) -> pd.DataFrame:
        """The rows as a frame, coarsest level first."""
        return pandas("a table of a study").DataFrame(self.rows)

    def __repr__(self) -> str:
        return f"<amontons.Study, levels {', '.join(str(row['level']) for row in self.rows)}>"

    def _repr_html_(self) -> str:
        return _html(["level", "h", "k", "error_w", "error_u", "error_theta", "error", "order"], self.rows)


def converge(
    case: CaseLike,
    levels: list[int],
    overrides: Optional[Overrides] = None,
    *,
    reference: Union[int, str, None] = None,
    vary: str = "both",
    out: Optional[Union[str, os.PathLike[str]]] = None,
    force: bool = False,
    threads: Optional[int] = None,
    **keywords: Any,
) -> Study:
    """Solves a case on several levels and compares them with a reference.

    `levels` are cells per side, coarsest first (steps with `vary="time"`). `reference` is a finer level, `"exact"` for
    the `[exact]` of the case, or None for the finest of the levels. `vary` is `both`, `space` or `time`.
    """
    made = Case(case, overrides, **keywords)
    if isinstance(reference, str) and reference != "exact":
        raise RequestError(f'reference: found {reference!r}, expected a level or "exact"')
    if not all(isinstance(level, int) and level > 0 for level in levels):
        raise RequestError(f"levels: found {levels!r}, expected positive whole numbers")
    request = _Request(
        levels=list(levels),
        reference=None if isinstance(reference, str) else reference,
        exact=reference == "exact",
        vary=vary,
        out=None if out is None else os.fspath(out),
        force=force,
        threads=_threads(threads),
    )
    return Study(json.loads(_amontons.converge(made._checked, request)))


class Verification:
    """Computed values beside their references."""

    def __init__(self, verdicts: list[dict[str, Any]], faults: list[str], unchecked: list[str]) -> None:
        self.verdicts = verdicts
        """A dict per value: benchmark, what, computed, reference, error, tolerance, holds."""
        self.faults = faults
        """What is wrong with the files of results folders."""
        self.unchecked = unchecked
        """What was not checked, and why."""

    @property
    def holds(self) -> bool:
        """Whether all values hold and no file has a fault."""
        return not self.faults and all(verdict["holds"] for verdict in self.verdicts)

    @property
    def table(self) -> pd.DataFrame:
        """The verdicts as a frame."""
        return pandas("a table of verdicts").DataFrame(self.verdicts)

    def __repr__(self) -> str:
        held = sum(verdict["holds"] for verdict in self.verdicts)
        return f"<amontons.Verification, {held} of {len(self.verdicts)} values hold>"

    def _repr_html_(self) -> str:
        return _html(["benchmark", "what", "computed", "reference", "error", "tolerance", "holds"], self.verdicts)


def benchmarks() -> list[str]:
    """Names of the shipped benchmarks."""
    return _amontons.benchmarks()


def verify(*targets: CaseLike) -> Verification:
    """Compares shipped benchmarks (by name), cases with `[expected]` or `[verify]`, and results folders with their
    references; all benchmarks without arguments."""
    known, found = set(benchmarks()), Verification([], [], [])
    for target in targets or benchmarks():
        if isinstance(target, str) and target in known:
            report = _amontons.verify_benchmark(target)
        elif isinstance(target, (str, os.PathLike)) and os.path.isdir(target):
            report = _amontons.verify_folder(os.fspath(target))
        elif isinstance(target, str) and "\n" not in target and not os.path.exists(target):
            # The compiled part names the benchmarks.
            report = _amontons.verify_benchmark(target)
        else:
            report = _amontons.verify(Case(target)._checked)
        part = json.loads(report)
        found.verdicts += part["verdicts"]
        found.faults += part["faults"]
        found.unchecked += part["unchecked"]
    return found


def plot(folder: Union[str, os.PathLike[str]]) -> list[str]:
    """Draws all pictures of a results folder, as `amontons plot` does; returns their paths."""
    return [os.fspath(path) for path in _amontons.plot_folder(os.fspath(folder))]

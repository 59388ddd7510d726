"""Runs of a case for several values, on this machine or on many."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Callable, Optional

from ._case import Case, CaseLike, Overrides
from ._errors import RequestError, RunError
from ._laws import Laws
from ._optional import pandas
from ._result import Result
from ._studies import run

if TYPE_CHECKING:
    import pandas as pd

Figures = Callable[[Result], Mapping[str, Any]]


def _flatten(path: str, value: Any, into: dict[str, Any]) -> None:
    """The numbers of a value by their paths, as in `sweep.csv`."""
    if isinstance(value, dict):
        for key, entry in value.items():
            _flatten(f"{path}.{key}", entry, into)
    elif isinstance(value, list):
        for number, entry in enumerate(value):
            _flatten(f"{path}.{number}", entry, into)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        into[path] = float(value)


def _figures(result: Result) -> dict[str, Any]:
    summary = result.summary
    found = {"steps": summary["steps"], "seconds": summary["seconds"]["total"]}
    _flatten("final", summary["final"], found)
    _flatten("energy", summary["energy"], found)
    columns, rows = result._run.probes_table
    if len(rows):
        found.update((f"probes.{name}", value) for name, value in zip(columns[2:], rows[-1, 2:].tolist()))
    return found


def one(
    case: Case,
    threads: Optional[int] = None,
    certificate: bool = False,
    laws: Optional[Laws] = None,
    figures: Optional[Figures] = None,
) -> dict[str, Any]:
    """One run of a sweep as a dict of figures; a run that fails gives those of its last good step."""
    message = ""
    try:
        result: Optional[Result] = run(case, threads=threads, certificate=certificate, laws=laws)
    except RunError as error:
        result, message = error.result, str(error)
    row = {"outcome": "failed" if result is None else result.outcome, "message": message}
    if result is not None:
        row.update(_figures(result))
        if figures is not None:
            row.update(figures(result))
    return row


def sweep(
    case: CaseLike,
    each: Mapping[str, Sequence[Any]],
    overrides: Optional[Overrides] = None,
    *,
    executor: Any = None,
    threads: Optional[int] = None,
    certificate: bool = False,
    laws: Optional[Laws] = None,
    figures: Optional[Figures] = None,
    **keywords: Any,
) -> pd.DataFrame:
    """Runs a case for every combination of values: `sweep("paper.toml", {"mesh.n": [16, 32]})`.

    Returns a frame with a row per run: the values, `outcome`, `message`, and the figures of `sweep.csv`: those of
    `summary.json` under `final` and `energy` by their paths, and the last row of the probes. `figures(result)` adds
    figures of your own as a dict.

    `executor` runs them elsewhere: any executor of `concurrent.futures`, or a `dask.distributed.Client`. Each run then
    takes one thread unless `threads` says otherwise. Functions and laws must be importable there: define them in a
    module. Files that a case refers to must be at the same place.

    All cases are checked before the first run begins. A run that fails does not end the sweep: its `outcome` and
    `message` say why.
    """
    values = {key: list(given) for key, given in each.items()}
    empty = [key for key, given in values.items() if not given]
    if empty or not values:
        raise RequestError(f"each: found no values{f' of {empty[0]}' if empty else ''}, expected at least one key with values")
    base = Case(case, overrides, **keywords)
    chosen = [dict(zip(values, combination)) for combination in itertools.product(*values.values())]
    cases = [Case(base, given) for given in chosen]
    if executor is None:
        rows = [one(made, threads, certificate, laws, figures) for made in cases]
    else:
        tasks = [(made, 1 if threads is None else threads, certificate, laws, figures) for made in cases]
        futures = [executor.submit(one, *task) for task in tasks]
        try:
            rows = [future.result() for future in futures]
        except BaseException:
            for future in futures:
                future.cancel()
            raise
    table = [{**given, **row} for given, row in zip(chosen, rows)]
    return pandas("a table of a sweep").DataFrame(table)

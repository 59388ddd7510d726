"""Runs that are made step by step."""

from __future__ import annotations

from types import TracebackType
from typing import Any, Optional, Union

import numpy as np

from . import _amontons
from ._case import Case, CaseLike, Overrides
from ._errors import RequestError
from ._laws import Laws, describe
from ._result import Snapshot

_NORMAL = "normal"


class Saved:
    """A saved state of a run, for `Stepping.restore`."""

    def __init__(self, saved: _amontons.Saved) -> None:
        self._saved = saved

    @property
    def step(self) -> int:
        """Number of the step, n."""
        return self._saved.step

    @property
    def t(self) -> float:
        """Time t_n in s."""
        return self._saved.t

    def __repr__(self) -> str:
        return f"<amontons.Saved, step {self.step}, t = {self.t:g}>"


class Stepping:
    """A run whose steps are made one by one.

    Between the steps loads and prescribed values can be set, which hold until they are changed, and states saved and
    restored. Without them the states have the bits of `amontons.run`.

    >>> with amontons.Case("paper.toml").stepping() as run:
    ...     while not run.is_done:
    ...         run.set_force("left", [1.4, 0.4])
    ...         state = run.step()

    Values are one number, or vector, for the whole side, or one per node, in the order of `sides`.
    """

    def __init__(
        self,
        case: CaseLike,
        overrides: Optional[Overrides] = None,
        *,
        threads: Optional[int] = None,
        laws: Optional[Laws] = None,
        **keywords: Any,
    ) -> None:
        if threads is not None and not (isinstance(threads, int) and threads > 0):
            raise RequestError(f"threads: found {threads!r}, expected a positive number, or None for all cores")
        made = Case(case, overrides, **keywords)
        self._run = _amontons.Stepping(made._checked, describe(laws), threads)

    def step(self) -> Snapshot:
        """Makes the next step and returns the run at its end.

        Raises `StepError` if the step cannot be made. The state then stays as it is: set other inputs and try again.
        """
        self._run.make_step()
        return self.state

    @property
    def state(self) -> Snapshot:
        """The run at its state: `fields`, `contact` and `history`."""
        return Snapshot(self._run.state())

    @property
    def is_done(self) -> bool:
        """Whether all steps are made."""
        return self._run.is_done()

    @property
    def t(self) -> float:
        """Time t_n of the state in s."""
        return self._run.time()

    @property
    def next_t(self) -> Optional[float]:
        """Time at the end of the next step in s; None if all steps are made, or if the step chooses its length."""
        return self._run.next_time()

    @property
    def points(self) -> np.ndarray:
        """Coordinates of the nodes in m, three per node."""
        return self._run.points().reshape(-1, 3)

    @property
    def sides(self) -> dict[str, np.ndarray]:
        """The nodes of each named side, ascending."""
        return {name: np.asarray(nodes) for name, nodes in self._run.sides()}

    def save(self) -> Saved:
        """The state with all that the next steps depend on; inputs are not part of it."""
        return Saved(self._run.save())

    def restore(self, saved: Saved) -> None:
        """Goes back, or on, to a saved state. Inputs stay as they are."""
        if not isinstance(saved, Saved):
            raise TypeError(f"saved: found {type(saved).__name__}, expected what save() returned")
        self._run.restore(saved._saved)

    def reactions(self, on: str) -> np.ndarray:
        """Forces that the support exerts at the nodes of a side in N, a vector per node; zero where nothing is
        prescribed, and NaN at t = 0."""
        return self._run.reactions(on, False).reshape(-1, self._run.dimension())

    def heat_reactions(self, on: str) -> np.ndarray:
        """Heat that a prescribed temperature supplies at the nodes of a side in W; zero where nothing is prescribed,
        and NaN at t = 0."""
        return self._run.reactions(on, True)

    def set_force(self, on: str, values: Any) -> None:
        """Sets the force on a side in N: a vector, which is spread evenly, or one per node."""
        self._run.set_force(on, _array("force", values))

    def set_forces(self, values: Any) -> None:
        """Sets the forces at all nodes in N, a vector per node, besides those on sides."""
        self._run.set_force(None, _array("forces", values))

    def set_heat(self, on: str, values: Any) -> None:
        """Sets the heat supplied on a side in W: a number, which is spread evenly, or one per node."""
        self._run.set_heat(on, _array("heat", values))

    def set_heats(self, values: Any) -> None:
        """Sets the heat supplied at all nodes in W, a number per node, besides that on sides."""
        self._run.set_heat(None, _array("heat", values))

    def set_displacement(self, on: str, component: Union[int, str], values: Any) -> None:
        """Sets a component, 0, 1, 2 or "normal", of the displacement that the case prescribes on a side, in m."""
        if component == _NORMAL:
            number = None
        elif isinstance(component, (int, np.integer)) and 0 <= component <= 2:
            number = int(component)
        else:
            raise RequestError(f'component: found {component!r}, expected 0, 1, 2 or "normal"')
        self._run.set_displacement(on, number, _array("displacement", values))

    def set_temperature(self, on: str, values: Any) -> None:
        """Sets the temperature that the case prescribes on a side, in K."""
        self._run.set_temperature(on, _array("temperature", values))

    def set_foundation_temperature(self, contact: str, value: float) -> None:
        """Sets the temperature of the foundation of a contact in K, by the name of the contact in results."""
        self._run.set_foundation_temperature(contact, float(value))

    def clear(self) -> None:
        """Removes all inputs: from here on the data of the case hold."""
        self._run.clear()

    def close(self) -> None:
        """Releases the memory of the run."""
        self._run.close()

    def __enter__(self) -> Stepping:
        return self

    def __exit__(
        self,
        kind: Optional[type[BaseException]],
        error: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        self.close()


def _array(name: str, values: Any) -> np.ndarray:
    """Numbers in one row."""
    try:
        return np.ascontiguousarray(values, dtype=float).ravel()
    except (TypeError, ValueError):
        raise RequestError(f"{name}: found {values!r}, expected numbers") from None

"""Exceptions, with the texts that the program prints."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Optional

if TYPE_CHECKING:
    from ._result import Result


@dataclasses.dataclass(frozen=True)
class Fault:
    """One fault of a case: where, what was found, what was expected, what to try."""

    key: str
    """Dotted path of the datum, `boundary[1].on`; empty if the text is no TOML."""
    found: str
    expected: str
    hint: Optional[str]
    line: Optional[int]
    """Line in the text of the case, from 1; None for a fault of an override or of the case as a whole."""
    column: Optional[int]
    """Column in characters, from 1."""
    override: Optional[str]
    """The override that is faulty, as `KEY=VALUE`; None for a fault of the text."""

    def __str__(self) -> str:
        place = f"{self.key}: " if self.key else ""
        hint = f"; {self.hint}" if self.hint else ""
        return f"{place}found {self.found}, expected {self.expected}{hint}"


class AmontonsError(Exception):
    """What all errors of amontons have in common."""

    def __reduce__(self) -> Any:
        # All attributes travel to other processes, but for results, which stay in the memory of the run.
        attributes = {name: None if name == "result" else value for name, value in self.__dict__.items()}
        return (_rebuild, (type(self), self.args, attributes))


def _rebuild(kind: type, arguments: tuple, attributes: dict) -> BaseException:
    error = kind.__new__(kind, *arguments)
    error.args = arguments
    error.__dict__.update(attributes)
    return error


class CaseError(AmontonsError, ValueError):
    """A case has faults. The message has one line per fault: `file:line:column: key: found …, expected …; hint`."""

    def __init__(self, message: str, faults: list[Fault], more: int, name: str, text: str) -> None:
        super().__init__(message)
        self.faults = list(faults)
        """The faults in the order of their places: the first ones if there are many."""
        self.more = more
        """How many faults are left out."""
        self.name = name
        """The name of the case in the message."""
        self.text = text
        """The text that lines and columns refer to; for a case given as a dict it is generated."""


class RequestError(AmontonsError, ValueError):
    """Arguments do not fit the case or each other."""


class RunError(AmontonsError, RuntimeError):
    """A run did not reach its end."""

    def __init__(self, message: str, hint: Optional[str] = None) -> None:
        super().__init__(message)
        self.hint = hint
        """What to do, if something is known to help."""
        self.result: Optional[Result] = None
        """The run up to the last good step; None if it ended before its first step, or in another process."""

    def __str__(self) -> str:
        return super().__str__() + (f"\n{self.hint}" if self.hint else "")


class ThreadsError(RunError):
    """The threads could not be started."""


class SetupError(RunError):
    """The systems of the case could not be set up."""


class StepError(RunError):
    """A step could not be made."""


class UnsoundError(RunError):
    """All steps were made, but the results cannot be trusted."""


class ResultsError(RunError, OSError):
    """Results could not be written or read."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class StudyError(AmontonsError, RuntimeError):
    """A convergence study did not reach its end."""


class Interrupted(KeyboardInterrupt):
    """A run was interrupted by Ctrl-C."""

    def __init__(self, message: str = "", hint: Optional[str] = None) -> None:
        super().__init__(message)
        self.result: Optional[Result] = None
        """The run up to the last good step; None if it ended before its first step."""

"""Cases: files, texts and dicts, with overrides."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _amontons
from ._errors import RequestError

if TYPE_CHECKING:
    from ._laws import Laws
    from ._stepping import Stepping

CaseLike = Union["Case", Mapping[str, Any], str, "os.PathLike[str]"]
Overrides = Mapping[str, Any]

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


class Case:
    """A case: its text, the folder of the files that it refers to, and overrides.

    `source` is the path of a case file, the text of one (with at least one line end), a dict with the same keys, or
    another case. The case is checked when it is made.

    Overrides change single keys: `Case("paper.toml", {"mesh.n": 32})`, or `Case("paper.toml", mesh__n=32)`, where two
    underscores stand for the dot and a number for an index: `boundary__1__traction=[0, 1]`.
    """

    _name: str
    _text: str
    _folder: str
    _overrides: list[str]
    _checked: _amontons.Case

    def __init__(self, source: CaseLike, overrides: Optional[Overrides] = None, **keywords: Any) -> None:
        given = [f"{key}={_value(value)}" for key, value in (overrides or {}).items()]
        given += [f"{_dotted(key)}={_value(value)}" for key, value in keywords.items()]
        before: list[str] = []
        if isinstance(source, Case):
            name, text, folder, before = source._name, source._text, source._folder, source._overrides
        elif isinstance(source, Mapping):
            name, text, folder = "<dict>", _document(source), os.getcwd()
        elif isinstance(source, str) and "\n" in source:
            name, text, folder = "<text>", source, os.getcwd()
        elif isinstance(source, (str, os.PathLike)):
            name, text, place = _amontons.read(os.fspath(source))
            folder = os.path.abspath(place or ".")
        else:
            found = type(source).__name__
            raise TypeError(f"case: found {found}, expected a path, the text of a case file, a dict or a Case")
        self._name, self._text, self._folder = name, text, os.fspath(folder)
        self._overrides = before + given
        self._checked = _amontons.Case(self._name, self._text, self._folder, self._overrides)

    @property
    def name(self) -> str:
        """The name of the case."""
        return self._checked.name

    @property
    def steps(self) -> Optional[int]:
        """Number of time steps; None if steps choose their lengths."""
        return self._checked.steps

    @property
    def text(self) -> str:
        """The text of the case as it is run, overrides applied."""
        return self._checked.text

    def with_overrides(self, overrides: Optional[Overrides] = None, **keywords: Any) -> Case:
        """The same case with further overrides, applied after those that it has."""
        return Case(self, overrides, **keywords)

    def stepping(self, *, threads: Optional[int] = None, laws: Optional[Laws] = None) -> Stepping:
        """The case as a run that is made step by step, for loops of your own and for couplings."""
        from ._stepping import Stepping

        return Stepping(self, threads=threads, laws=laws)

    def gradient(
        self, of: Union[str, Sequence[str]], wrt: Sequence[str], *, threads: Optional[int] = None
    ) -> tuple[Any, np.ndarray]:
        """Numbers at the end of the run and their exact derivatives by keys with numbers: `value, grad = …`.

        For one name `of` is a text, and the value is a float and the gradient a vector, as `jac=True` of
        `scipy.optimize.minimize` takes them; for several names they are a vector and a matrix.
        """
        names = [of] if isinstance(of, str) else list(of)
        table = json.loads(_amontons.gradient(self._checked, names, list(wrt), threads))
        values = np.array([value for _, value in table["outputs"]])
        slopes = np.array(table["derivatives"]).reshape(len(names), len(wrt))
        return (float(values[0]), slopes[0]) if isinstance(of, str) else (values, slopes)

    def accurate(
        self, of: Union[str, Sequence[str]], relative: float, *, threads: Optional[int] = None
    ) -> dict[str, Any]:
        """Numbers at the end of the run to an accuracy: cells and steps are refined until each has its bar.

        `of` names probes or columns of the history or the probes, `relative` is the largest bar as a part of each
        number. The dict has `reached`, and `why` if it is false; `levels`, each with `cells`, `nodes`, `steps` and the
        `goals` with `value` and `bar`; and `bars`, those of all numbers of the last level at all common instants. A
        bar is an estimate, at least the error where halving takes half of it or more.
        """
        names = [of] if isinstance(of, str) else list(of)
        return json.loads(_amontons.accurate(self._checked, names, float(relative), threads))

    def fit(
        self,
        data: Union[str, "os.PathLike[str]", Mapping[str, Any]],
        free: Sequence[str],
        *,
        bounds: Optional[Mapping[str, tuple[Optional[float], Optional[float]]]] = None,
        threads: Optional[int] = None,
    ) -> dict[str, Any]:
        """The values of keys with which the run comes nearest to measured data: `fit.json` as a dict.

        `data` is the path of a table, or its columns by name (a dict, a pandas frame): `t`, outputs by their names in
        `probes.csv` or `history.csv`, and standard deviations with `_sigma` behind the name. `bounds` has a lower and
        an upper bound by key, None where there is none. `case` in the answer is the case with the values found.
        """
        given = dict(bounds or {})
        unknown = [key for key in given if key not in free]
        if unknown:
            raise RequestError(f"bounds: found the key {unknown[0]!r}, expected one of {', '.join(free)}")
        ends = [given.get(key, (None, None)) for key in free]
        numbers = [
            (-math.inf if low is None else float(low), math.inf if high is None else float(high)) for low, high in ends
        ]
        table = json.loads(_amontons.fit(self._checked, _table(data), list(free), numbers, threads))
        found = Case.__new__(Case)
        found.__setstate__((self._name, self._text, self._folder, self._overrides + table.pop("overrides")))
        return {**table, "case": found}

    def modes(self, *, wrt: Sequence[str] = (), threads: Optional[int] = None) -> dict[str, Any]:
        """The modes of the state at the end of the run, as `[stability]` asks for them: `modes.json` as a dict.

        With keys in `wrt` each mode has `by`: the derivatives of its `frequency` in Hz and of its `growth` by each key.
        """
        return json.loads(_amontons.modes(self._checked, list(wrt), threads))["modes"][0]

    def __repr__(self) -> str:
        return f"<amontons.Case {self.name!r}, {self.steps or 'automatic'} steps>"

    def __getstate__(self) -> tuple:
        return (self._name, self._text, self._folder, self._overrides)

    def __setstate__(self, state: tuple) -> None:
        self._name, self._text, self._folder, self._overrides = state
        self._checked = _amontons.Case(*state)


def _table(data: Union[str, "os.PathLike[str]", Mapping[str, Any]]) -> str:
    """The text of a table of measured values: of a file, or of columns by name."""
    if isinstance(data, (str, os.PathLike)):
        with open(data, encoding="utf-8") as file:
            return file.read()
    names = list(data)
    columns = [list(data[name]) for name in names]
    if len({len(column) for column in columns}) > 1:
        raise RequestError("data: found columns of different lengths, expected an entry per time")

    def entry(value: Any) -> str:
        number = math.nan if value is None else float(value)
        return "" if math.isnan(number) else repr(number)

    rows = [",".join(map(entry, row)) for row in zip(*columns)]
    return "\n".join([",".join(map(str, names)), *rows]) + "\n"


def _dotted(key: str) -> str:
    """`boundary__1__traction` as `boundary[1].traction`; a key with dots is taken as it is."""
    if "." in key or "[" in key:
        return key
    first, *rest = key.split("__")
    return first + "".join(f"[{part}]" if part.isdigit() else f".{part}" for part in rest)


def _plain(value: Any) -> Any:
    """numpy scalars and arrays as Python numbers and lists; paths as text."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return os.fspath(value) if isinstance(value, os.PathLike) else value


def _string(text: str) -> str:
    def escape(c: str) -> str:
        return _ESCAPES.get(c) or (f"\\u{ord(c):04X}" if ord(c) < 32 or ord(c) == 127 else c)

    return '"' + "".join(map(escape, text)) + '"'


def _key(key: Any) -> str:
    if not isinstance(key, str):
        raise RequestError(f"case: found the key {key!r}, expected a string")
    return key if _BARE.match(key) else _string(key)


def _value(value: Any) -> str:
    """A value of TOML on one line."""
    value = _plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if math.isfinite(value):
            return repr(value)
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf")
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(entry)}" for key, entry in value.items()) + " }"
    if isinstance(value, (Sequence, set, frozenset)):
        return "[" + ", ".join(map(_value, value)) + "]"
    raise RequestError(f"case: found {value!r}, expected a number, a text, true or false, a list or a dict")


def _document(case: Mapping[str, Any]) -> str:
    """A dict as the text of a case file, a key per line, so that lines of faults tell where they are."""
    lines: list[str] = []
    tables: list[tuple[str, Mapping[str, Any]]] = []
    for key, value in case.items():
        value = _plain(value)
        if isinstance(value, Mapping):
            tables.append((f"[{_key(key)}]", value))
        elif isinstance(value, (list, tuple)) and value and all(isinstance(entry, Mapping) for entry in value):
            tables.extend((f"[[{_key(key)}]]", entry) for entry in value)
        else:
            lines.append(f"{_key(key)} = {_value(value)}")
    for heading, table in tables:
        lines += ["", heading] + [f"{_key(key)} = {_value(entry)}" for key, entry in table.items()]
    return "\n".join(lines) + "\n"

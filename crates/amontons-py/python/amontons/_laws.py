"""Laws of contact and material that are written in Python, on arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Callable, NamedTuple, Optional, Union

import numpy as np

from . import _amontons
from ._errors import AmontonsError, RequestError

_ROOT = np.sqrt(2.0)
# Pairs of indices of the Mandel components.
_PAIRS = ((0, 0), (1, 1), (0, 1), (2, 2), (1, 2), (0, 2))
# Points and weights of a rule on [0, 1] for the energy of a normal law.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS


class LawError(AmontonsError, AssertionError):
    """A law does not keep what it promises."""


class Points:
    """Contact points that a law is evaluated at: one array per quantity, one entry per point.

    A law depends on no more than what these say, and each entry of its values on the same entry of the arguments alone.
    """

    __slots__ = ("_rows",)

    def __init__(self, rows: np.ndarray) -> None:
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def x(self) -> np.ndarray:
        """Positions in m, three components per point."""
        return self._rows[:, 0:3]

    @property
    def penetration(self) -> np.ndarray:
        """r = u_ν − g in m; negative where the gap is open."""
        return self._rows[:, 3]

    @property
    def rate(self) -> np.ndarray:
        """Rate of the penetration in m/s; normal laws see it."""
        return self._rows[:, 4]

    @property
    def pressure(self) -> np.ndarray:
        """Contact pressure in Pa; laws of friction, heat and wear see it."""
        return self._rows[:, 5]

    @property
    def slip_speed(self) -> np.ndarray:
        """Slip speed in m/s; zero for friction where a point sticks."""
        return self._rows[:, 6]

    @property
    def friction_power(self) -> np.ndarray:
        """Power of friction in W/m²; laws of heat see it."""
        return self._rows[:, 7]

    @property
    def temperature(self) -> np.ndarray:
        """Temperature of the body in K."""
        return self._rows[:, 8]

    @property
    def foundation_temperature(self) -> np.ndarray:
        """Temperature of the foundation in K."""
        return self._rows[:, 9]


Values = tuple[Any, Mapping[str, Any]]
"""Values of a law, and its slopes by the name of the argument."""


class _Description(NamedTuple):
    """A law as the compiled part takes it."""

    name: str
    kind: str
    place: Optional[str]
    functions: list[Callable[[np.ndarray], np.ndarray]]
    constants: list[Optional[float]]


class Law:
    """What all laws have in common."""

    def _describe(self, kind: str, place: Optional[str]) -> _Description:
        raise NotImplementedError


class _ContactLaw(Law):
    _kind = ""
    _method = ""
    # Arguments whose slopes count, in the order of the compiled part.
    _slopes: tuple[str, ...] = ()
    _needed: tuple[str, ...] = ()

    def _evaluate(self, rows: np.ndarray) -> np.ndarray:
        found = getattr(self, self._method)(Points(rows))
        name = f"{type(self).__name__}.{self._method}"
        if not (isinstance(found, tuple) and len(found) == 2 and isinstance(found[1], Mapping)):
            raise LawError(f"{name}: found {type(found).__name__}, expected the values and a dict of their slopes")
        value, slopes = found
        unknown = [key for key in slopes if key not in self._slopes]
        if unknown:
            raise LawError(f"{name}: found a slope in {unknown[0]!r}, expected one of {', '.join(self._slopes)}")
        missing = [key for key in self._needed if key not in slopes]
        if missing:
            raise LawError(f"{name}: found no slope in {missing[0]!r}, which the solver needs")
        out = np.zeros((len(rows), 1 + len(self._slopes)))
        for column, (what, numbers) in enumerate([("value", value), *((key, slopes.get(key, 0.0)) for key in self._slopes)]):
            out[:, column] = _numbers(name, what, numbers, (len(rows),))
        return out.ravel()

    def _constants(self) -> list[Optional[float]]:
        return []

    def _functions(self) -> list[Callable[[np.ndarray], np.ndarray]]:
        return [self._evaluate]

    def _describe(self, kind: str, place: Optional[str]) -> _Description:
        if kind != self._kind:
            raise RequestError(f"laws: found {type(self).__name__} as law of {kind}, expected a law of {kind}")
        return _Description(type(self).__name__, kind, place, self._functions(), self._constants())


def _numbers(name: str, what: str, numbers: Any, shape: tuple[int, ...]) -> np.ndarray:
    array = np.asarray(numbers, dtype=float)
    try:
        return np.broadcast_to(array, shape)
    except ValueError:
        raise LawError(f"{name}: found the shape {array.shape} of the {what}, expected {shape}") from None


def _constant(law: Law, name: str) -> Optional[float]:
    value = getattr(law, name)
    return None if value is None else float(value)


class NormalLaw(_ContactLaw):
    """A normal law p(r, ṙ) of (2.8), not negative, zero without penetration unless it pulls.

    Write a class with the method `pressure`, which returns p in Pa and the slopes in `penetration` (Pa/m) and `rate`
    (Pa s/m; 0 if it is left out). Friction and wear follow p.
    """

    lipschitz: Optional[float] = None
    """L_ν of (H8), the largest slope in Pa/m; None if slopes are not bounded."""
    lipschitz_in_rate: Optional[float] = 0.0
    """The largest slope in the rate, Pa s/m; None if it is not bounded."""
    least_slope: float = 0.0
    """The least slope in Pa/m: negative for a law that falls."""

    _kind, _method, _slopes, _needed = "normal", "pressure", ("penetration", "rate"), ("penetration",)

    def pressure(self, at: Points) -> Values:
        """p and its slopes."""
        raise NotImplementedError

    def energy(self, at: Points) -> Any:
        """∫₀^r p at ṙ = 0 in J/m², which the energy audit takes.

        This one integrates p by Gauss's rule with 16 points, which is exact up to round-off for polynomials of degree
        31 in r > 0. Give a formula for a law with kinks at r > 0.
        """
        rows = at._rows
        many = np.repeat(rows, len(_NODES), axis=0)
        many[:, 3] *= np.tile(_NODES, len(rows))
        many[:, 4] = 0.0
        p = self._evaluate(many).reshape(-1, 3)[:, 0].reshape(len(rows), len(_NODES))
        return rows[:, 3] * (p @ _WEIGHTS)

    def _energy(self, rows: np.ndarray) -> np.ndarray:
        name = f"{type(self).__name__}.energy"
        return np.array(_numbers(name, "value", self.energy(Points(rows)), (len(rows),)))

    def _functions(self) -> list[Callable[[np.ndarray], np.ndarray]]:
        return [self._evaluate, self._energy]

    def _constants(self) -> list[Optional[float]]:
        return [_constant(self, name) for name in ("lipschitz", "lipschitz_in_rate", "least_slope")]


class FrictionLaw(_ContactLaw):
    """A friction bound s ≥ 0 of (2.9).

    Write a class with the method `bound`, which returns s in Pa and its slopes in `penetration`, `pressure`,
    `slip_speed` and `temperature`; those left out are 0.
    """

    lipschitz: Optional[float] = None
    """The largest slope in the pressure; None if it is not bounded, or if s does not vanish with the pressure."""
    least_slope: float = 0.0
    """The least slope in the slip speed, Pa s/m: negative for a law that falls."""
    drops_from_rest: bool = False
    """Whether s drops when slip starts."""

    _kind, _method, _slopes = "friction", "bound", ("penetration", "pressure", "slip_speed", "temperature")

    def bound(self, at: Points) -> Values:
        """s and its slopes."""
        raise NotImplementedError

    def _constants(self) -> list[Optional[float]]:
        return [_constant(self, "lipschitz"), _constant(self, "least_slope"), 1.0 if self.drops_from_rest else None]


class HeatLaw(_ContactLaw):
    """A heat flux q·ν of (2.10) from the body into the foundation.

    Write a class with the method `flux`, which returns q·ν in W/m² and its slopes in `temperature`,
    `foundation_temperature`, `penetration`, `pressure`, `slip_speed` and `friction_power`; those left out are 0. The
    flux does not fall with the temperature of the body and does not grow with that of the foundation.
    """

    conductance_bound: Optional[float] = None
    """M_kc of (H7), the largest conductance in W/(m² K); None if there is no bound."""
    conductance_lipschitz: Optional[float] = None
    """L_kc of (H7), the largest slope of the conductance in the penetration in W/(m³ K); None if there is no bound."""

    _kind, _method = "heat", "flux"
    _slopes = ("temperature", "foundation_temperature", "penetration", "pressure", "slip_speed", "friction_power")
    _needed = ("temperature",)

    def flux(self, at: Points) -> Values:
        """q·ν and its slopes."""
        raise NotImplementedError

    def _constants(self) -> list[Optional[float]]:
        return [_constant(self, name) for name in ("conductance_bound", "conductance_lipschitz")]


class WearLaw(_ContactLaw):
    """The coefficient κ ≥ 0 of the wear rate ḣ = κ p ‖w_τ‖.

    Write a class with the method `coefficient`, which returns κ in 1/Pa and its slope in `temperature`; 0 if it is left
    out.
    """

    _kind, _method, _slopes = "wear", "coefficient", ("temperature",)

    def coefficient(self, at: Points) -> Values:
        """κ and its slope."""
        raise NotImplementedError


class MaterialLaw(Law):
    """A constitutive law, for 𝓔 of (H2) in Pa or for 𝓥 of (H1) in Pa s.

    Write a class with the methods `value` and `tangent`, and the constants m and M. Arguments are positions, three
    components per point, and symmetric tensors by their six Mandel components 11, 22, √2·12, 33, √2·23, √2·13 per
    point; see `tensors` and `mandel`. In the plane the first three components of the argument count, and the first
    three of the value enter the equations: the law says itself whether the stress or the strain is plane, and its
    component 33 is the stress that holds a plane strain.
    """

    monotonicity: float = 0.0
    """m: (A(ξ₁) − A(ξ₂))·(ξ₁ − ξ₂) ≥ m ‖ξ₁ − ξ₂‖²."""
    lipschitz: float = np.inf
    """M: ‖A(ξ₁) − A(ξ₂)‖ ≤ M ‖ξ₁ − ξ₂‖."""

    def value(self, x: np.ndarray, xi: np.ndarray) -> Any:
        """The value, six Mandel components per point."""
        raise NotImplementedError

    def tangent(self, x: np.ndarray, xi: np.ndarray) -> Any:
        """Its derivative, 6 × 6 numbers per point."""
        raise NotImplementedError

    def potential(self, x: np.ndarray, xi: np.ndarray) -> Any:
        """W with dW/dξ the value and W(0) = 0, in J/m³. A law that has none leaves this method out."""
        raise NotImplementedError

    def _function(self, method: str, shape: tuple[int, ...]) -> Callable[[np.ndarray], np.ndarray]:
        def evaluate(rows: np.ndarray) -> np.ndarray:
            found = getattr(self, method)(rows[:, 0:3], rows[:, 3:9])
            expected = (len(rows), *shape)
            array = np.asarray(found, dtype=float)
            if array.shape != expected and array.shape != shape:
                name = f"{type(self).__name__}.{method}"
                raise LawError(f"{name}: found the shape {array.shape}, expected {expected}")
            return np.ascontiguousarray(np.broadcast_to(array, expected)).ravel()

        return evaluate

    def _describe(self, kind: str, place: Optional[str]) -> _Description:
        if kind not in ("elasticity", "viscosity"):
            raise RequestError(f"laws: found {type(self).__name__} as law of {kind}, expected a law of {kind}")
        functions = [self._function("value", (6,)), self._function("tangent", (6, 6))]
        if type(self).potential is not MaterialLaw.potential:
            functions.append(self._function("potential", ()))
        return _Description(type(self).__name__, kind, place, functions, [float(self.monotonicity), float(self.lipschitz)])


def tensors(components: Any) -> np.ndarray:
    """Symmetric tensors, 3 × 3 numbers each, of their six Mandel components."""
    components = np.asarray(components, dtype=float)
    made = np.empty((*components.shape[:-1], 3, 3))
    for m, (i, j) in enumerate(_PAIRS):
        made[..., i, j] = made[..., j, i] = components[..., m] / (1.0 if i == j else _ROOT)
    return made


def mandel(tensor: Any) -> np.ndarray:
    """The six Mandel components of symmetric tensors, 3 × 3 numbers each."""
    tensor = np.asarray(tensor, dtype=float)
    return np.stack([tensor[..., i, j] * (1.0 if i == j else _ROOT) for i, j in _PAIRS], axis=-1)


Laws = Mapping[str, Union[Law, Mapping[str, Law]]]
"""Laws by kind: `normal`, `friction`, `heat`, `wear`, `elasticity`, `viscosity`; of single sides or regions a dict."""

_KINDS = ("normal", "friction", "heat", "wear", "elasticity", "viscosity")


def describe(laws: Optional[Laws]) -> list[_Description]:
    """Laws as the compiled part takes them."""
    described = []
    for kind, given in (laws or {}).items():
        if kind not in _KINDS:
            raise RequestError(f"laws: found {kind!r}, expected one of {', '.join(_KINDS)}")
        for place, law in given.items() if isinstance(given, Mapping) else [(None, given)]:
            if not isinstance(law, Law):
                raise RequestError(f"laws: found {type(law).__name__} as law of {kind}, expected a law of {kind}")
            described.append(law._describe(kind, place))
    return described


def check_law(law: Law, size: float, dimension: int = 3) -> None:
    """Tests what a law promises at random points: slopes against differences, constants, what the solver relies on.

    `size` is a typical argument of the law: a penetration in m for laws of contact and heat, a pressure in Pa for
    friction, a strain for materials. Raises `LawError` with the place and the numbers where the law breaks its word.
    """
    if not isinstance(law, Law):
        raise RequestError(f"found {type(law).__name__}, expected a law")
    kind = law._kind if isinstance(law, _ContactLaw) else "elasticity"
    message = _amontons.test_law(law._describe(kind, None), float(size), dimension)
    if message is not None:
        raise LawError(message)

"""Laws in Python: the numbers of the built-in ones, few calls, and faults that are named."""

import numpy as np
import pytest

import amontons
from conftest import SMALL
from mylaws import Archard, Compliance, Coulomb, Isotropic, Ramp, Saturating, WrongSlope, Yielding


def same(found, expected):
    """The same bits in every column."""
    assert list(found.columns) == list(expected.columns)
    for name in expected.columns:
        if expected[name].dtype.kind == "f":
            assert found[name].to_numpy().tobytes() == expected[name].to_numpy().tobytes(), name
        else:
            assert list(found[name]) == list(expected[name]), name


def test_contact_laws_have_the_bits_of_the_built_in_ones(paper):
    built_in = amontons.run(paper, SMALL)
    normal = Compliance(1e4)
    laws = {"normal": normal, "friction": Coulomb(0.2), "heat": {"bottom": Ramp(1.0, 1e-5)}}
    own = amontons.run(paper, SMALL, laws=laws)
    same(own.history, built_in.history)
    same(own.contact, built_in.contact)
    for name in built_in.fields:
        assert np.array_equal(own.fields[name], built_in.fields[name]), name
    found = {finding["id"]: finding["status"] for finding in own.findings}
    assert found == {finding["id"]: finding["status"] for finding in built_in.findings}


def test_a_law_is_called_for_all_points_together(paper):
    calls = {}
    for n in (8, 32):
        law, seen = Compliance(1e4), []
        laws, options = {"normal": law}, {"certificate": False, "callback": lambda now: seen.append((law.calls, law.points))}
        amontons.run(paper, mesh__n=n, time__steps=8, laws=laws, **options)
        (first_calls, first_points), (last_calls, last_points) = seen[0], seen[-1]
        calls[n] = (last_calls - first_calls, (last_points - first_points) / (last_calls - first_calls))
        # Also the certificate asks for many samples together.
        assert first_points > 20 * first_calls
    # Four times the points: not twice the calls, and more points per call.
    assert calls[32][0] < 2 * calls[8][0]
    assert calls[32][1] > 3 * calls[8][1]


def test_energy_by_quadrature_is_that_of_the_formula(paper):
    class NoFormula(Compliance):
        energy = amontons.NormalLaw.energy

    with_formula = amontons.run(paper, SMALL, laws={"normal": Compliance(1e4)}).summary["energy"]["contact_energy"]
    without = amontons.run(paper, SMALL, laws={"normal": NoFormula(1e4)}).summary["energy"]["contact_energy"]
    assert without == pytest.approx(with_formula, rel=1e-13)


def test_wear_has_the_bits_of_the_built_in_law(paper):
    wear = {"contact.wear": {"law": "archard", "coefficient": 1e-4}}
    built_in = amontons.run(paper, {**SMALL, **wear})
    own = amontons.run(paper, SMALL, laws={"wear": Archard(1e-4)})
    assert built_in.summary["final"]["contact"]["wear_max"] > 0
    same(own.history, built_in.history)


def test_a_friction_law_of_ones_own(paper):
    """A bound of τ tanh(μ p/τ) holds at every contact point that slips."""
    contact = amontons.run(paper, SMALL, laws={"friction": Saturating(0.2, 0.05)}).contact
    bound = 0.05 * np.tanh(0.2 * contact["pressure"] / 0.05)
    assert np.allclose(contact["bound"], bound, rtol=1e-12, atol=0)
    slips = contact["status"] == "slip"
    traction = np.hypot(contact["traction_x"], contact["traction_y"])
    assert slips.any() and np.allclose(traction[slips], bound[slips], rtol=1e-9, atol=0)


BLOCK = {
    "name": "block",
    "mesh": {"kind": "rectangle", "size": [1.0, 1.0], "n": 4},
    "time": {"end": 1.0, "steps": 4},
    "material": {
        "density": 0.0,
        "elasticity": {"law": "isotropic", "young": 3.0, "poisson": 0.25, "stress_state": "plane-strain"},
    },
    "boundary": [{"on": "top", "displacement": ["0.02*t", "-0.05*t"]}],
    "contact": {
        "on": "bottom",
        "normal": {"law": "compliance", "stiffness": 50.0},
        "friction": {"law": "coulomb", "coefficient": 0.3},
    },
}


def test_a_material_law_has_the_numbers_of_the_built_in_one():
    built_in = amontons.run(BLOCK)
    law = Isotropic(3.0, 0.25)
    own = amontons.run(BLOCK, laws={"elasticity": law})
    # A law that is not declared linear is solved by Newton's method, to the tolerance of a step.
    for name in ("displacement", "stress"):
        scale = np.abs(built_in.fields[name]).max()
        assert np.abs(own.fields[name] - built_in.fields[name]).max() < 1e-9 * scale, name
    energy = [result.summary["energy"]["elastic"] for result in (own, built_in)]
    assert energy[0] == pytest.approx(energy[1], rel=1e-9)
    assert law.calls < 200


def test_a_nonlinear_material_law_is_solved():
    """The stress in every cell is that of the law at its strain, and it is not that of the linear part."""
    law = Yielding(3.0, 0.25, 5.0, 0.02)
    amontons.check_law(law, 0.05, dimension=3)
    result = amontons.run(BLOCK, laws={"elasticity": law})
    strain, stress = result.fields["strain"], result.fields["stress"]
    to_tensors = [[0, 3, 5], [3, 1, 4], [5, 4, 2]]
    xi = amontons.mandel(strain[:, to_tensors])
    expected = amontons.tensors(law.value(None, xi))
    found = stress[:, to_tensors]
    # In plane strain the strain has no component 33, and the law gives the stress that holds it.
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()
    linear = amontons.tensors(xi @ law.map)
    assert np.abs(found - linear).max() > 0.05 * np.abs(linear).max()
    assert abs(result.summary["energy"]["closing_error"]) < 1e-10


def test_mandel_components_keep_the_inner_product():
    random = np.random.default_rng(7)
    a, b = (t + np.swapaxes(t, 1, 2) for t in random.standard_normal((2, 5, 3, 3)))
    assert np.allclose(np.einsum("ij,ij->i", amontons.mandel(a), amontons.mandel(b)), np.einsum("kij,kij->k", a, b))
    assert np.allclose(amontons.tensors(amontons.mandel(a)), a)


def test_laws_are_tested_against_what_they_promise():
    amontons.check_law(Compliance(1e4), 1e-4)
    amontons.check_law(Saturating(0.5, 3e5), 1e6)
    amontons.check_law(Ramp(1.0, 1e-5), 1e-5)
    amontons.check_law(Archard(1e-4), 1.0)
    with pytest.raises(amontons.LawError, match="WrongSlope"):
        amontons.check_law(WrongSlope(0.3), 1e6)
    too_large = Compliance(1e4)
    too_large.lipschitz = 1e3
    with pytest.raises(amontons.LawError, match="declared L = 1e3 fails"):
        amontons.check_law(too_large, 1e-4)


class Raises(Coulomb):
    def bound(self, at):
        raise ZeroDivisionError("in the law")


class Shape(Coulomb):
    def bound(self, at):
        return np.zeros(len(at) + 1), {"pressure": 0.0}


class NotFinite(Coulomb):
    def bound(self, at):
        return np.full(len(at), np.inf), {"pressure": 0.0}


class NotANumber(Coulomb):
    def bound(self, at):
        return np.zeros(len(at)), {"pressure": np.nan}


class NoSlopes(Coulomb):
    def bound(self, at):
        return at.pressure


class Unknown(Coulomb):
    def bound(self, at):
        return at.pressure, {"presure": 1.0}


@pytest.mark.parametrize(
    ("law", "error", "text"),
    [
        (Raises(0.2), ZeroDivisionError, "in the law"),
        (Shape(0.2), amontons.LawError, r"Shape.bound: found the shape \(\d+,\) of the value, expected"),
        (NotFinite(0.2), RuntimeError, "the law NotFinite gave inf for the arguments"),
        (NotANumber(0.2), RuntimeError, "the law NotANumber gave NaN for the arguments"),
        (NoSlopes(0.2), amontons.LawError, "NoSlopes.bound: found ndarray, expected the values and a dict"),
        (Unknown(0.2), amontons.LawError, "found a slope in 'presure', expected one of penetration, pressure"),
    ],
)
def test_faults_in_laws_end_the_run_by_their_exception(paper, law, error, text):
    for certificate in (True, False):
        with pytest.raises(error, match=text):
            amontons.run(paper, SMALL, certificate=certificate, laws={"friction": law})


def test_laws_in_wrong_places(paper, tmp_path):
    with pytest.raises(amontons.RequestError, match='found the contact side "top", expected one of the case, which has'):
        amontons.run(paper, SMALL, laws={"normal": {"top": Compliance(1e4)}})
    with pytest.raises(amontons.RequestError, match="found Coulomb as law of normal, expected a law of normal"):
        amontons.run(paper, SMALL, laws={"normal": Coulomb(0.2)})
    with pytest.raises(amontons.RequestError, match="laws: found 'normale', expected one of normal, friction"):
        amontons.run(paper, SMALL, laws={"normale": Compliance(1e4)})
    with pytest.raises(amontons.RequestError, match="laws: found float as law of friction"):
        amontons.run(paper, SMALL, laws={"friction": 0.2})
    with pytest.raises(amontons.RequestError, match="out: found a results folder for a run with laws in Python"):
        amontons.run(paper, SMALL, out=tmp_path / "out", laws={"friction": Coulomb(0.2)})


def test_check_judges_the_laws_given(paper):
    law = Compliance(5e3)
    constants = amontons.check(paper, SMALL, laws={"normal": law}).constants
    assert constants["L_nu"] == 5e3

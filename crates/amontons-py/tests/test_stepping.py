"""Runs that are made step by step: the bits of a run, inputs, ways back, errors, and two runs that are coupled."""

import importlib.util
import pathlib

import numpy as np
import pytest

import amontons
from conftest import SMALL

BAR = {
    "name": "bar",
    "mesh": {"kind": "interval", "size": 2.0, "n": 4},
    "time": {"end": 1.0, "steps": 2},
    "material": {
        "density": 0,
        "heat_capacity": 0,
        "conductivity": 3.0,
        "elasticity": {"law": "isotropic", "young": 50.0, "poisson": 0.0},
    },
    "boundary": [{"on": "left", "displacement": [0], "temperature": 1}],
}


def test_the_states_have_the_bits_of_a_run(paper):
    expected = amontons.run(paper, SMALL, output__every=1).snapshots
    with amontons.Case(paper, SMALL).stepping() as run:
        assert run.t == 0.0 and run.next_t == 0.125
        for snapshot in expected[1:]:
            state = run.step()
            assert state.t == snapshot.t and state.history == snapshot.history
            for name, field in snapshot.fields.items():
                assert state.fields[name].tobytes() == field.tobytes(), name
        assert run.is_done and run.next_t is None


def test_inputs_give_the_numbers_of_the_formulas():
    with amontons.Case(BAR).stepping(threads=1) as run:
        assert np.isnan(run.reactions("left")).all()
        run.set_force("right", 5)
        run.set_heat("right", np.array([6.0]))
        run.set_displacement("left", 0, 0.25)
        run.set_temperature("left", [2])
        fields = run.step().fields
        # F L/E on top of the displacement, Q L/k on top of the temperature.
        assert fields["displacement"][:, 0] == pytest.approx(0.25 + run.points[:, 0] * 5 / 50, abs=1e-12)
        assert fields["temperature"] == pytest.approx(2 + run.points[:, 0] * 6 / 3, abs=1e-12)
        assert run.reactions("left") == pytest.approx(np.array([[-5.0]]))
        assert run.heat_reactions("left") == pytest.approx(np.array([-6.0]))
        before = run.save()
        run.clear()
        assert np.abs(run.step().fields["displacement"]).max() < 1e-12
        run.restore(before)
        assert (before.step, run.state.step, run.t) == (1, 1, 0.5)
        forces = np.zeros((5, 1))
        forces[4] = 10.0
        run.set_forces(forces)
        assert run.step().fields["displacement"][4, 0] == pytest.approx(10 * 2 / 50)


def test_what_does_not_fit_is_refused():
    run = amontons.Case(BAR).stepping()
    for call, message in [
        (lambda: run.set_force("lid", 1), 'force on "lid": found no side of this name, expected left, right'),
        (lambda: run.set_force("right", [1, 2]), 'force on "right": found 2 numbers, expected 1 number'),
        (lambda: run.set_force("right", "much"), "force: found 'much', expected numbers"),
        (lambda: run.set_heat("right", np.nan), 'heat on "right": found NaN in place 0, expected finite numbers'),
        (lambda: run.set_temperature("right", 1), "found a value that the case does not prescribe"),
        (lambda: run.set_displacement("left", "x", 1), "component: found 'x', expected 0, 1, 2"),
        (lambda: run.set_foundation_temperature("left", 1), "found no contact of this name"),
        (lambda: run.reactions("lid"), 'reactions on "lid": found no side'),
        (lambda: amontons.Case(BAR).stepping(threads=0), "threads: found 0"),
    ]:
        with pytest.raises(amontons.RequestError) as error:
            call()
        assert message in str(error.value)
    with pytest.raises(TypeError, match="saved: found int"):
        run.restore(1)
    run.step()
    other = amontons.Case(BAR, mesh__n=5).stepping()
    with pytest.raises(amontons.RequestError, match="the saved state is of another case"):
        other.restore(run.save())
    run.step()
    with pytest.raises(amontons.RequestError, match="step 3: found a run at its end after 2 steps"):
        run.step()
    run.close()
    with pytest.raises(amontons.RequestError, match="found a run that is closed"):
        run.step()


def test_a_failed_step_leaves_the_state():
    # Nothing but the contact holds the block against a push; nothing holds it against a pull.
    block = {
        "name": "block",
        "mesh": {"kind": "interval", "size": 1.0, "n": 2},
        "time": {"end": 1.0, "steps": 2},
        "material": {"density": 0, "elasticity": {"law": "isotropic", "young": 1e3, "poisson": 0.0}},
        "contact": {"on": "right", "normal": {"law": "signorini"}},
    }
    with amontons.Case(block).stepping() as run:
        run.set_force("left", -1.0)
        with pytest.raises(amontons.StepError) as error:
            run.step()
        assert error.value.hint and run.state.step == 0
        run.set_force("left", 1.0)
        assert run.step().fields["displacement"][:, 0] == pytest.approx([1e-3, 5e-4, 0.0], abs=1e-12)


def test_two_coupled_runs_are_the_run_of_the_whole():
    path = pathlib.Path(__file__).resolve().parents[1] / "examples" / "coupled.py"
    spec = importlib.util.spec_from_file_location("coupled", path)
    coupled = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(coupled)
    halves, whole = coupled.halves(), coupled.whole()
    assert len(halves) == len(whole) == 10
    for found, expected in zip(halves, whole):
        assert np.abs(expected).max() > 1e-6
        assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()

"""Faults have their place, and their texts are those of the program."""

import json
import pickle

import pytest

import amontons
from conftest import SMALL

FAULTY = """name = "faulty"

[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = 4
diagonl = "right"

[time]
end = -1.0
steps = 2

[material]
density = 1.0
elasticity = { law = "isotropic", young = 2.0, poisson = 0.1, stress_state = "plane-stress" }
"""


def test_faults_have_line_column_key_found_expected_and_hint(tmp_path, program):
    path = tmp_path / "faulty.toml"
    path.write_text(FAULTY)
    with pytest.raises(amontons.CaseError) as caught:
        amontons.run(path)
    error = caught.value
    expected = json.loads(program("run", path, "--format", "json", code=2).stdout)["error"]
    assert str(error) == expected["message"]
    assert [fault.key for fault in error.faults] == [fault["path"] for fault in expected["faults"]]
    for found, fault in zip(error.faults, expected["faults"]):
        assert (found.found, found.expected, found.hint) == (fault["found"], fault["expected"], fault["hint"])
        assert (found.line, found.column) == (fault["where"].get("line"), fault["where"].get("column"))
    diagonl = error.faults[0]
    assert (diagonl.line, diagonl.column, diagonl.key) == (7, 1, "mesh.diagonl")
    assert diagonl.hint == "did you mean `diagonal`?"
    assert f"{path}:7:1: mesh.diagonl: found an unknown key" in str(error)
    assert isinstance(error, ValueError) and error.text == FAULTY and error.more == 0


def test_faults_of_overrides_name_the_override(paper):
    with pytest.raises(amontons.CaseError) as caught:
        amontons.run(paper, {"mesh.n": "many"})
    [fault] = caught.value.faults
    assert fault.override == 'mesh.n="many"' and fault.line is None and fault.key == "mesh.n"


def test_faults_of_a_dict_have_lines_of_its_text():
    case = {"name": "x", "mesh": {"kind": "rectangle", "size": [1, 1], "n": 0}, "time": {"end": 1, "steps": 1}}
    with pytest.raises(amontons.CaseError) as caught:
        amontons.Case(case)
    fault = next(fault for fault in caught.value.faults if fault.key == "mesh.n")
    assert caught.value.text.splitlines()[fault.line - 1] == "n = 0"


def test_errors_travel_between_processes():
    with pytest.raises(amontons.CaseError) as caught:
        amontons.Case(FAULTY)
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is amontons.CaseError
    assert (str(again), again.faults, again.text) == (str(caught.value), caught.value.faults, caught.value.text)


def test_a_run_that_does_not_reach_its_end(tmp_path, program):
    # Nothing holds the block against the traction: it slides, and there is no mass.
    case = {
        "name": "loose",
        "mesh": {"kind": "rectangle", "size": [1, 1], "n": 2},
        "time": {"end": 1, "steps": 2},
        "material": {"density": 0.0, "elasticity": {"law": "isotropic", "young": 1e6, "poisson": 0.3, "stress_state": "plane-strain"}},
        "boundary": [{"on": "top", "displacement": ["free", "-1e-3*t"]}, {"on": "left", "traction": [1e3, 0.0]}],
        "contact": {"on": "bottom", "normal": {"law": "signorini"}},
    }
    made = amontons.Case(case)
    with pytest.raises(amontons.StepError) as caught:
        amontons.run(made)
    path = tmp_path / "loose.toml"
    path.write_text(made.text)
    expected = json.loads(program("run", path, "--format", "json", "--out", tmp_path / "out", code=3).stdout)
    assert caught.value.args[0] == expected["error"]["message"]
    assert caught.value.result.summary["steps"] == expected["summary"]["steps"] == 0
    assert caught.value.hint in expected["error"]["hint"] and "a support or a spring" in caught.value.hint
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is amontons.StepError and (str(again), again.hint) == (str(caught.value), caught.value.hint)


def test_arguments(paper, tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere.toml"):
        amontons.run(tmp_path / "nowhere.toml")
    with pytest.raises(TypeError, match="case: found int, expected a path"):
        amontons.run(7)
    with pytest.raises(amontons.RequestError, match="threads: found 0, expected a positive number"):
        amontons.run(paper, SMALL, threads=0)
    # More than a machine takes: none of them is started.
    with pytest.raises(amontons.ThreadsError, match="cannot start 1000000 threads: at most"):
        amontons.run(paper, SMALL, threads=10**6)
    with pytest.raises(TypeError, match="callback: found int, expected a function"):
        amontons.run(paper, SMALL, callback=3)
    with pytest.raises(amontons.RequestError, match="found None, expected a number, a text"):
        amontons.run(paper, mesh__n=None)
    with pytest.raises(amontons.RequestError, match="levels: found"):
        amontons.converge(paper, [0, 4])
    with pytest.raises(amontons.RequestError, match='reference: found .other., expected a level or "exact"'):
        amontons.converge(paper, [2, 4], reference="other")
    with pytest.raises(amontons.RequestError, match='vary: found "all"'):
        amontons.converge(paper, [2, 4], vary="all")
    with pytest.raises(amontons.RequestError, match="expected"):
        amontons.converge(paper, [8, 4], SMALL)
    with pytest.raises(amontons.RequestError, match="no case file, no results folder and no benchmark"):
        amontons.verify("no-such-benchmark")
    with pytest.raises(amontons.RequestError, match="each: found no values of mesh.n"):
        amontons.sweep(paper, {"mesh.n": []})

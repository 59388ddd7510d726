"""Sweeps: the same frame, bit for bit, wherever the runs are made."""

import concurrent.futures
import pickle

import pandas as pd
import pytest

import amontons
from conftest import SMALL
from mylaws import Coulomb
from test_run import read

EACH = {"contact.friction.coefficient": [0.1, 0.2], "mesh.n": [4, 8]}
# What differs from run to run.
TIMES = ["seconds"]


def force(result):
    return {"force": result.summary["final"]["contact"]["force"][1]}


@pytest.fixture(scope="module")
def here(paper):
    return amontons.sweep(paper, EACH, SMALL)


def same(found, expected):
    pd.testing.assert_frame_equal(found.drop(columns=TIMES), expected.drop(columns=TIMES), check_exact=True)


def test_the_figures_are_those_of_the_program(here, paper, program, tmp_path):
    sets = [f"--set={key}={value}" for key, value in SMALL.items() if key != "mesh.n"]
    each = ["--each", "contact.friction.coefficient=0.1,0.2", "--each", "mesh.n=4,8"]
    program("run", paper, *sets, *each, "--no-certificate", "--out", tmp_path / "out", "--quiet")
    expected = read(tmp_path / "out" / "sweep.csv")
    assert list(here["outcome"]) == list(expected["outcome"]) == ["done"] * 4
    figures = [name for name in expected.columns if name.startswith(("final.", "energy."))]
    assert len(figures) > 20
    for name in [*EACH, "steps", *figures]:
        assert here[name].to_numpy(float).tobytes() == expected[name].to_numpy(float).tobytes(), name


def test_processes(here, paper):
    with concurrent.futures.ProcessPoolExecutor(2) as executor:
        same(amontons.sweep(paper, EACH, SMALL, executor=executor), here)
        own = amontons.sweep(
            paper, EACH, SMALL, executor=executor, laws={"friction": Coulomb(0.3)}, figures=force
        )
    assert list(own["force"]) == list(own["final.contact.force.1"])
    # The law takes the place of the coefficients.
    assert own["force"][0] == own["force"][2] != here["final.contact.force.1"][0]


def test_threads(here, paper):
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        same(amontons.sweep(paper, EACH, SMALL, executor=executor), here)


def test_dask(here, paper):
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        same(amontons.sweep(paper, EACH, SMALL, executor=client), here)


def test_a_run_that_fails_does_not_end_the_sweep():
    case = {
        "name": "loose",
        "mesh": {"kind": "rectangle", "size": [1, 1], "n": 2},
        "time": {"end": 1, "steps": 2},
        "material": {"density": 0.0, "elasticity": {"law": "isotropic", "young": 1e6, "poisson": 0.3, "stress_state": "plane-strain"}},
        "boundary": [{"on": "top", "displacement": ["free", "-1e-3*t"]}, {"on": "left", "traction": [1e3, 0.0]}],
        "contact": {"on": "bottom", "normal": {"law": "signorini"}},
    }
    frame = amontons.sweep(case, {"material.density": [0.0, 1000.0]})
    assert frame["outcome"][0] != "done" and frame["message"][0]
    assert frame["outcome"][1] == "done" and frame["message"][1] == ""


def test_faults_come_before_the_first_run(paper):
    with pytest.raises(amontons.CaseError, match="mesh.n"):
        amontons.sweep(paper, {"mesh.n": [4, 0]}, SMALL)


def test_cases_are_picklable(paper):
    case = amontons.Case(paper, SMALL)
    again = pickle.loads(pickle.dumps(case))
    assert again.text == case.text and amontons.run(again).summary["final"] == amontons.run(case).summary["final"]

"""A run from Python has the numbers of the program, bit for bit, and the results are what they say."""

import csv
import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pandas as pd
import pytest

import amontons
from conftest import ROOT, SMALL


@pytest.fixture(scope="module")
def result(paper):
    return amontons.run(paper, SMALL)


@pytest.fixture(scope="module")
def folder(paper, program, tmp_path_factory):
    out = tmp_path_factory.mktemp("program") / "paper"
    sets = [f"--set={key}={value}" for key, value in SMALL.items()]
    program("run", paper, *sets, "--out", out, "--quiet")
    return out


def read(path):
    """A table with the numbers that it was written from."""
    with open(path, newline="") as file:
        names, *rows = csv.reader(file)
    columns = {name: list(values) for name, values in zip(names, zip(*rows))}
    return pd.DataFrame({name: _numbers(values) for name, values in columns.items()})


def _numbers(values):
    try:
        return [float(value) if value else np.nan for value in values]
    except ValueError:
        return values


def same(found, expected):
    """Frames with the same columns, rows and bits."""
    assert list(found.columns) == list(expected.columns)
    assert len(found) == len(expected) > 0
    for name in expected.columns:
        if expected[name].dtype.kind == "f":
            assert found[name].to_numpy(float).tobytes() == expected[name].to_numpy(float).tobytes(), name
        else:
            assert list(found[name]) == list(expected[name]), name


def test_history_has_the_bits_of_the_program(result, folder):
    same(result.history, read(folder / "history.csv"))
    assert result.history["slip"].dtype.kind == "i"


def test_contact_has_the_bits_of_the_program(result, folder):
    same(result.snapshots[-1].contact, read(folder / "contact.csv"))
    every = result.contact
    assert sorted(set(every["step"])) == [4, 8]
    at_4 = every[every["step"] == 4].drop(columns=["step", "t"]).reset_index(drop=True)
    [table] = [path for path in (folder / "contact").glob("*.csv") if "4" in path.stem]
    same(at_4, read(table))


def test_summary_has_the_bits_of_the_program(result, folder):
    expected = json.loads((folder / "summary.json").read_text())
    for key in ("final", "energy", "unknowns", "findings", "warnings", "steps", "time", "outcome"):
        assert result.summary[key] == expected[key], key


def test_fields_have_the_bits_of_the_program(result, folder):
    meshio = pytest.importorskip("meshio")
    last = ElementTree.parse(folder / "fields.pvd").getroot().findall(".//DataSet")[-1].attrib["file"]
    grid = meshio.read(folder / last)
    nodes = len(grid.points)
    assert np.array_equal(result.mesh.points, grid.points)
    for name in ("displacement", "velocity"):
        assert result.fields[name].shape == (nodes, 2)
        assert np.array_equal(result.fields[name], grid.point_data[name][:, :2])
    assert np.array_equal(result.fields["temperature"], grid.point_data["temperature"])
    for name in ("stress", "von_mises"):
        assert np.array_equal(result.fields[name], np.concatenate(grid.cell_data[name]))
    [cells] = result.mesh.cells
    assert np.array_equal(cells.nodes, grid.cells[0].data)


def test_results_do_not_depend_on_threads(paper, result):
    other = amontons.run(paper, SMALL, threads=1, certificate=False)
    same(other.history, result.history)


def test_fields_are_views_that_live_as_long_as_they_are_used(paper):
    result = amontons.run(paper, SMALL, mesh__n=4)
    u = result.fields["displacement"]
    assert not u.flags.owndata and not u.flags.writeable
    # Twice the same memory: nothing is copied.
    assert np.shares_memory(u, result.fields["displacement"])
    expected = u.tobytes()
    del result
    assert u.tobytes() == expected
    with pytest.raises(ValueError):
        u[0, 0] = 1.0
    with pytest.raises(ValueError):
        u.flags.writeable = True


def test_overrides_by_dict_by_keyword_and_by_case_agree(paper):
    by_dict = amontons.run(paper, {**SMALL, "boundary[1].traction": [1.0, 0.5], "contact.friction.coefficient": 0.3})
    by_keyword = amontons.run(
        paper, SMALL, boundary__1__traction=np.array([1.0, 0.5]), contact__friction__coefficient=np.float64(0.3)
    )
    by_case = amontons.run(amontons.Case(paper, SMALL), boundary__1__traction=(1.0, 0.5)).summary["final"]
    same(by_keyword.history, by_dict.history)
    assert by_case != by_dict.summary["final"]


BLOCK = {
    "name": "block",
    "mesh": {"kind": "rectangle", "size": [0.02, 0.01], "n": [8, 4]},
    "time": {"end": 1.0, "steps": 5},
    "material": {
        "density": 0.0,
        "elasticity": {"law": "isotropic", "young": 5e6, "poisson": 0.45, "stress_state": "plane-strain"},
    },
    "boundary": [{"on": "top", "displacement": ["1e-3*t", "-5e-4*min(1, 5*t)"]}],
    "contact": {"on": "bottom", "normal": {"law": "signorini"}, "friction": {"law": "coulomb", "coefficient": 0.5}},
    "probe": [{"name": "pull", "quantity": "traction_x", "on": "bottom", "take": "integral"}],
}


def test_a_dict_is_a_case(program, tmp_path):
    result = amontons.run(BLOCK)
    case = amontons.Case(BLOCK)
    path = tmp_path / "block.toml"
    path.write_text(case.text)
    program("run", path, "--out", tmp_path / "out", "--quiet")
    same(result.history, read(tmp_path / "out" / "history.csv"))
    same(result.probes, read(tmp_path / "out" / "probes.csv"))
    assert amontons.run(case.text).summary["final"] == result.summary["final"]
    # A case without heat has no temperature.
    assert "temperature" not in result.fields
    with pytest.raises(KeyError):
        result.fields["temperature"]
    assert result.contact["temperature"].isna().all()


def test_out_writes_the_usual_folder(paper, folder, tmp_path):
    result = amontons.run(paper, SMALL, out=tmp_path / "out")
    for name in ("history.csv", "contact.csv", "case.toml"):
        assert (tmp_path / "out" / name).read_bytes() == (folder / name).read_bytes(), name
    assert result.folder == str(tmp_path / "out")
    assert amontons.verify(result.folder).holds
    assert any(path.endswith("deformed.png") for path in amontons.plot(result.folder))
    with pytest.raises(amontons.ResultsError, match="holds"):
        amontons.run(paper, SMALL, out=tmp_path / "out")
    amontons.run(paper, SMALL, out=tmp_path / "out", force=True)


def test_pictures_are_those_of_the_program(result, folder, program):
    program("plot", folder)
    for kind in ("deformed", "temperature", "von-mises", "contact", "history"):
        picture = result.picture(kind)
        assert picture.png.startswith(b"\x89PNG") and picture.svg.startswith("<svg"), kind
    assert result.picture("history").svg == (folder / "plots" / "history.svg").read_text()
    with pytest.raises(amontons.RequestError, match='found the picture "stress", expected one of "deformed"'):
        result.picture("stress")
    with pytest.raises(amontons.RequestError, match="found the snapshot 7, expected one of 3"):
        result.picture(snapshot=7)


def test_notebooks_show_a_result(result):
    text = result._repr_html_()
    assert "<svg" in text and "paper" in text and "closing_error" not in text
    assert f"{result.summary['final']['temperature_max']:.6g}" in text


def test_pyvista(result):
    pytest.importorskip("pyvista")
    grid = result.to_pyvista()
    assert grid.n_points == 81 and grid.n_cells == 128
    assert np.array_equal(grid.point_data["displacement"][:, :2], result.fields["displacement"])
    assert np.array_equal(grid.cell_data["von_mises"], result.fields["von_mises"])
    # Areas of the cells add up to the unit square.
    assert abs(grid.compute_cell_sizes().cell_data["Area"].sum() - 1.0) < 1e-12


def test_missing_packages_are_named(result, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "pandas", None)
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(ModuleNotFoundError, match=r'needs the package pandas.*pip install "amontons\[frames\]"'):
        result.history
    with pytest.raises(ModuleNotFoundError, match="needs the package pyvista"):
        result.to_pyvista()


def test_check_has_what_the_program_prints(paper, program):
    found = amontons.check(paper, SMALL)
    sets = [f"--set={key}={value}" for key, value in SMALL.items()]
    expected = json.loads(program("check", paper, *sets, "--format", "json").stdout)
    assert found.findings == expected["findings"] and found.constants == expected["constants"]
    assert found.skipped == expected["skipped"] == []
    assert not found.holds and "H3" in set(found.table["id"])
    assert "<table>" in found._repr_html_()


def test_converge_has_the_numbers_of_the_program(paper, program, tmp_path):
    study = amontons.converge(paper, [4, 8], SMALL, reference=16)
    elastic = study.values["elastic"]
    assert [level["level"] for level in elastic] == [4, 8, 16]
    assert (elastic[-1]["order"] is None) == bool(elastic[-1]["remark"])
    assert set(study.values_table["quantity"]) == set(study.values)
    sets = [f"--set={key}={value}" for key, value in SMALL.items()]
    arguments = ["--levels", "4,8", "--reference", "16", "--out", tmp_path / "study", "--quiet"]
    program("converge", paper, *sets, *arguments)
    expected = json.loads((tmp_path / "study" / "convergence.json").read_text())
    assert study.rows == expected["rows"] and list(study.table["level"]) == [4, 8]
    assert list(study.slopes.items()) == [tuple(slope) for slope in expected["slopes"]]
    amontons.converge(paper, [4, 8], SMALL, reference=16, out=tmp_path / "other")
    assert (tmp_path / "other" / "convergence.csv").read_bytes() == (tmp_path / "study" / "convergence.csv").read_bytes()


def test_verify():
    found = amontons.verify("rod-on-spring", "capstan")
    assert found.holds and set(found.table["benchmark"]) == {"rod-on-spring", "capstan"}
    spoiled = BLOCK | {"expected": {"tolerance": 1e-6, "values": {"final.displacement_max": [0.5, 0.5]}}}
    assert not amontons.verify(amontons.Case(spoiled)).holds
    assert ROOT.name and len(amontons.benchmarks()) > 100


ROD = {
    "name": "rod",
    "units": "dimensionless",
    "mesh": {"kind": "interval", "size": 1.0, "n": 4},
    "time": {"end": 1.0, "steps": 4},
    "material": {"density": 0.0, "elasticity": {"law": "isotropic", "young": 2.0, "poisson": 0.0}},
    "boundary": [{"on": "left", "displacement": ["0.5*t"]}],
    "contact": {"on": "right", "gap": 0.1, "normal": {"law": "compliance", "stiffness": 3.0}},
}


def test_numbers_come_with_bars():
    # With the body force f = 1 the stress is σ₁ + f (1 − x), σ₁ = −c (U − g + f/(2E))/(1 + c/E) = −0.78.
    case = amontons.Case({**ROD, "load": {"body_force": [1.0]}})
    exact = (0.22**3 + 0.78**3) / 12
    found = case.accurate("elastic", 0.01)
    assert found["reached"] and found["why"] is None
    goal = found["levels"][-1]["goals"][0]
    assert goal["name"] == "elastic" and goal["t"] == 1.0
    assert abs(goal["value"] - exact) <= goal["bar"] <= 0.01 * exact
    assert {row["t"] for row in found["bars"] if row["name"] == "contact_force_x"} >= {0.5, 1.0}
    with pytest.raises(amontons.RequestError, match="between 0 and 1"):
        case.accurate("elastic", 2)
    with pytest.raises(amontons.RequestError, match="nothing"):
        case.accurate(["elastic", "nothing"], 0.01)


def test_gradient_is_that_of_a_formula():
    # u = (E U/L + c g)/(E/L + c), p = c (E/L) (U − g)/(E/L + c)
    e, c, u, g = 2.0, 3.0, 0.5, 0.1
    keys = ["material.elasticity.young", "contact.normal.stiffness", "contact.gap"]
    value, slopes = amontons.Case(ROD).gradient("final.contact.force.0", keys)
    sum_, p = e + c, c * e * (u - g) / (e + c)
    exact = [-c * c * (u - g) / sum_**2, -e * e * (u - g) / sum_**2, c * e / sum_]
    assert value == pytest.approx(-p, rel=1e-12) and slopes == pytest.approx(exact, rel=1e-9)
    values, table = amontons.Case(ROD).gradient(["final.contact.force.0"], keys[:1])
    assert values.shape == (1,) and table.shape == (1, 1) and table[0, 0] == slopes[0]
    with pytest.raises(amontons.RequestError, match="contact.gapp: found no value"):
        amontons.Case(ROD).gradient("final.contact.force.0", ["contact.gapp"])


def test_fit_finds_what_made_the_data():
    # The springs c and E/L are in series: p = K (U t − g) with 1/K = 1/c + L/E.
    c, u, g = 2.5, 0.5, 0.1
    k = 1 / (1 / c + 1 / 2.0)
    times = [0.5, 0.75, 1.0]
    data = {"t": times, "contact_force_x": [-k * (u * t - g) for t in times]}
    stiffness = "contact.normal.stiffness"
    found = amontons.Case(ROD).fit(data, [stiffness], bounds={stiffness: (0.5, None)})
    assert found["parameters"][0]["value"] == pytest.approx(c, rel=1e-7)
    assert found["ending"] == "minimum" and found["combinations"][0]["is_determined"]
    values, _ = found["case"].gradient(["final.contact.force.0"], [stiffness])
    assert values[0] == pytest.approx(data["contact_force_x"][-1], rel=1e-7)
    both = amontons.Case(ROD).fit(data, [stiffness, "material.elasticity.young"])
    assert both["parameters"][0]["interval"] is None
    with pytest.raises(amontons.RequestError, match="bounds: found the key 'contact.gap'"):
        amontons.Case(ROD).fit(data, [stiffness], bounds={"contact.gap": (0, 1)})
    with pytest.raises(amontons.RequestError, match="data: found no column beside the times"):
        amontons.Case(ROD).fit({"t": [1.0]}, [stiffness])


def test_modes_are_those_of_a_benchmark():
    found = amontons.Case(ROOT / "crates/amontons/benchmarks/squeal-block.toml").modes()
    assert found["missing"] == 0 and found["points"]["slip"] == 5
    growth = [mode["growth"] for mode in found["modes"]]
    assert max(growth) == pytest.approx(0.0421632414935, rel=1e-8)


def test_modes_have_derivatives():
    block, key = ROOT / "crates/amontons/benchmarks/squeal-block.toml", "contact.friction.coefficient"

    def growth(found):
        return max(mode["growth"] for mode in found["modes"])

    found = amontons.Case(block).modes(wrt=[key])
    mu = found["parameters"][key]
    low, high = (growth(amontons.Case(block, {key: mu + h}).modes()) for h in (-1e-4, 1e-4))
    mode = max(found["modes"], key=lambda mode: mode["growth"])
    assert mode["by"][key]["growth"] == pytest.approx((high - low) / 2e-4, rel=1e-5)
    with pytest.raises(amontons.RequestError, match="contact.friction.coeff"):
        amontons.Case(block).modes(wrt=["contact.friction.coeff"])

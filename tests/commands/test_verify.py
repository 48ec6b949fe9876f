"""The shipped cases: every one comes out, and a wrong input or number is told."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.soak import quick

from rocking_cli.commands import requirements as traced
from rocking_cli.commands import shipped_cases as room
from rocking_cli.commands.shipped_cases import Comparison, page, shipped_cases

CASES = shipped_cases()
TWO_PI = 2.0 * math.pi
# p [rad/s], alpha [rad] and eta of the blocks of PEER 2001/07
PEER_2 = (2.0, math.radians(15.0), 0.8995)
PEER_1 = (1.0, math.radians(15.0), 0.8995)


@pytest.fixture
def in_process(rocking, monkeypatch):
    """The command of a case runs in this process, which is there at once."""

    def run(call, cwd, **_):
        return rocking(*call[3:], folder=cwd)

    monkeypatch.setattr(room, "subprocess", SimpleNamespace(run=run))


@pytest.mark.usefixtures("in_process")
@pytest.mark.parametrize(
    "case",
    quick(CASES, *(case for case in CASES if case.name != "Cosine, p = 1 rad/s")),
    ids=lambda case: case.name,
)
def test_a_case_comes_out_as_its_source_says(case, tmp_path):
    found = list(case.run(tmp_path / "case"))
    assert found
    assert not [one.row() for one in found if not one.passed]


# in a text or in the command: what stands there, and what is put in its place
WRONG = {
    "Block": ("width: 0.5 m", "width: 0.6 m"),
    "Thin conical spire": ("height: 12 m", "height: 12.1 m"),
    "Oppenheim's arch of seven voussoirs": ("voussoirs: 7", "voussoirs: 8"),
    "Semicircular arch that does not": ("1.07478 m", "1.07479 m"),
    "Columns and a cap": ("cap_ratio: 1.2", "cap_ratio: 1.3"),
    "Envelope under half a sine": ("half-sine", "cosine"),
    "Sine, 1 x 3 m": ("linear", "nonlinear"),
    "Block that slides under a constant push": ("friction: 0.3", "friction: 0.31"),
    "Fragility of counts": ("0.9,40,12", "0.9,40,13"),
    "Measures of a record": ("0.1,2", "0.1,2.1"),
}


@pytest.mark.usefixtures("in_process")
@pytest.mark.parametrize(
    "name",
    quick(WRONG, *WRONG.keys() - {"Envelope under half a sine", "Sine, 1 x 3 m"}),
)
def test_a_case_with_another_input_fails(name, tmp_path):
    (case,) = (one for one in CASES if one.name == name)
    before, after = WRONG[name]
    changed = replace(
        case,
        files={key: text.replace(before, after) for key, text in case.files.items()},
        command=case.command.replace(before, after),
    )
    assert changed != case
    assert not all(one.passed for one in changed.run(tmp_path / "case"))


def test_the_command_tells_a_wrong_number_and_keeps_inputs_and_page(
    rocking, tmp_path, monkeypatch
):
    right = CASES[0]
    (first, *others) = right.numbers
    wrong = replace(
        right, name="<wrong>", numbers=(first._replace(expected=1.0), *others)
    )
    monkeypatch.setattr(room, "shipped_cases", lambda: [right, wrong])
    folder = tmp_path / "verified"
    done = rocking("verify", "-o", str(folder), "--json")
    assert done.returncode == 1
    assert "not so: <wrong>" in done.stderr
    assert [*folder.iterdir()]
    text = (folder / "page.html").read_text(encoding="utf-8")
    assert text.count('class="no"') == 1
    assert "&lt;wrong&gt;" in text
    assert text.count(f"rocking {right.command}") == 2  # once for all numbers of a case
    assert (folder / "01-block" / "block.yaml").read_text() == right.files["block.yaml"]
    again = rocking("verify", "-o", str(folder))
    assert (again.returncode, "exists" in again.stderr) == (2, True)


def test_each_requirement_names_a_module_a_test_and_cases_and_each_case_has_one(
    rocking, tmp_path, monkeypatch
):
    equations = {case.name: case.equation for case in CASES}
    rows = list(traced.marked(traced.TESTS))
    assert {row["case"] for row in rows} == set(equations)
    assert len(rows) == len({row["case"] for row in rows})
    package = traced.TESTS.parent / "rocking_cli"
    assert all((package / row["module"]).is_file() for row in rows)
    printed = rocking("verify", "--trace", "--json").records
    assert printed == traced.requirements(equations)
    (first, *_) = [row for row in printed if row["case"] == "Block"]
    assert first["equation"] == equations["Block"]
    assert first["test"].startswith("tests/structures/kinds/test_rigid_bodies.py::")
    # an installed package has the rows that were written when it was built
    (shipped := tmp_path / "requirements.json").write_text(json.dumps(rows))
    monkeypatch.setattr(traced, "SHIPPED", shipped)
    monkeypatch.setattr(traced, "TESTS", tmp_path)
    assert traced.requirements(equations) == printed


def test_a_number_that_is_missing_is_not_passed():
    missing = Comparison(CASES[0], "p", 1.0, 1e9, None)
    assert not missing.passed
    assert 'class="no"' in page([missing], {}, [])


def falls_by_dop853(p, alpha, eta, omega, amplitude):
    """Whether a block overturns under one cosine of this amplitude [g], Eq. 2.3."""

    def fall(t, state, side):
        drive = amplitude * math.cos(omega * t) * (t <= TWO_PI / omega)
        tilt = side * alpha - state[0]
        return [state[1], -p * p * (math.sin(tilt) + drive * math.cos(tilt))]

    def impact(t, state, side):
        return state[0] if t > 0.0 else -side

    def over(t, state, side):
        return abs(state[0]) - 0.5 * math.pi

    impact.terminal = over.terminal = True
    t, state, side = 0.0, [0.0, 0.0], -1.0
    for _ in range(12):
        impact.direction = -side
        for stop in (TWO_PI / omega, 60.0):
            if stop <= t:
                continue
            found = solve_ivp(
                fall,
                (t, stop),
                state,
                method="DOP853",
                rtol=1e-11,
                atol=1e-13,
                events=(impact, over),
                args=(side,),
            )
            t, state = float(found.t[-1]), found.y[:, -1]
            if found.t_events[1].size:
                return True
            if found.t_events[0].size:
                break
        state, side = np.array([0.0, eta * state[1]]), -side
    return False


@pytest.mark.requirement(
    "Thresholds of the nonlinear equation are those of another solver",
    "dynamics/equations/rigid_body.py",
    "Cosine, p = 2 rad/s",
    "Cosine, p = 1 rad/s",
)
@pytest.mark.parametrize(
    ("block", "threshold"), [(PEER_2, 0.315030), (PEER_1, 0.530715)]
)
def test_another_solver_finds_the_thresholds_under_a_cosine(block, threshold):
    below, above = (
        falls_by_dop853(*block, math.pi, threshold * (1.0 + change))
        for change in (-1e-4, 1e-4)
    )
    assert (below, above) == (False, True)

"""Axes of a sweep: units, spacing and refusals."""

import inspect
import math

import numpy as np
import pytest
from support.documents import built
from support.refusals import refuses

import rocking_cli
from rocking_cli import Axis, Grid, UsageError, dimensionless_oscillator, parse_grid


def test_units_and_spacing():
    grid = parse_grid("a_g=0.1g:1g:10,omega_g=1:100:3:log")
    np.testing.assert_allclose(grid.amplitude.values, np.linspace(0.981, 9.81, 10))
    np.testing.assert_allclose(grid.frequency.values, [1, 10, 100])
    assert grid.shape == (3, 10)
    hertz = parse_grid("f_g=0.5:2:4,a_g=1:2:2").frequency
    np.testing.assert_allclose(hertz.values, 2 * math.pi * np.linspace(0.5, 2, 4))
    period = parse_grid("a_g=1:2:2,T_g=0.5:2:4").frequency
    np.testing.assert_allclose(
        period.values, 2 * math.pi / np.array([2, 1.5, 1, 0.5])
    )  # they rise
    assert period.name == "omega_g"


def test_scaling_to_a_structure():
    body = built(
        "kind: parameters\np: 2\nalpha: 0.1\neta: 0.9\nlambda: 0.2\ngravity: 10"
    )
    a, omega = parse_grid("a_g=2:4:2,omega_g=6:8:2").scaled(body)
    np.testing.assert_allclose(a, np.array([2, 4]) * 0.5 / (0.1 * 10))
    np.testing.assert_allclose(omega, [3, 4])


REFUSED = [
    ("A", "expected NAME=START"),
    ("A=1:2:3", "found A; expected A and Omega"),
    ("A=1:2:3,f_g=1:2:3", "found A and f_g"),
    ("A=1:2:3,A=1:2:3,Omega=1:2:3", "twice"),
    ("omega_g=1:2:3,f_g=1:2:3,a_g=1", "twice"),
    ("A=1:2:3,Omga=1:2:3", "unknown axis 'Omga'"),
    ("A=1:2:3:lin,Omega=1:2:3", "START:STOP:N"),
    ("A=2:1:3,Omega=1:2:3", "found START 2 and STOP 1"),
    ("A=1:1:3,Omega=1:2:3", "a single value is written"),
    ("A=1:2:1,Omega=1:2:3", "N = '1'"),
    ("A=-1:2:3,Omega=1:2:3", "positive values or zero"),
    ("A=1:2:3,Omega=0:2:3", "positive values"),
    ("A=0:2:3:log,Omega=1:2:3", "a positive START"),
    ("A=1:inf:3,Omega=1:2:3", "found 'inf'"),
    ("A=1:2g:3,Omega=1:2:3", "without a unit"),
    ("a_g=1:2kg:3,omega_g=1:2:3", "an acceleration"),
    ("A=1:2:1000000,Omega=1:2:1000000", "1e.12 cells"),
    ("A=1:2:100000000000,Omega=1:2:2", "from 2 to 10000000"),
]
test_refusals = refuses(parse_grid, UsageError, REFUSED)


def test_axes_check_themselves():
    with pytest.raises(UsageError, match="rise"):
        Axis("A", np.array([2.0, 1.0]))
    with pytest.raises(UsageError, match="positive"):
        Axis("Omega", np.array([0.0, 1.0]))
    with pytest.raises(UsageError, match="do not go together"):
        Grid(Axis("a_g", np.ones(1)), Axis("Omega", np.ones(1)))


def test_a_motion_with_a_time_of_its_own_has_one_axis():
    """Its frequency is 1 rad/s; A is that of each structure, and Omega 1/p."""
    block = built("{kind: block, width: 0.5, height: 2}")
    a, omega = parse_grid("A=1:2:3", own_time=True).scaled(block)
    assert a.tolist() == [1.0, 1.5, 2.0]
    assert omega == pytest.approx([1.0 / block.p], rel=1e-14)
    assert not parse_grid("A=1:2:3", own_time=True).dimensionless
    a, _ = parse_grid("a_g=2", own_time=True).scaled(block)
    assert a == pytest.approx(block.dimensionless_amplitude(np.array([2.0])), rel=1e-14)
    for text in ("A=1:2:3,Omega=1", "a_g=1,T_g=1", "T_g=1"):
        with pytest.raises(
            UsageError, match="expected A or a_g, since a record runs in its own time"
        ):
            parse_grid(text, own_time=True)


@pytest.mark.parametrize("axes", ["a_g=5,f_g=1e10", "A=2,Omega=1.1e10"])
def test_frequencies_at_which_nothing_is_left_of_the_motion_are_refused(axes):
    body = (
        dimensionless_oscillator(eta=0.9)
        if "Omega" in axes
        else built("kind: block\nwidth: 0.5\nheight: 2")
    )
    with pytest.raises(UsageError, match="expected a value up to 1e\\+10"):
        parse_grid(axes).scaled(body)
    assert (
        parse_grid(axes.replace("1e10", "1e9").replace("1.1e9", "1e10")).scaled(body)[1]
        <= 1e10
    )


BLOCK = "kind: block\nwidth: 0.5\nheight: 2"


def test_every_public_function_of_one_demand_refuses_a_grid_of_several_cells(tmp_path):
    """A function that takes the demand calls it `shaking`; those that compute a grid
    call it `grid`.
    """
    block, motion = built(BLOCK), rocking_cli.sine()
    given = {
        "structure": block,
        "structures": [block],
        "motion": motion,
        "documents": rocking_cli.parse_documents(BLOCK),
        "target": tmp_path / "r.html",
    }
    given |= {"spectrum": tmp_path / "s.h5"}
    given |= {"document": BLOCK, "varied": "width=1:2:2", "shakes": motion}
    asked = {
        name: function
        for name in dir(rocking_cli)
        if inspect.isfunction(function := getattr(rocking_cli, name))
        and "shaking" in inspect.signature(function).parameters
    }
    assert {"check", "time_history", "compare", "code_check", "report"} <= asked.keys()
    rocking_cli.write_spectrum(
        [dimensionless_oscillator(eta=0.9)],
        motion,
        parse_grid("A=1:4:5,Omega=1:8:5"),
        tmp_path / "s.h5",
        workers=1,
    )
    for name, function in asked.items():
        wanted = [
            x.name
            for x in inspect.signature(function).parameters.values()
            if x.default is x.empty or x.name == "motion"
        ]
        dimensionless = name == "predict"
        for axes in (
            ("A=1:2:2,Omega=6", "A=1,Omega=6:7:3")
            if dimensionless
            else ("a_g=0.3g,f_g=0.5:5:3", "a_g=0.2g:0.3g:2,f_g=1")
        ):
            mine = given | (
                {"structure": dimensionless_oscillator(eta=0.9)}
                if dimensionless
                else {}
            )
            arguments = {key: mine[key] for key in wanted if key != "shaking"}
            with pytest.raises(
                UsageError,
                match=(
                    r"found a grid of \d frequencies and \d amplitudes; expected one of"
                    r" each"
                ),
            ):
                function(**arguments, shaking=parse_grid(axes))

"""Remarks on what can be right and mostly is not."""

import pytest
from support.documents import built

from rocking_cli import RockingParameters, parse_grid
from rocking_cli.reports.plausibility import (
    grid_remarks,
    span_remarks,
    structure_remarks,
)


def test_a_block_500_wide_is_said_to_be_large():
    (said,) = structure_remarks(
        built("kind: block\nname: Column\nwidth: 500 m\nheight: 2000 m")
    )
    # p^2 = 3 g/(4 R), so the block of equal p is itself, 2062 m from corner to corner.
    assert (
        said
        == "Column: as large as a block of 2.06e+03 m from corner to corner; a length"
        " without a unit is in m"
    )
    assert "gravity: 981 without a unit" in next(
        structure_remarks(built("kind: block\nwidth: 0.5\nheight: 2\ngravity: 981"))
    )
    assert "as small as a block of 0.00206 m" in next(
        structure_remarks(built("kind: block\nwidth: 0.5 mm\nheight: 2 mm"))
    )
    for p, said in (
        (1e200, "small as a block of 0 m"),
        (1e-200, "large as a block of inf m"),
    ):  # p^2 is no double
        assert said in next(
            structure_remarks(
                RockingParameters(
                    name="Column",
                    structure="block",
                    p=p,
                    alpha=0.2,
                    eta=0.9,
                    uplift=0.2,
                    a_scale=1.0,
                )
            )
        )


def test_an_eta_below_0_3_is_said_what_it_means():
    text = "kind: block\nname: Column\nwidth: 0.5\nheight: 2\nrestitution: "
    assert list(structure_remarks(built(text + "0.3"))) == []
    assert list(structure_remarks(built(text + "0.1"))) == [
        "Column: eta = 0.1, so that every impact takes 99% of the energy; tests mostly"
        " show less"
    ]
    assert list(structure_remarks(built(text + "-0.1\none_sided: true"))) == []


@pytest.mark.parametrize(
    ("axes", "said"),
    [
        (
            "a_g=99,f_g=1",
            ["a_g = 99 m/s2 is 10.1 g; a number without a unit is in m/s2"],
        ),
        ("a_g=1:98:3,f_g=1", []),
        ("a_g=10g,f_g=1", []),
        ("A=200,Omega=1", []),
    ],
)
def test_an_amplitude_beyond_10_g_is_said_in_g(axes, said):
    assert list(grid_remarks(parse_grid(axes))) == said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a_g=0.1g:1:3,f_g=1:2:2", ["0.1g:1: 1 without a unit is in SI, not in g"]),
        ("0.1:1 g:3", ["0.1:1 g: 0.1 without a unit is in SI, not in g"]),
        ("a_g=0:1g:3,f_g=1:5:2", []),
        ("a_g=1:2:3", []),
        ("10,15,20deg", []),
    ],
)
def test_a_unit_on_one_bound_alone_is_said(text, said):
    assert list(span_remarks(text)) == said


def test_commands_say_it_once_and_go_on(rocking):
    done = rocking("response", "block:500x2000", "--a-g", "350", "--f-g", "1", "--json")
    assert done.returncode == 0
    assert [line.partition(" ")[0] for line in done.stderr.splitlines()[:2]] == [
        "a_g",
        "block:500x2000:",
    ]
    said = rocking("params", *["block:500x2000"] * 5).stderr.splitlines()
    assert sum("width: 500 without a unit is 500 m" in line for line in said) == 3
    assert "and 2 more such remarks" in said
    assert rocking("params", "block:500x2000", "-q").stderr == ""

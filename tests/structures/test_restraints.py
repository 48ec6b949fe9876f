"""Ties, tendons and dampers: documents, their statics against other forms of the same
equations, and what follows them.
"""

import json
import math

import numpy as np
import pytest
from scipy.optimize import brentq
from support.documents import built
from support.refusals import refuses

from rocking_cli import (
    Method,
    build_structure,
    check,
    parse_documents,
    parse_grid,
    response,
    sine,
    write_spectrum,
)
from rocking_cli.envelopes.intervals import check_curves, frequency_axis
from rocking_cli.errors import DocumentError, UsageError
from rocking_cli.reports.device_words import device_in_words
from rocking_cli.spectra.file.reader import SpectraFile
from rocking_cli.structures import RockingParameters
from rocking_cli.structures.family import family
from rocking_cli.structures.kinds import sketch_of
from rocking_cli.structures.restraints import Tie

WALL = "kind: wall\nthickness: 0.6 m\nheight: 6 m\none_sided: true\nmass: 7200 kg\n"
TIE = (
    "{height: 5.5 m, stiffness: 2e6 N/m, prestress: 5 kN, yield: 20 kN, ultimate: 30"
    " mm, side: right}"
)
TIED = f"{WALL}ties:\n- {TIE}"
BLOCK = "kind: block\nwidth: 1\nheight: 5\ngravity: 9.8\nmass: 2551.0204081632653\n"
TENDON = (
    "tendon: {area: 144 mm2, modulus: 195 GPa, length: 5 m, prestress: 150 kN, rupture:"
    " 267.84 kN}\n"
)
MOMENT, ALPHA = 7200 * 9.81 * math.hypot(0.3, 3.0), math.atan(0.1)  # m g R of the wall


def tied(**keys):
    return built(
        WALL
        + "ties:\n- {"
        + ", ".join(f"{key}: {value!r}" for key, value in keys.items())
        + "}"
    )


def statics(body):
    (row,) = body.details["restrained"]
    return row


def test_the_tendon_of_a_block_has_the_reference_values():
    # Evaluated independently: p, stiffness after uplift, rotation of rupture; lambda =
    # tan alpha (1 + P0/(m g)) with P0 = 6 m g.
    body = built(BLOCK + TENDON)
    row = statics(body)
    assert (body.p, row["side"]) == (pytest.approx(1.697913, abs=1e-6), "both")
    assert (row["stiffness"], row["lambda"]) == (
        pytest.approx(21.027764, abs=1e-6),
        pytest.approx(0.2 * 7, rel=1e-12),
    )
    # 2 b sin(theta/2) is the elongation that stands in the moment; b sin theta would
    # break it at 0.041978.
    breaks = 2 * math.asin((267840 - 150000) / 5.616e6)
    assert [
        body.restraints.tendon.at(0.5).moment(theta) > 0.0
        for theta in (breaks - 1e-9, breaks + 1e-9)
    ] == [True, False]
    assert row["equilibrium"] == pytest.approx(
        body.alpha, rel=1e-12
    )  # the tendon breaks before, and leaves the free body
    assert (
        statics(built(BLOCK + TENDON.replace(", rupture: 267.84 kN", "")))[
            "equilibrium"
        ]
        == "none"
    )


def test_the_tie_of_a_wall_lifts_at_the_acceleration_of_its_prestress():
    body = built(TIED)
    row = statics(body)
    assert row["lambda"] == pytest.approx(
        0.1 + 5000 * 5.5 / (7200 * 9.81 * 3), rel=1e-12
    )
    assert row["lambda"] > 0.2
    assert row["stiffness"] == pytest.approx(2e6 * 5.5**2 / MOMENT - 1, rel=1e-12)
    free = built(WALL)
    assert (body.p, body.alpha, body.uplift, body.eta) == (
        free.p,
        free.alpha,
        free.uplift,
        free.eta,
    )


def test_a_wall_has_its_mass_from_its_density_and_length():
    found = built(
        WALL.replace("mass: 7200 kg", "density: 2 t/m3\nlength: 1 m")
        + f"ties:\n- {TIE}"
    )
    assert found.details["mass"] == pytest.approx(7200, rel=1e-14)
    assert statics(found)["lambda"] == pytest.approx(
        statics(built(TIED))["lambda"], rel=1e-13
    )
    with pytest.raises(
        DocumentError,
        match="density: found density together with mass; expected one of them",
    ):
        built(WALL + "density: 2000\nlength: 1")


@pytest.mark.parametrize("behind", [0.0, 0.4, -0.05])
def test_the_moment_of_a_tie_is_that_of_its_anchor_moved_with_the_body(behind):
    tie = Tie(5.5, 2e6, 5e3, 20e3, 0.5, behind)
    for theta in (1e-4, 0.002, 0.03, 0.08):
        x, z = (
            np.cos(theta) * -behind + np.sin(theta) * 5.5,
            np.cos(theta) * 5.5 + np.sin(theta) * behind,
        )  # turned clockwise
        force = min(5e3 + 2e6 * (x + behind), 20e3) if x + behind < 0.5 else 0.0
        assert tie.moment(theta) == pytest.approx(force * z, rel=1e-12)


def restoring(theta, stiffness, prestress, force, ultimate):
    """Over m g R, in the form of the equation of motion: tension only, at 5.5 m above
    the pivot.
    """
    u = 5.5 * np.sin(theta)
    tension = np.where(
        u < ultimate, np.clip(prestress + stiffness * u, 0.0, force), 0.0
    )
    return np.sin(ALPHA - theta) + tension * 5.5 * np.cos(theta) / MOMENT


INF = math.inf


@pytest.mark.parametrize(
    "law",
    [
        (1e4, 2e3, INF, INF),
        (2e6, 5e3, 20e3, INF),
        (0.0, 9e3, INF, INF),
        (2e4, 0.0, 12e3, 0.9),
        (2e4, 1e3, 12e3, 1.5),
    ],
)
def test_the_equilibrium_is_where_nothing_brings_the_body_back(law):
    keys = dict(zip(("stiffness", "prestress", "yield", "ultimate"), law, strict=True))
    found, ultimate = (
        statics(
            tied(
                height=5.5, **{key: value for key, value in keys.items() if value < INF}
            )
        )["equilibrium"],
        law[-1],
    )
    scan = np.linspace(0.0, math.pi / 2, 200_001)[1:]
    first = int(np.argmax(restoring(scan, *law) <= 0.0))
    assert scan[first - 1] < found <= scan[first] * (1 + 1e-9)
    if ultimate > 5.5 * math.sin(scan[first]):  # it does not break there
        assert found == pytest.approx(
            brentq(restoring, scan[first - 1], scan[first], args=law, xtol=1e-15),
            rel=1e-9,
        )
    assert found > ALPHA


def test_a_tie_that_breaks_beyond_alpha_leaves_the_body_at_its_rupture():
    found = statics(tied(height=5.5, stiffness=2e5, ultimate=1.1))["equilibrium"]
    assert found == pytest.approx(math.asin(1.1 / 5.5), rel=1e-9)
    assert found > ALPHA
    assert (
        statics(tied(height=5.5, stiffness=2e5))["equilibrium"] > 1.5
    )  # where its lever is gone


def test_a_tie_of_one_side_makes_the_sides_differ():
    text = (
        "kind: block\nwidth: 1\nheight: 5\nmass: 5 t\nties: [{height: 4, stiffness:"
        " 1e5%s}]"
    )
    both, (left, right) = (
        built(text % ""),
        built(text % ", side: right").details["restrained"],
    )
    assert [row["side"] for row in (statics(both), left, right)] == [
        "both",
        "left",
        "right",
    ]
    assert left["lambda"] == pytest.approx(both.uplift, rel=1e-14)
    assert left["stiffness"] == -1.0
    assert left["equilibrium"] == pytest.approx(both.alpha, rel=1e-12)
    assert {**right, "side": "both"} == statics(both)


def test_an_unequal_body_has_the_statics_of_each_edge():
    body = built(
        "kind: rigid\nleft: 0.42\nright: 0.31\nheight: 1.15\ngyration: 0.68\nmass: 2"
        " t\nties: [{height: 9, stiffness: 1 MN/m}]"
    )
    for row, side in zip(body.details["restrained"], body.sides, strict=True):
        assert row["stiffness"] == pytest.approx(
            1e6 * 81 / (2000 * 9.81 * side.arm) - 1, rel=1e-12
        )


def test_heights_count_from_the_ground_and_pivots_move_with_inset_and_interface():
    text = "mass: 5 t\nties: [{height: 2.5, stiffness: 1e5}]\n"
    plain, worn = (
        built("kind: block\nwidth: 1\nheight: 5\n" + text),
        built("kind: block\nwidth: 1\nheight: 5\ninset: 4 cm\n" + text),
    )
    assert (plain.restraints.ties[0].behind, worn.restraints.ties[0].behind) == (
        0.0,
        -0.04,
    )
    pieces = (
        "kind: stack\npieces: [{width: 2, height: 0.5}, {width: 0.4, height: 3}]\n"
        + text
    )
    assert [
        built(f"{pieces}rocks_on: {on}").restraints.ties[0].height for on in (0, 1)
    ] == [2.5, 2.0]
    assert built(
        "kind: block\nwidth: 1.5\nheight: 4\nmass: 1\nties: [{height: 4, stiffness: 1}]"
    ).restraints  # at its top
    frame = built(
        "kind: frame\ncolumns: 4\nwidth: 0.5\nheight: 4\ncap_ratio: 1.5\n" + text
    )
    moment = (
        5000 * 9.81 * math.hypot(0.25, 2) * (1 + 2 * 1.5) / (1 + 1.5)
    )  # the beam has twice the lever
    assert statics(frame)["stiffness"] == pytest.approx(
        1e5 * 2.5**2 / moment - 1, rel=1e-12
    )


def test_a_tie_below_the_interface_that_rocks_does_not_hold_the_pieces_above():
    text = (
        "kind: stack\npieces: [{width: 1, height: 2}, {width: 0.5, height: 2}]\nmass: 2"
        " t\nrocks_on: %d\n"
    )
    ties = "ties: [{height: 1.5, stiffness: 2 MN/m, prestress: 40 kN}]"
    base, upper = (built(text % on + ties) for on in (0, 1))
    assert statics(base)["lambda"] == pytest.approx(
        base.uplift + 4e4 * 1.5 / (2000 * 9.81 * 1.4), rel=1e-12
    )  # mass centre at 1.4 m
    assert (upper.restraints, upper.uplift, upper.details["rocks_on"]) == (
        None,
        0.25,
        "piece 1 from below",
    )


@pytest.mark.slow
def test_a_force_without_a_yield_is_told_over_that_at_rupture():
    held = "kind: block\nwidth: 1\nheight: 5\nmass: 5 t\nrestitution: 0.5\n"
    for text, rupture in (
        ("tendon: {stiffness: 1e6, prestress: 2e4, rupture: 6e4}", 6e4),
        ("ties: [{height: 4, stiffness: 1e6, ultimate: 0.1}]", 1e5),
    ):
        (device,) = check(
            built(held + text), sine(), parse_grid("a_g=0.35g,f_g=1"), a_max=None
        ).devices
        assert 0.0 < device["tie_force"] == device["force"] / rupture < 1.0
        assert " of its rupture)" in device_in_words(device)


def test_dampers_are_a_damping():
    text = (
        "kind: block\nwidth: 1\nheight: 5\nmass: 5 t\ndampers: {coefficient: 2 kN"
        " s/m}\n"
    )
    body = built(text)
    zeta = 1.5 * 2000 / (5000 * body.p) * math.sin(body.alpha) ** 2
    assert body.damping == pytest.approx(zeta, rel=1e-12)
    assert built(text + "damping: 0.02").damping == pytest.approx(
        zeta + 0.02, rel=1e-12
    )
    assert "restrained" not in body.details
    assert built(json.dumps(body.row())) == body
    worn = built(text + "inset: 0.1")  # the near dashpot acts too
    assert worn.damping == pytest.approx(
        2000 * (0.9**2 + 0.1**2) * worn.p / (2 * 5000 * 9.81 * worn.arm), rel=1e-12
    )


@pytest.mark.parametrize(
    "text",
    [
        TIED,
        BLOCK + TENDON,
        f"{BLOCK}inset: 2 cm\nties:\n- {{height: 3, stiffness: 1e4}}\n{TENDON}",
    ],
)
def test_what_is_printed_is_a_document_with_the_same_restraints(text):
    body = built(text)
    assert built(json.dumps(body.row())) == body
    assert (
        RockingParameters.from_row(json.loads(json.dumps(body.row()))).restraints
        == body.restraints
    )


def test_a_drawing_shows_ties_and_tendon():
    (document,) = parse_documents(
        BLOCK + "ties: [{height: 4, stiffness: 1, behind: 0.2, side: right}]\n" + TENDON
    )
    tie, tendon = sketch_of(document, build_structure(document)).lines
    assert tie == (
        "tie",
        ((pytest.approx(-0.5 - 0.15 * 5), 4.0), (pytest.approx(0.3), 4.0)),
    )
    assert tendon == ("tendon", ((0.0, 0.0), (0.0, pytest.approx(5.0))))


@pytest.mark.parametrize("text", [TIED, BLOCK + TENDON])
def test_what_does_not_know_restraints_refuses_them(text):
    body = built(text)
    with pytest.raises(
        UsageError, match="found damping, one side, unequal sides, ties or a tendon"
    ):
        check_curves(body, sine(), frequency_axis("Omega=2"))


def test_a_spectra_file_keeps_the_restraints(tmp_path):
    body = built(TIED)
    grid, path = parse_grid("a_g=0.2g:1.4g:5,T_g=0.4:1:3"), tmp_path / "tied.h5"
    found = response(
        Method("nonlinear").system_of(body),
        sine(),
        *np.meshgrid(*grid.scaled(body)),
        body.eta,
    )
    summary = write_spectrum(
        [body], sine(), grid, path, method=Method("nonlinear"), check=15, workers=1
    )
    assert (
        summary.checked_cells,
        summary.misjudged,
        summary.largest_difference < 1e-9,
    ) == (12, 0, True)  # 3 do not lift
    with SpectraFile(path) as file:
        assert file.structures[0].restraints == body.restraints
        np.testing.assert_array_equal(np.squeeze(file.array("outcome")), found.outcome)


def varied(text, wall=TIED):
    """The family of a tied wall."""
    return list(family(parse_documents(wall, "f.yaml")[0], [text]))


def test_a_path_leads_to_a_key_of_a_tie():
    (member,) = varied("ties.0.yield=12kN:12kN:1")
    assert member.parameters.restraints.ties[0].yield_force == pytest.approx(
        12e3, rel=1e-12
    )


REFUSED = [
    ("ties.0.yeild", r"unknown key 'yeild' .did you mean 'yield'"),
    (
        "ties.3.yield",
        "found '3' in a list of line 7; expected a number from 0 to 0 and a key",
    ),
    ("ties.0", "found '0' in a list"),
    ("ties.0.height.x", "found 'x' in 5.5 m"),
]
test_a_path_that_leads_nowhere_is_refused = refuses(
    lambda key: varied(f"{key}=1:1:1"), DocumentError, REFUSED
)

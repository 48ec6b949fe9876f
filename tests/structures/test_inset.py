"""Pivots inside the edges: the same body on a narrower base, on every rigid kind."""

import json
import math
from dataclasses import replace

import pytest
from support.documents import RIGID, built

from rocking_cli import build_structure
from rocking_cli.structures import read_documents
from rocking_cli.structures.kinds import sketch_of
from rocking_cli.structures.mechanics.worn_edges import worn


def same(found, wanted, **tolerance):
    for one, other in zip(
        found.sides or (found,), wanted.sides or (wanted,), strict=True
    ):
        numbers = tuple((x.p, x.alpha, x.uplift, x.eta) for x in (one, other))
        assert numbers[0] == pytest.approx(
            numbers[1], **(tolerance or {"rel": 1e-13, "abs": 0})
        )


BLOCK, GYRATION = (
    "kind: block\nwidth: 0.5\nheight: 2\n",
    math.hypot(0.5, 2) / math.sqrt(12),
)
STATUE = "kind: rigid\nheight: 1.15\ngyration: 0.68\n"
NARROWER = [
    (
        BLOCK + "inset: 20 mm",
        f"kind: rigid\nleft: 0.23\nright: 0.23\nheight: 1\ngyration: {GYRATION!r}",
    ),
    (
        STATUE + "left: 0.42\nright: 0.31\ninset: 3 cm",
        STATUE + "left: 0.39\nright: 0.28",
    ),
    (
        "kind: point_mass\nwidth: 1.2\nheight: 4\ninset: 0.1",
        "kind: point_mass\nwidth: 1\nheight: 4",
    ),
]


@pytest.mark.parametrize(("text", "narrower"), NARROWER)
def test_it_rocks_as_the_body_whose_edges_lie_further_inside(text, narrower):
    same(built(text), built(narrower))


def test_a_one_sided_wall_still_meets_its_backing_at_its_top():
    # half widths and heights; I_G/m, then the vectors from edges and top to the mass
    # centre
    b, h, d = (0.6, 4.0, 0.05)
    central, x = (b * b + h * h) / 3, b - d
    base = (central + h * h - x * x) / (central + h * h + x * x)
    backing = (central + x * b - h * h) / (central + b * b + h * h)
    assert built(
        "kind: wall\nthickness: 1.2\nheight: 8\none_sided: true\ninset: 5 cm"
    ).eta == pytest.approx(base**2 * backing, rel=1e-13)


def test_a_frame_by_the_energy_and_momentum_of_its_parts():
    b, h, gamma, d = 0.25, 1.5, 0.7, 0.03
    found = built(
        f"kind: frame\ncolumns: 4\nwidth: {2 * b}\nheight: {2 * h}\ncap_ratio:"
        f" {gamma}\ninset: {d}"
    )
    x, central = (
        b - d,
        (b * b + h * h) / 3,
    )  # a column of mass 1, and the beam on its head at twice the lever
    inertia = central + x * x + h * h + gamma * 4 * (x * x + h * h)
    assert found.p**2 == pytest.approx(
        9.81 * math.hypot(x, h) * (1 + 2 * gamma) / inertia, rel=1e-13
    )
    shared = central + h * h - x * x + gamma * 4 * (h * h - x * x)
    assert (found.alpha, found.eta) == pytest.approx(
        (math.atan2(x, h), shared / inertia), rel=1e-13
    )


def test_every_interface_of_a_stack_is_narrower_and_another_one_may_govern():
    stack = (
        "kind: stack\npieces: [{width: 1, height: 3}, {width: 0.4, height: 1}]\ninset: "
    )
    found = built(stack + "0")
    assert (found.details["rocks_on"], found.alpha) == (
        "its base",
        found.details["alpha_geometric"],
    )
    worn = built(stack + "0.15")
    assert worn.details["rocks_on"] == "piece 1 from below"
    assert [interface["lambda"] for interface in worn.details["interfaces"]][
        1
    ] == pytest.approx(0.05 / 0.5, rel=1e-13)
    assert worn.details["alpha_geometric"] == found.alpha


@pytest.mark.parametrize("kind", RIGID)
def test_every_rigid_kind_takes_an_inset(kind, pytestconfig):
    (document,) = read_documents(pytestconfig.rootpath / "configs" / f"{kind}.yaml")
    plain, none, worn = (
        build_structure(document.with_value("inset", text, "f.yaml"))
        for text in ("null", "0", "5 mm")
    )
    assert replace(none, details=plain.details) == plain
    assert (
        none.details["alpha_geometric"]
        == plain.alpha
        == worn.details["alpha_geometric"]
    )
    assert worn.details["inset"] == 0.005
    assert worn.alpha < plain.alpha
    assert built(json.dumps(worn.row())) == replace(worn, mechanism=None)
    drawn, before = (
        sketch_of(document.with_value("inset", text, "f.yaml"), plain)
        for text in ("5 mm", "0")
    )
    for (name, (x, z)), (_, (edge, level)) in zip(
        drawn.pivots, before.pivots, strict=True
    ):
        assert (x, z) == pytest.approx(
            (edge + (0.005 if name == "left" else -0.005), level), abs=1e-13
        )
    assert len(drawn.moved) == len(drawn.bodies)


@pytest.mark.parametrize(
    ("text", "width"),
    [
        (BLOCK, 0.5),
        (BLOCK + "restitution: 0.8\nfriction: 0.4", 0.5),
        (
            "kind: wall\nthickness: 1.2\nheight: 8\none_sided: true\nrestitution: -0.4",
            1.2,
        ),
        (STATUE + "left: 0.42\nright: 0.31\ndamping: 0.02", 0.73),
        ("kind: prism\ncorners: [[0, 0], [1, 0], [0.9, 6]]", 1.0),
    ],
)
def test_parameters_alone_give_the_body_whose_pivots_moved_by_a_share_of_the_width(
    text, width
):
    inset, found = worn(built(text), 0.05)
    wanted = built(f"{text}\ninset: {0.05 * width!r}")
    assert inset == pytest.approx(0.05 * width, rel=1e-12)
    same(found, wanted, rel=1e-10, abs=0)
    for key in ("eta_source", "one_sided", "damping", "friction", "gravity", "name"):
        assert getattr(found, key) == getattr(wanted, key)
    assert found.arm == pytest.approx(wanted.arm, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "kind: arch\nradius: 10\nthickness: 1.5\nangle: 3",
        "kind: parameters\np: 1\nalpha: 0.2\neta: 1\nlambda: 0.2",
        "kind: rigid\nleft: 0.04\nright: 1\nheight: 3\ngyration: 1\nrestitution: 0.5",
    ],
)
def test_parameters_without_a_mass_centre_or_that_would_fall_give_none(text):
    assert worn(built(text), 0.05) is None

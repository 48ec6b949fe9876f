"""What is drawn of a structure is its geometry: mass centre, pivots, cracks, hinges,
and the shape at alpha.
"""

import math

import numpy as np
import pytest
from support.documents import RIGID

from rocking_cli import build_structure, parse_documents
from rocking_cli.structures import KINDS, read_documents
from rocking_cli.structures.kinds import is_drawn, sketch_of

DRAWN = list(filter(is_drawn, KINDS))


def sketched(text):
    (document,) = parse_documents(text, "f.yaml")
    built = build_structure(document)
    return sketch_of(document, built), built


def area(outline):
    x, z = np.array(outline).T
    return 0.5 * float(np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z))


@pytest.mark.parametrize("kind", [*DRAWN, "spire_cracked"])
def test_alpha_is_the_angle_from_the_edge_that_lifts_first_to_the_mass_centre(
    kind, pytestconfig
):
    (document,) = read_documents(pytestconfig.rootpath / "configs" / f"{kind}.yaml")
    built = build_structure(document)
    found = sketch_of(document, built)
    assert len(found.moved) == len(found.bodies)
    if found.centre is None:
        assert kind not in RIGID or kind == "frame"  # of several bodies
        return
    x, z = found.centre
    angles = [math.atan2(abs(px - x), z - pz) for _, (px, pz) in found.pivots]
    assert min(angles) == pytest.approx(built.alpha, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("text", "corners"),
    [
        (
            "kind: block\nwidth: 0.5\nheight: 2",
            [(-0.25, 0), (0.25, 0), (0.25, 2), (-0.25, 2)],
        ),
        (
            f"kind: block\nradius: 5\nalpha: {math.atan(0.75)!r}",
            [(-3, 0), (3, 0), (3, 8), (-3, 8)],
        ),
        (
            "kind: wall\nthickness: 0.5\nheight: 2",
            [(-0.25, 0), (0.25, 0), (0.25, 2), (-0.25, 2)],
        ),
        (
            "kind: drum\nbase_radius: 1\ntop_radius: 0.5\nheight: 6\noffset: 0.1",
            [(-1, 0), (1, 0), (0.5, 6), (-0.5, 6)],
        ),
        ("kind: spire\nbase_radius: 1\nheight: 8", [(-1, 0), (1, 0), (0, 8)]),
    ],
)
def test_an_outline_is_the_section_and_turns_rigidly_about_the_right_edge(
    text, corners
):
    found, _ = sketched(text)
    assert np.array(found.bodies[0]) == pytest.approx(
        np.array(corners, dtype=float), abs=1e-14
    )
    right = np.array(corners[1], dtype=float)
    x, z = np.array(corners, dtype=float).T - right[:, None]
    lean = math.atan2(right[0] - found.centre[0], found.centre[1])
    turned = (
        np.array(
            [np.cos(lean) * x + np.sin(lean) * z, np.cos(lean) * z - np.sin(lean) * x]
        ).T
        + right
    )
    assert np.array(found.moved[0]) == pytest.approx(turned, abs=1e-13)


def test_a_stack_stands_on_what_does_not_rock():
    found, built = sketched(
        "kind: stack\npieces: [{width: 2, height: 0.5}, {width: 0.4, height: 1},"
        " {width: 0.4, height: 1}]"
    )
    assert [area(outline) for outline in found.still] == pytest.approx([1.0], rel=1e-14)
    assert [area(outline) for outline in found.bodies] == pytest.approx(
        [0.4, 0.4], rel=1e-14
    )
    assert found.pivots == (("left", (-0.2, 0.5)), ("right", (0.2, 0.5)))
    assert found.centre == pytest.approx((0.0, 1.5), abs=1e-14)
    assert built.details["rocks_on"] == "piece 1 from below"


def test_a_spire_shows_its_crack_and_the_mirror_image():
    found, _ = sketched(
        "kind: spire\nbase_radius: 1.5\nheight: 12\nthickness: 0.15\ncrack:"
        " diagonal\ncrack_height: 6"
    )
    (_, crack), (_, mirror) = found.lines
    assert crack == ((1.5, 0.0), (-0.75, 6.0))
    assert mirror == ((-1.5, 0.0), (0.75, 6.0))
    assert area(found.bodies[0]) + area(found.still[0]) == pytest.approx(
        0.5 * 3 * 12, rel=1e-14
    )
    assert found.hollows == (((-1.35, 0.0), (1.35, 0.0), (0.0, 12 * 0.9)),)


def test_an_arch_is_its_voussoirs_and_its_linkage_holds_together_at_alpha():
    found, _ = sketched(
        "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\nvoussoirs: 7"
    )
    assert len(found.bodies) == 7
    step = math.radians(157.5) / 7 / 14  # faces are drawn in chords of up to 0.03 rad
    ring = 0.5 * (10.75**2 - 9.25**2) * 7 * 14 * math.sin(step)
    assert abs(sum(area(outline) for outline in found.bodies)) == pytest.approx(
        ring, rel=1e-12
    )
    assert [name for name, _ in found.pivots] == ["1", "2", "3", "4"]
    points = [np.array(point) for _, point in found.pivots]
    for point, rho, degrees in zip(
        points, (9.25, 10.75, 9.25, 10.75), (168.75, 101.25, 56.25, 11.25), strict=True
    ):
        assert point == pytest.approx(
            rho
            * np.array(
                [math.cos(math.radians(degrees)), math.sin(math.radians(degrees))]
            ),
            rel=1e-13,
        )
    for before, after in zip(found.bodies, found.moved, strict=True):
        assert area(after) == pytest.approx(area(before), rel=1e-12)

    # Where two links meet, at hinges 2 and 3, the corner of one is the corner of the
    # other; 1 and 4 stay.
    def corner_of(part, hinge):
        at = int(
            np.argmin([np.hypot(*(np.array(p) - hinge)) for p in found.bodies[part]])
        )
        return np.array(found.moved[part][at])

    for hinge, (one, other) in zip(points[1:3], ((2, 3), (4, 5)), strict=True):
        assert corner_of(one, hinge) == pytest.approx(
            corner_of(other, hinge), abs=1e-12
        )
        assert np.hypot(*(corner_of(one, hinge) - hinge)) > 0.1
    assert corner_of(0, points[0]) == pytest.approx(points[0], abs=1e-12)
    assert corner_of(6, points[3]) == pytest.approx(points[3], abs=1e-12)


def test_a_continuous_arch_is_its_three_links_and_what_stays_beside_them():
    found, built = sketched("kind: arch\nspan: 10\nrise: 3\nthickness: 1")
    a, *_, d = built.mechanism.angles
    ring = built.mechanism.ring
    assert (len(found.bodies), len(found.moved), len(found.still)) == (
        3,
        3,
        (a > 0.0) + (d < ring.angle),
    )
    drawn = sum(abs(area(outline)) for outline in (*found.bodies, *found.still))
    assert drawn == pytest.approx(
        34.0 / 6.0 * ring.angle, rel=1.5e-4
    )  # R = (5^2 + 3^2)/(2 * 3); chords take 0.03^2/6 of it at most

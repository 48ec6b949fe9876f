"""Documents of mechanisms: their parameters, what is refused and what is remarked."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
from support.documents import built
from support.refusals import refuses

from rocking_cli import (
    DocumentError,
    build_structure,
    check,
    load_structures,
    parse_documents,
    parse_grid,
    sine,
    time_history,
)
from rocking_cli.structures.kinds import sketch_of

BLOCK = "{corners: [[0, 0], [0.5, 0], [0.5, 2], [0, 2]], density: 2000}"
WALL = """
kind: mechanism
bodies:
  lower: {corners: [[0, 0], [0.3, 0], [0.3, 2], [0, 2]], density: 1800}
  upper: {corners: [[0, 2], [0.3, 2], [0.3, 3], [0, 3]], density: 1800}
joints:
"""
FOOT = "- {hinge: [ground, lower], at: [0.3, 0]}\n"
CRACK = "- {hinge: [lower, upper], at: [0, 2]}\n"
TOP = "- {slide: upper, at: [0.15, 3]}\n"
EDGE = "joints: [{hinge: [ground, block], at: [0.5, 0]}]"


def one(more="", body=BLOCK, joints=EDGE):
    return f"kind: mechanism\nbodies:\n  block: {body}\n{joints}\n{more}"


def numbers(structure):
    return [
        (x.alpha, x.p, x.uplift, x.a_scale, x.eta)
        for x in structure.sides or (structure,)
    ]


@pytest.mark.requirement(
    "A mechanism of several bodies has the lambda of virtual work",
    "structures/mechanics/planar_mechanism.py",
    "Mass on two struts",
)
def test_the_shipped_documents(pytestconfig):
    # an independent program, 2026: alpha, p, lambda, a_scale, eta
    wall, portal = load_structures(
        [
            pytestconfig.rootpath / "configs" / f"{name}.yaml"
            for name in ("mechanism", "mechanism_portal")
        ]
    )
    wanted = [0.112146044, 7.495889140, 0.866315551, 0.129451727, 0.479147136]
    assert numbers(wall) == [pytest.approx(wanted, abs=6e-10)]
    assert numbers(portal) == [
        pytest.approx(row, abs=6e-10)
        for row in (
            [0.185951191, 1.772962142, 0.176554945, 1.053219954, 0.943336789],
            [0.183109419, 1.755042214, 0.170273877, 1.075381750, 0.950684220],
        )
    ]
    assert wall.details["impulses_inside"] is portal.details["impulses_inside"] is True
    assert wall.details["top_reaction"] == pytest.approx(5339.22, abs=1e-6)
    assert wall.details["lambda_governing"] == pytest.approx(wall.uplift, rel=1e-12)


def test_a_block_as_a_mechanism_is_the_block_in_every_answer():
    block = built("kind: block\nwidth: 0.5\nheight: 2\nname: b")
    same = built(one("name: b"))
    assert numbers(same) == [pytest.approx(numbers(block)[0], rel=1e-14)]
    assert (same.arm, same.sides, same.mechanism) == (
        pytest.approx(block.arm),
        (),
        None,
    )
    shaking = parse_grid("a_g=0.33g,T_g=0.8")
    verdicts = [check(one, sine(), shaking).row() for one in (block, same)]
    for key, value in verdicts[0].items():
        other = verdicts[1][key]
        assert other == (
            pytest.approx(value, rel=1e-10) if isinstance(value, float) else value
        )
    forces = [
        next(time_history(s, sine(), shaking).summaries(forces=True))
        for s in (block, same)
    ]
    for key, value in forces[0].items():
        if isinstance(value, float):
            value = pytest.approx(value, rel=1e-9)
        assert forces[1][key] == value


def ring(count, angle, radius=10.0, thickness=1.5):
    """Corners of voussoirs with straight edges, from the right, and their names."""
    start = 0.5 * (math.pi - math.radians(angle))
    cuts = start + np.linspace(0.0, math.radians(angle), count + 1)
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness

    def point(rho, s):
        return [rho * math.cos(s), rho * math.sin(s)]

    return {
        f"v{i + 1}": {
            "corners": [
                point(inner, a),
                point(outer, a),
                point(outer, b),
                point(inner, b),
            ],
            "density": 2000,
        }
        for i, (a, b) in enumerate(pairwise(cuts))
    }


def arch(joints, **more):
    """An arch of seven straight voussoirs on two abutments that stay."""
    bodies = ring(7, 157.5)
    for name, (a, b) in (
        ("right", bodies["v1"]["corners"][:2]),
        ("left", bodies["v7"]["corners"][2:][::-1]),
    ):
        down = [[x, z - 1.0] for x, z in (b, a)]
        bodies[name] = {"corners": [a, b, *down], "density": 2000}
    held = {"rigid": ["ground", "left", "right"]}
    return built(
        json.dumps(
            {"kind": "mechanism", "bodies": bodies, "joints": [held, *joints], **more}
        )
    )


def test_hinges_are_found_from_outlines():
    # an independent program, 2026, with the coordinate v7 where the first body is v1
    found = arch([], rotation_of="v7", rotation_of_other="v1")
    assert numbers(found) == [
        pytest.approx(
            [0.0700504908, 1.8294887193, 0.3736116923, 0.1874954459, 0.6455530240],
            abs=6e-11,
        )
    ]
    hinges = [joint["hinge"] for joint in found.details["joints"]]
    assert [set(pair) for pair in hinges] == [
        {"left", "v7"},
        {"v4", "v5"},
        {"v2", "v3"},
        {"v1", "right"},
    ]
    assert found.details["joints_source"] == "searched"
    assert found.details["impulses_inside"] is False
    assert found.details["lambda_governing"] == pytest.approx(found.uplift, rel=1e-9)


def test_joints_that_do_not_govern_are_remarked():
    v = {name: body["corners"] for name, body in ring(7, 157.5).items()}
    found = arch(
        [
            {"hinge": ["left", "v7"], "at": v["v7"][2]},
            {"rigid": ["v7", "v6", "v5"]},
            {"hinge": ["v5", "v4"], "at": v["v5"][0]},
            {"rigid": ["v4", "v3"]},
            {"hinge": ["v3", "v2"], "at": v["v3"][1]},
            {"rigid": ["v2", "v1"]},
            {"hinge": ["v1", "right"], "at": v["v1"][0]},
        ],
        name="Arch",
    )
    (remark,) = [x for x in found.remarks if "in another mechanism" in x]
    assert remark.startswith(
        "Arch: it moves from 0.374 g on, in another mechanism (hinges at"
    )
    assert remark.endswith(f"lambda = {found.uplift:.3g} is that of the joints given.")


def test_a_hinge_that_would_pull_and_one_that_would_slide_are_remarked():
    found = built(WALL + FOOT + CRACK + TOP + "friction: 0.1\nname: w")
    assert found.remarks == (
        "w: with a friction of 0.1 at its joints it slides from 0.18 g on, or before;"
        f" lambda = {found.uplift:.3g} is that without sliding.",
        "w: the joint at [0.3, 0] needs a friction of 0.2 at the onset.",
    )
    # a beam that overhangs its right column pulls the left one up
    overhang = """
kind: mechanism
name: b
bodies:
  left: {corners: [[0, 0], [0.4, 0], [0.4, 3], [0, 3]], density: 2000}
  right: {corners: [[2, 0], [2.4, 0], [2.4, 3], [2, 3]], density: 2000}
  beam: {corners: [[0, 3], [5, 3], [5, 3.4], [0, 3.4]], density: 2000}
joints: [{hinge: [ground, left], at: [0.4, 0]}, {hinge: [left, beam], at: [0, 3]},
         {hinge: [ground, right], at: [2.4, 0]}, {hinge: [right, beam], at: [2, 3]}]
one_sided: true
restitution: -0.2
"""
    remarks = built(overhang).remarks
    (pulls,) = [text for text in remarks if "in tension" in text]
    assert pulls.startswith("b: the hinge at [0, 3] is in tension at the onset (-")
    assert pulls.endswith(" kN): it lifts off before.")


def test_bodies_side_by_side_slide_before_they_turn_as_one():
    # the right block alone turns at 0.25 g; without sliding both turn as one at 0.5 g
    second = "{corners: [[0.5, 0], [1, 0], [1, 2], [0.5, 2]], density: 2000}"
    found = built(one(body=f"{BLOCK}\n  second: {second}", joints=""))
    assert found.uplift == pytest.approx(0.5, rel=1e-12)
    (remark,) = found.remarks
    assert "with a friction of 1 at its joints it slides from 0.429 g on" in remark


def test_columns_and_a_beam_are_a_frame_whose_forces_are_not_unique():
    columns = {
        f"c{i}": {
            "corners": [[x, 0], [x + 0.9, 0], [x + 0.9, 6.5], [x, 6.5]],
            "density": 2000,
        }
        for i, x in enumerate((0, 4, 8, 12))
    }
    beam = {"corners": [[0, 6.5], [12.9, 6.5], [12.9, 7.5], [0, 7.5]], "density": 4000}
    hinges = [
        joint
        for name, body in columns.items()
        for joint in (
            {"hinge": ["ground", name], "at": body["corners"][1]},
            {"hinge": [name, "beam"], "at": body["corners"][3]},
        )
    ]
    document = {
        "kind": "mechanism",
        "bodies": {**columns, "beam": beam},
        "joints": hinges,
    }
    found = built(json.dumps(document))
    assert "not unique" in found.remarks[0]
    # p of Makris and Vassiliou (2013), gamma the beam over the columns
    gamma, radius = 4000 * 12.9 / (8000 * 0.9 * 6.5), 0.5 * math.hypot(0.9, 6.5)
    p = math.sqrt(0.75 * 9.81 / radius * (1 + 2 * gamma) / (1 + 3 * gamma))
    assert (found.alpha, found.p) == pytest.approx((math.atan2(0.9, 6.5), p), rel=1e-12)
    bare = built(one(body="{mass: 1000, centre: [0.25, 1], gyration: 0.6}"))
    assert not bare.remarks  # no outline: no faces, so no compression either
    assert all("compression" not in joint for joint in found.details["joints"])


def test_a_sketch_moves_in_both_directions():
    (document,) = parse_documents(WALL + FOOT + CRACK + TOP, "f.yaml")
    wall = build_structure(document)
    pose = sketch_of(document, wall).pose
    there, back = (pose(sign * 0.5 * wall.alpha)[0] for sign in (1.0, -1.0))
    for one, other in zip(there, back, strict=True):
        image = [(0.3 - x, z) for x, z in one]
        assert np.array(other) == pytest.approx(np.array(image), abs=1e-12)
    assert max(x for x, _ in there[0]) > 0.31


# An independent program, 2026: least N [N] and largest |T|/N at each hinge of a wall of
# 0.3 m x 3 m between floors, cracked at half its height, in a sine of 5 m/s2 and 0.6 s.
IN_PULSE = {
    (-1.0, 1): (12888.248000330153, 0.26246183339777607),
    (-1.0, 2): (5693.136000247628, 0.11319111294521605),
    (1.0, 1): (14958.135180714406, 0.24626211892385175),
    (1.0, 2): (7245.551385535802, 0.10194311474158355),
}


def test_forces_at_the_joints_in_a_pulse():
    wall = built(
        (WALL + FOOT + CRACK + TOP)
        .replace("2]", "1.5]")
        .replace("[0.15, 3]", "[0.3, 3]")
    )
    found = time_history(wall, sine(), parse_grid("a_g=5,T_g=0.6"))
    forces, arcs = found.forces["nonlinear"], found.histories["nonlinear"].arcs
    stop = 0.6 * wall.p
    for (side, hinge), (least, friction) in IN_PULSE.items():
        tau = np.concatenate(
            [
                np.linspace(start, min(end, stop) * (1.0 - 1e-12), 401)
                for start, end, way in zip(*arcs[:3], strict=True)
                if way == side and start < stop
            ]
        )
        columns = forces.columns(tau)
        n, t = columns[f"hinge{hinge}_n"], columns[f"hinge{hinge}_t"]
        weight = 1800.0 * 0.9 * 9.81
        assert weight * np.nanmin(n) == pytest.approx(least, rel=1e-8)
        assert np.nanmax(np.abs(t) / n) == pytest.approx(friction, abs=1e-7)
    # the bearing rises as the upper part shortens: at uplift by u_z theta_dotdot
    loaded = built(
        WALL
        + FOOT
        + CRACK
        + TOP
        + "loads: [{body: upper, at: [0.15, 3], weight: 15 kN,"
        " inertia: vertical}]"
    )
    pressed = time_history(loaded, sine(), parse_grid("a_g=12,T_g=0.4"))
    column = pressed.forces["nonlinear"].columns(np.linspace(0.3, 4.0, 100))
    assert 0.0 < np.nanmin(column["load_min"]) < 1.0
    summary = forces.summary("t", 1.0 / wall.p)
    assert summary["opens"] is False
    assert summary["friction_needed"] == pytest.approx(0.2624618, abs=1e-6)


test_what_is_refused = refuses(
    built,
    DocumentError,
    [
        (
            WALL + FOOT + CRACK,
            "have 2 degrees of freedom at rest; a mechanism has one.",
        ),
        (
            WALL + FOOT + CRACK + TOP + "- {slide: lower, at: [0, 1]}\n",
            "joints: the bodies cannot move: take a joint away",
        ),
        (
            WALL + FOOT + "- {hinge: [lower, upper], at: [0.2, 2.1]}\n" + TOP,
            "joints.1.at: [0.2, 2.1] is not on the outline of 'lower'.",
        ),
        (
            WALL + FOOT + "- {hinge: [lower, upper], at: [0.2, 2]}\n" + TOP,
            "f.yaml:8:3: joints.1: the joint between 'lower' and 'upper' closes at [0,"
            " 2] instead of opening: move its hinge to the other face.",
        ),
        (
            WALL + FOOT + "- {hinge: [lower, upper], at: [0.3, 2]}\n" + TOP,
            "joints: the weight does not resist this mechanism (it rises by nothing at"
            " rest).",
        ),
        (WALL + FOOT + FOOT + CRACK + TOP, "joints.1: this hinge is given twice."),
        (
            WALL + FOOT + CRACK + "- {rigid: [lower, upper]}\n",
            "joints.1: 'lower' and 'upper' move as one already",
        ),
        (
            one(body=BLOCK.replace("[0.5, 2], [0, 2]", "[1.8, 2], [1.3, 2]")),
            "it does not stand: its weight moves it in the direction in which the"
            " joints open.",
        ),
        (
            one(
                body=BLOCK.replace("[0.5, 2], [0, 2]", "[1.8, 2], [1.3, 2]"), joints=""
            ),
            "it does not stand: the bodies do not carry their weight without tension",
        ),
        (
            one(body="{mass: 1000, centre: [0, 0], gyration: 0.5}"),
            "joints: horizontal motion of the ground does not move this mechanism.",
        ),
        (
            one(body="{mass: 1000, centre: [0.1, -1], gyration: 0.5}"),
            "no unstable equilibrium: the weight brings it back at every rotation up to"
            " 90 deg (it hangs).",
        ),
        *(
            (
                one(
                    "  ",
                    BLOCK
                    + "\n  one: {mass: 1, centre: [-0.5, 1.6], gyration: 0.3}"
                    + "\n  two: {mass: 1, centre: [-1.5, 0.6], gyration: 0.3}",
                    f"{EDGE[:-1]}, {{hinge: [block, one], at: [0, 2]}}, {{hinge: [one,"
                    f" two], at: [{x}, 1]}}, {{hinge: [two, ground], at: [-2, 0]}}]\n"
                    "one_sided: true\nrestitution: -0.3",
                ),
                f"it locks at {angle} deg, before its weight stops bringing it back.",
            )
            for x, angle in ((-0.7, 1.05), (-0.8, 0.462), (-0.9, 0.115))
        ),
        (
            one(
                body=BLOCK
                + "\n  kerb: {corners: [[0.52, 0], [0.8, 0], [0.8, 0.6], [0.52, 0.6]],"
                " density: 2000}"
            ),
            "'block' meets 'kerb' at 2.11 deg, before the unstable equilibrium at 14"
            " deg.",
        ),
        (
            one("rotation_of: beam"),
            "rotation_of: found beam; expected a body, one of block",
        ),
        (
            one(
                body=BLOCK.replace("[0.5, 0], [0.5, 2]", "[0.8, 0], [0.5, 2]"),
                joints=EDGE.replace("0.5", "0.8"),
            ),
            "other_side: 'block' has no mirror image about x = 0.4 m: list the joints"
            " of the other side.",
        ),
        (
            one("other_" + EDGE.replace("joints", "side")),
            "other_side: these joints move towards +x, as the first ones do.",
        ),
        (
            one(
                "loads: [{body: block, at: [0, 2], mass: 9, inertia: both, mirrored:"
                " true}]"
            ),
            "loads.0: a carried load (inertia: both) cannot change its place; leave out"
            " mirrored.",
        ),
        (
            WALL
            + FOOT
            + CRACK
            + TOP
            + "loads: [{body: upper, at: [0.3, 3], weight: 32 kN, inertia: vertical,"
            " mirrored: true}]",
            "that is no rocking on to the other side (loads with vertical inertia, or"
            " squat bodies); state a restitution",
        ),
        (
            one("one_sided: true"),
            "restitution: needed for a one-sided mechanism (between -1 and 0).",
        ),
        (
            one("one_sided: true\nrestitution: -0.2", joints=EDGE.replace("0.5", "0")),
            "one_sided: these joints move towards -x",
        ),
        (
            one(body=BLOCK + "\n  again: " + BLOCK.replace("0.5", "0.6")),
            "bodies: 'block' and 'again' overlap at rest.",
        ),
        (
            one(joints="joints: [{pin: [ground, block]}]"),
            "unknown key 'pin'; known keys of this kind: along, at, hinge, rigid",
        ),
        (
            one("loads: [{on: block, at: [0, 2], mass: 9, inertia: both}]"),
            "unknown key 'on'; known keys of this kind: at, body",
        ),
        (one("loads: [{body: block, at: [0, 2], mass: 9}]"), "no key 'inertia'"),
        (
            one(
                body=BLOCK + "\n  far: {corners: [[3, 0], [3.5, 0], [3.5, 2], [3, 2]],"
                " density: 1}",
                joints="",
            ),
            "joints: two mechanisms move from 0.25 g on; list the joints of one of"
            " them.",
        ),
        (one("colour: red"), "unknown key 'colour'"),
        (one(body=BLOCK.replace("2000", "2000, colour: 1")), "unknown key 'colour'"),
    ],
    literal=True,
)

"""Mechanisms whose rotation has its largest value near collapse: their links lock
there, and the motion goes on. The oracle follows them by the rotation of another body,
which has no such place.
"""

import json
import math
from functools import cache

import numpy as np
import pytest
from oracles.arch_linkage import carried, links_of
from oracles.mechanism_pulse import OneWay, Part, peak
from scipy.optimize import brentq, minimize_scalar
from support.bodies import rotation_under
from support.documents import built
from support.soak import quick

from rocking_cli import ArgumentError
from rocking_cli.dynamics.equations.mechanism import MechanismEquation

G = 9.81
THICK, LOW, HIGH = 0.3, 2.7, 0.3  # of a held wall: its thickness, its parts' heights


@cache
def wall():
    """A held wall without a load, cracked near its top, which stops to rise where the
    upper part has turned by 135 deg.
    """
    return built(
        f"kind: wall\nthickness: {THICK}\nheight: {LOW + HIGH}\ndensity: 1800\n"
        f"length: 1\ntop: held\ncrack_height: {LOW}"
    )


def _of_lower(psi):
    """Rotation of the lower part of the wall; psi: that of the upper part."""
    rise = HIGH * math.sin(psi) + THICK * (1.0 - math.cos(psi))
    # LOW sin phi + THICK (1 - cos phi) = rise
    arm, off = math.hypot(LOW, THICK), math.atan2(THICK, LOW)
    return math.asin((rise - THICK) / arm) + off


def wall_oracle():
    def lower(psi):
        phi, half = _of_lower(psi), 0.5 * THICK
        x = half - half * math.cos(phi) + 0.5 * LOW * math.sin(phi)
        return np.array([x, half * math.sin(phi) + 0.5 * LOW * math.cos(phi), phi])

    def upper(psi):
        """It turns about the left end of the crack, the other way round."""
        phi, half = _of_lower(psi), 0.5 * THICK
        x = half - THICK * math.cos(phi) + LOW * math.sin(phi)
        z = THICK * math.sin(phi) + LOW * math.cos(phi)
        x += half * math.cos(psi) - 0.5 * HIGH * math.sin(psi)
        return np.array([x, z + half * math.sin(psi) + 0.5 * HIGH * math.cos(psi), psi])

    parts = []
    for height, place in ((LOW, lower), (HIGH, upper)):
        mass = 1800.0 * THICK * height
        parts.append(Part(mass, mass * (THICK**2 + height**2) / 12.0, place))
    return parts, 2.4, _of_lower


@cache
def buttresses(turning="right"):
    """An arch of nine voussoirs on two buttresses, of which one stays. phi is the
    rotation of the other one, or of this body.
    """
    ring = {}
    for i in range(9):
        a, b = math.pi / 9.0 * i, math.pi / 9.0 * (i + 1)
        corners = ((3.24, a), (3.96, a), (3.96, b), (3.24, b))
        ring[f"v{i + 1}"] = [
            [r * math.cos(x), 4.8 + r * math.sin(x)] for r, x in corners
        ]
    sides = {
        name: [[x, 0.0], [x + 1.56, 0.0], [x + 1.56, 4.8], [x, 4.8]]
        for name, x in (("left", -4.8), ("right", 3.24))
    }
    document = {
        "kind": "mechanism",
        "bodies": {
            n: {"corners": c, "density": 2000} for n, c in (ring | sides).items()
        },
        "ground": 0.0,
        "rotation_of": turning,
        "joints": [
            {"rigid": ["ground", "left", "v9"]},
            {"hinge": ["v9", "v8"], "at": ring["v8"][3]},
            {"rigid": ["v8", "v7", "v6"]},
            {"hinge": ["v6", "v5"], "at": ring["v5"][2]},
            {"rigid": ["v5", "v4", "v3"]},
            {"hinge": ["v3", "v2"], "at": ring["v2"][3]},
            {"rigid": ["v2", "v1", "right"]},
            {"hinge": ["right", "ground"], "at": [4.8, 0.0]},
        ],
    }
    return built(json.dumps(document))


def buttress_oracle():
    """By the rotation of the link beside the buttress that stays."""
    linkage = buttresses().mechanism
    points, links = links_of(linkage)
    order = [linkage.link_of[name] - 1 for name in ("v8", "v5", "v2")]
    masses = [links[i] for i in order]
    parts = [
        Part(own.mass, own.inertia, lambda x, i=i: carried(points, masses, x)[i])
        for i, own in enumerate(linkage.masses[i] for i in order)
    ]
    return parts, 0.8, lambda x: carried(points, masses, x)[2, 2]


CASES = {"wall": (wall, wall_oracle), "buttresses": (buttresses, buttress_oracle)}


@pytest.fixture(scope="module", params=list(CASES))
def case(request):
    """(The structure, the oracle of each side, phi over alpha from the oracle's)."""
    structure, oracle = (one() for one in CASES[request.param])
    parts, most, phi = oracle
    mirrored = [
        Part(p.mass, p.inertia, lambda x, p=p: np.array([-1.0, 1.0, -1.0]) * p.place(x))
        for p in parts
    ]
    sides = {1: OneWay(parts, most), -1: OneWay(mirrored, most)}
    return structure, sides, lambda x: phi(x * sides[1].alpha) / structure.alpha


# of the least acceleration that lifts it, and of 2 pi/p
CELLS = [(1.3, 0.5), (2.5, 0.25), (4.0, 0.2), (4.0, 0.5), (12.0, 0.05), (30.0, 0.03)]


@pytest.mark.parametrize("cell", quick(CELLS, *CELLS[::2]))
def test_cells_are_those_of_another_integration(case, cell):
    (structure, sides, ratio), (strength, share) = case, cell
    a_g, period = strength * structure.uplift * G, share * 2.0 * math.pi / structure.p
    eta = {1: structure.eta, -1: structure.eta}
    wanted = peak(sides, eta, a_g, period)
    for how in ("floats", "arrays"):
        found = rotation_under(structure, a_g, period, tolerance=1e-11, how=how)
        assert found == (wanted and pytest.approx(ratio(wanted), rel=1e-6))


@pytest.mark.parametrize("share", quick((0.1, 0.3, 0.8), 0.3))
def test_the_capacity_is_that_of_another_integration(case, share):
    structure, sides, _ = case
    period = share * 2.0 * math.pi / structure.p
    low, high = structure.uplift * G, 40.0 * structure.uplift * G
    eta = {1: structure.eta, -1: structure.eta}
    while high > low * (1.0 + 1e-7):
        middle = math.sqrt(low * high)
        if rotation_under(structure, middle, period, how="floats") is None:
            high = middle
        else:
            low = middle
    assert peak(sides, eta, low * (1.0 - 1e-6), period) is not None
    assert peak(sides, eta, high * (1.0 + 1e-6), period) is None


def test_no_drive_of_that_strength_brings_a_body_back_from_the_end(case):
    """By the oracle, until the ground pushes the other way: B = 0, collapse."""
    structure, (one, _), ratio = case[0], case[1].values(), case[2]
    equation = MechanismEquation(structure.mechanism)
    end = float(equation.rotation(np.array([equation.limit]))[0])
    locks = minimize_scalar(
        lambda x: -ratio(x), bounds=(1.0, one.end / one.alpha), method="bounded"
    ).x
    assert end == pytest.approx(ratio(locks), rel=1e-4)
    if end < ratio(locks) * (1.0 - 1e-7):
        locks = brentq(lambda x: ratio(x) - end, 1.0, locks)
    rest, (first, *beyond) = one.at(0.0), np.linspace(locks, one.end / one.alpha, 500)
    held = []
    for x in (first, *beyond):
        _, lift, push = one.at(x * one.alpha)
        if push / rest[2] < 0.0:
            break
        held.append(-(lift / push) / (rest[1] / rest[2]))
    assert len(held) > 1
    assert min(held) == held[0] > 45.0
    # at rest there, a body is lost under that drive and not under a stronger one
    at, v = np.array([equation.limit]), np.zeros(1)
    assert equation.certainly_overturns(at, v, np.array([0.999 * held[0]]))[0]


def test_a_stronger_drive_is_refused_unless_the_body_is_too_fast_for_it():
    equation = MechanismEquation(buttresses().mechanism)
    at, strong = np.array([equation.limit]), np.array([48.0])
    for v in (0.0, 1e-3):
        with pytest.raises(ArgumentError, match=r"a drive of 48 times .* back"):
            equation.certainly_overturns(at, np.array([v]), strong)
    assert equation.certainly_overturns(at, np.array([2.0]), strong)[0]
    with pytest.raises(ArgumentError, match="may still bring it back"):
        equation.certainly_overturns(at, np.array([2.0]), strong, steady=False)


@pytest.mark.soak
@pytest.mark.parametrize("turning", ["right", "v8"])
def test_the_body_that_measures_the_rotation_decides_no_outcome(turning):
    """By that of the link beside the buttress that stays nothing locks before the
    collapse.
    """
    body = buttresses(turning)
    random = np.random.default_rng(4)
    other = buttresses("v5")
    for _ in range(40):
        a_g = other.uplift * G * math.exp(random.uniform(0.1, 4.5))
        period = math.exp(random.uniform(-3.5, 0.3)) * 2.0 * math.pi / other.p
        one, wanted = (rotation_under(x, a_g, period) for x in (body, other))
        assert (one is None) == (wanted is None)

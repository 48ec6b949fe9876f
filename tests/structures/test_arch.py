"""The arch: reference values, the static theorem as a second opinion, finite kinematics, invariances and refusals."""

from __future__ import annotations

import contextlib
import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, fsolve, linprog
from scipy.sparse import lil_matrix
from written import built

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.structures import hinges
from rocking_cli.structures.arch import find_mechanism
from rocking_cli.structures.fourbar import FourBar, Ring
from rocking_cli.structures.hinges import search_continuous, search_joints

OPPENHEIM = "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\n"


RING = Ring(10.0, 1.5, math.radians(157.5))


def static_uplift(ring: Ring, count: int) -> float:
    """lambda by the static theorem: the largest tilt at which a thrust without tension fits the joints (linear program).

    Unknowns are force and moment on each radial joint; it shares nothing with the search but the voussoirs' centroids.
    """
    polar = math.pi / 2 + ring.angle / 2 - np.linspace(0, ring.angle, count + 1)
    cx, cz = ring.radius * np.cos(polar), ring.radius * np.sin(polar)
    n = 3 * (count + 1) + 1
    balance, load = lil_matrix((3 * count, n)), np.zeros(3 * count)
    for i in range(count):
        m = ring.sector(*(math.pi / 2 + ring.angle / 2 - polar[i : i + 2]))
        for joint, sign in ((i, 1), (i + 1, -1)):
            j = 3 * joint
            balance[3 * i, j] = balance[3 * i + 1, j + 1] = balance[3 * i + 2, j + 2] = sign
            balance[3 * i + 2, j], balance[3 * i + 2, j + 1] = -sign * cz[joint], sign * cx[joint]
        balance[3 * i, n - 1], balance[3 * i + 2, n - 1] = m.mass, -m.z
        load[3 * i + 1], load[3 * i + 2] = m.mass, m.x
    inside = lil_matrix((2 * (count + 1), n))
    for i in range(count + 1):
        for row, sign in ((2 * i, 1), (2 * i + 1, -1)):
            inside[row, 3 * i] = -ring.thickness / 2 * math.sin(polar[i])
            inside[row, 3 * i + 1] = ring.thickness / 2 * math.cos(polar[i])
            inside[row, 3 * i + 2] = sign
    goal = np.zeros(n)
    goal[-1] = -1
    found = linprog(goal, inside.tocsr(), np.zeros(2 * (count + 1)), balance.tocsr(), load, [(None, None)] * n, method="highs")
    return float(found.x[-1])


def test_oppenheims_seven_voussoirs_have_the_reference_values():
    # lambda and hinges as published by Oppenheim (1992); the others evaluated independently, to the digits given.
    a = built(OPPENHEIM + "voussoirs: 7")
    assert a.uplift == pytest.approx(0.370010, abs=1e-6)
    assert a.p == pytest.approx(1.84211, abs=1e-5)
    assert a.alpha == pytest.approx(0.0690647, abs=1e-7)
    assert a.a_scale == pytest.approx(0.186656, abs=1e-6)
    assert a.details["a_scale_3_7"] == pytest.approx(0.280405, abs=1e-6)
    assert a.eta == pytest.approx(0.644960, abs=1e-6)
    assert [math.degrees(h["angle"]) for h in a.details["hinges"]] == pytest.approx([0, 67.5, 112.5, 157.5], abs=1e-12)
    assert [h["face"] for h in a.details["hinges"]] == ["intrados", "extrados", "intrados", "extrados"]


def test_multiplier_in_displaced_positions():
    (document,) = parse_documents(OPPENHEIM + "voussoirs: 7")
    at = find_mechanism(document)[0].coefficients(np.array([0.01, 0.03, 0.05]))
    assert at.lift / at.push == pytest.approx([0.28776, 0.16554, 0.07310], abs=1e-5)


def test_continuous_arch_hinged_at_its_springing():
    # An independent evaluation that kept hinge A on the springing found these; test_..._leaves_the_springing has the minimum.
    a = built(OPPENHEIM + "hinges: [0, 59.297 deg, 117.063 deg, 157.5 deg]")
    values = (a.uplift, a.p, a.alpha, a.a_scale, a.eta)
    assert values == pytest.approx((0.353498, 1.759029, 0.0904157, 0.255774, 0.733335), abs=1e-5)
    assert a.uplift == pytest.approx(0.353498, abs=1e-6)


def test_continuous_minimum_leaves_the_springing_as_the_static_theorem_proves():
    """The governing hinge A is 1.5 deg above the springing: lambda is 0.353384, below the 0.353498 of A on the springing."""
    found, uplift = search_continuous(RING)
    assert np.degrees(found) == pytest.approx([1.513526, 59.287414, 117.061302, 157.5], abs=1e-6)
    assert uplift == pytest.approx(0.3533838581583, abs=1e-12)
    fine = static_uplift(RING, 630)
    assert uplift < fine < uplift + 2e-6 < 0.353498


@pytest.mark.parametrize(
    ("beta", "thickness", "count"), [(157.5, 0.15, 7), (157.5, 0.15, 40), (180, 0.13, 25), (120, 0.1, 30), (200, 0.25, 24)]
)
def test_search_equals_the_static_theorem(beta, thickness, count):
    ring = Ring(1.0, thickness, math.radians(beta))
    _, uplift = search_joints(ring, np.linspace(0, ring.angle, count + 1))
    assert uplift == pytest.approx(static_uplift(ring, count), abs=1e-9)


def test_search_equals_brute_force():
    ring, joints = Ring(1.0, 0.16, math.radians(165)), np.linspace(0, math.radians(165), 13)
    every = []
    for some in itertools.combinations(range(13), 4):
        at = FourBar(ring, tuple(joints[list(some)])).at_rest()
        if at.admissible and at.push > 0:
            every.append((float(at.lift / at.push), some))
    found, uplift = search_joints(ring, joints)
    assert uplift == pytest.approx(min(every)[0], rel=1e-13, abs=0)
    assert found == tuple(joints[list(min(every)[1])])


def test_a_hundred_voussoirs_are_searched_by_pairs_of_hinges(monkeypatch):
    """4.6 million mechanisms of 101 joints in 5151 batches, one for each choice of the first two hinges."""
    kept, batches = hinges.rates, []
    monkeypatch.setattr(hinges, "rates", lambda points, links: batches.append(1) or kept(points, links))
    _, uplift = search_joints(RING, np.linspace(0, RING.angle, 101))
    assert len(batches) == 101 * 102 / 2
    assert uplift == pytest.approx(static_uplift(RING, 100), abs=1e-9)


def test_semicircle_of_least_thickness():
    """lambda reaches 0 at t/r = 0.1075, the thinnest semicircle that carries its own weight."""
    limit = brentq(lambda t: search_continuous(Ring(1.0, t, math.pi))[1], 0.105, 0.12, xtol=1e-9)
    assert limit == pytest.approx(0.1075, abs=1e-4)
    with pytest.raises(DocumentError, match="cannot carry its own weight"):
        built("kind: arch\nradius: 1\nthickness: 0.107\nangle: 180 deg")
    assert built("kind: arch\nradius: 1\nthickness: 0.108\nangle: 180 deg").uplift > 0


@pytest.mark.parametrize(("beta", "thickness", "count", "p"), [(250, 0.80, 11, 3.0564), (200, 0.50, 5, 3.5709), (195, 0.40, 5, 3.8673)])
def test_stiffness_next_to_a_locking_position(beta, thickness, count, p):
    # p from central differences of an independent V', stable to 5 digits over steps from 1e-4 to 1e-6.
    a = built(f"kind: arch\nradius: 1\nthickness: {thickness}\nangle: {beta} deg\nvoussoirs: {count}")
    assert a.p == pytest.approx(p, abs=1e-4)


def test_given_hinges_say_what_governs():
    a = built(OPPENHEIM + "hinges: [0, 20 deg, 110 deg, 157.5 deg]\nrestitution: 0.6")
    assert a.uplift > 0.55
    assert a.details["lambda_governing"] == pytest.approx(0.353384, abs=1e-6)


@pytest.mark.parametrize(("beta", "eta"), [(300, ""), (180, "restitution: 0.5"), (149.336, "restitution: 0.5")])
def test_very_thick_arches_are_solved_or_refused(beta, eta):
    for thickness in (0.85, 0.88, 0.9, 0.95):
        with contextlib.suppress(DocumentError):
            a = built(f"kind: arch\nradius: 1\nthickness: {thickness}\nangle: {beta} deg\n{eta}")
            assert a.uplift <= static_uplift(Ring(1.0, thickness, math.radians(beta)), 90) + 1e-6


def test_finite_kinematics_equal_a_numerical_solution_of_the_loop():
    """M, V' and B from positions found by a general solver and differentiated numerically."""
    bar = FourBar(RING, tuple(np.radians([0, 67.5, 112.5, 157.5])))
    a, b, c, d = bar.points

    def turn(v, q):
        return np.array([math.cos(q) * v[0] + math.sin(q) * v[1], math.cos(q) * v[1] - math.sin(q) * v[0]])

    def positions(phi):
        bn = a + turn(b - a, phi)
        q2, q3 = fsolve(lambda q: bn + turn(c - b, q[0]) + turn(d - c, q[1]) - d, [0.0, 0.0], xtol=1e-12)
        centres = [np.array([m.x, m.z]) / m.mass for m in bar.links]
        return [
            (a + turn(centres[0] - a, phi), phi),
            (bn + turn(centres[1] - b, q2), q2),
            (d + turn(centres[2] - d, q3), q3),
        ]

    h = 1e-5
    for phi in (0.0, 0.02, 0.06, 0.1):
        lift = push = inertia = 0.0
        for m, (x1, q1), (x2, q2) in zip(bar.links, positions(phi - h), positions(phi + h), strict=True):
            u, w = (x2 - x1) / (2 * h), (q2 - q1) / (2 * h)
            lift, push = lift + m.mass * u[1], push + m.mass * u[0]
            inertia += m.mass * u @ u + w * w * m.about(m.x / m.mass, m.z / m.mass)
        found = bar.coefficients(phi)
        assert (float(found.lift), float(found.push), float(found.inertia)) == pytest.approx((lift, push, inertia), rel=1e-6, abs=0)


def test_restitution_equals_integration_over_the_material():
    """eta by summing u.w over a fine mesh of the arch, with velocities taken from the rotation centres of the links."""
    bar = FourBar(RING, tuple(np.radians([0, 67.5, 112.5, 157.5])))
    at, (a, b, _, d) = bar.at_rest(), bar.points
    s, rho = np.meshgrid((np.arange(3150) + 0.5) * RING.angle / 3150, 9.25 + (np.arange(60) + 0.5) * 0.025, indexing="ij")
    polar = math.pi / 2 + RING.angle / 2 - s
    x, z = rho * np.cos(polar), rho * np.sin(polar)

    def field(s, x, z):
        w2, w3 = at.second, at.third
        ux = np.select([s < bar.hinges[1], s < bar.hinges[2]], [z - a[1], b[1] - a[1] + w2 * (z - b[1])], w3 * (z - d[1]))
        uz = np.select([s < bar.hinges[1], s < bar.hinges[2]], [a[0] - x, a[0] - b[0] + w2 * (b[0] - x)], w3 * (d[0] - x))
        return ux, uz

    u = field(s, x, z)
    mirror = field(RING.angle - s, -x, z)
    w = -mirror[0], mirror[1]
    eta = ((-u[0] * w[0] - u[1] * w[1]) * rho).sum() / ((w[0] ** 2 + w[1] ** 2) * rho).sum()
    shared, own = bar.overlap()
    assert shared / own == pytest.approx(eta, abs=2e-5)


def test_scale_moves_only_p_and_the_mirror_image_moves_nothing():
    small, large = (
        built("kind: arch\nradius: 1\nthickness: 0.15\nangle: 160 deg"),
        built("kind: arch\nradius: 25\nthickness: 3.75\nangle: 160 deg"),
    )
    assert large.p * 5 == pytest.approx(small.p, rel=1e-11, abs=0)
    for name in ("alpha", "uplift", "a_scale", "eta"):
        assert getattr(large, name) == pytest.approx(getattr(small, name), rel=1e-10, abs=0)
    given = "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\nvoussoirs: 7\nhinges: "
    right = built(given + "[0, 67.5 deg, 112.5 deg, 157.5 deg]")
    faces = ["extrados", "intrados"] * 2
    left = built(given + str([{"angle": f"{s} deg", "face": f} for s, f in zip((0, 45, 90, 157.5), faces, strict=True)]))
    for name in ("p", "alpha", "uplift", "a_scale", "eta"):
        assert getattr(left, name) == pytest.approx(getattr(right, name), rel=1e-12, abs=0)


def test_family_over_the_papers_range_is_smooth():
    """Fig. 6: beta 150-180 deg, t/r 0.12-0.20. Between neighbours 1 deg apart each parameter moves by a few percent of its
    range at the most; slopes may change where an end hinge leaves the springing, values do not jump."""
    for ratio in (0.12, 0.16, 0.20):
        family = [built(f"kind: arch\nradius: 10\nthickness: {10 * ratio}\nangle: {beta} deg") for beta in range(150, 181)]
        for name in ("p", "alpha", "uplift", "a_scale", "eta"):
            values = np.array([getattr(a, name) for a in family])
            assert np.abs(np.diff(values)).max() < 0.12 * np.ptp(values), (ratio, name)


def test_voussoir_arches_jump_only_where_another_mechanism_takes_over():
    """With joints fixed the governing mechanism changes: there lambda stays continuous and p, alpha jump, elsewhere nothing does."""
    family = [built(f"kind: arch\nradius: 10\nthickness: 1.6\nangle: {beta} deg\nvoussoirs: 7") for beta in np.arange(150, 180.01, 0.25)]
    joints = [tuple(round(h["angle"] / (math.radians(150 + 0.25 * i) / 7)) for h in a.details["hinges"]) for i, a in enumerate(family)]
    changes = np.array([a != b for a, b in itertools.pairwise(joints)])
    assert 1 <= changes.sum() <= 4
    assert np.abs(np.diff([a.uplift for a in family])).max() < 0.01
    for name in ("p", "alpha"):
        steps = np.abs(np.diff([getattr(a, name) for a in family]))
        assert steps[~changes].max() < 0.1 * steps[changes].min()


@settings(max_examples=25)
@given(st.floats(130, 200), st.floats(0.13, 0.3), st.integers(0, 2**32 - 1))
def test_minimum_is_not_above_any_admissible_mechanism(beta, thickness, seed):
    ring = Ring(1.0, thickness, math.radians(beta))
    found = search_continuous(ring)
    assume(found is not None)  # short thick arches: the hinges run together
    random, tried = np.random.default_rng(seed), 0
    for _ in range(300):
        at = FourBar(ring, tuple(ring.angle * np.sort(random.uniform(size=4)))).at_rest()
        if at.admissible and at.push > 0:
            assert found[1] <= at.lift / at.push + 1e-12
            tried += 1
    assert tried > 5


@settings(max_examples=30)
@given(st.floats(120, 180), st.floats(0.14, 0.3), st.one_of(st.none(), st.integers(4, 30)))
def test_parameters_are_those_of_a_rocking_structure(beta, thickness, voussoirs):
    joints = "" if voussoirs is None else f"voussoirs: {voussoirs}\n"
    (document,) = parse_documents(f"kind: arch\nradius: 1\nthickness: {thickness!r}\nangle: {beta!r} deg\n{joints}")
    a = None
    with contextlib.suppress(DocumentError):
        a = build_structure(document)
    if a is None:  # outside the paper's range an arch may have no such mechanism, and is refused
        assert beta < 150 or thickness > 0.2 or voussoirs is not None
        return
    assert a.uplift > 0
    assert a.alpha > 0
    assert 0 <= a.eta <= 1
    assert a.a_scale == pytest.approx(a.alpha / a.uplift, rel=1e-12, abs=0)


REFUSED = [
    ("kind: arch\nradius: 10\nthickness: 1\nangle: 180 deg", "thickness: found 1: the arch cannot carry its own weight"),
    ("kind: arch\nradius: 10\nthickness: 1.5\nangle: 0", "angle: found 0; accepted is an angle between 0 and 360 deg"),
    ("kind: arch\nradius: 10\nthickness: 1.5\nangle: 360 deg", "found 360 deg; accepted is an angle between 0 and 360 deg"),
    ("kind: arch\nradius: 10\nthickness: 20\nangle: 90 deg", "found 20; accepted is a length between 1e-09 m and 20 m"),
    ("kind: arch\nradius: 10\nthickness: -1\nangle: 90 deg", "found -1; accepted is a length between"),
    (OPPENHEIM + "voussoirs: 3", "found 3; accepted is a whole number from 4"),
    (OPPENHEIM + "voussoirs: 7.5", "found 7.5; accepted is a whole number from 4"),
    ("kind: arch\nradius: 10\nthickness: 1\nangle: 180 deg\nhinges: [0, 40 deg, 120 deg, 180 deg]", "cannot carry its own weight"),
    ("kind: arch\nradius: 1\nthickness: 0.82\nangle: 222 deg\nvoussoirs: 5", "no linkage of four hinges that governs"),
    (
        "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5",
        "found 157.5; accepted is an angle between 0 and 360 deg .a bare number is in rad",
    ),
    ("kind: arch\nradius: 1\nthickness: 0.74\nangle: 255 deg\nvoussoirs: 6", "no linkage of four hinges that governs"),
    ("kind: arch\nradius: 1\nthickness: 1.62\nangle: 303.2 deg\nvoussoirs: 16", "cannot carry its own weight"),
    (OPPENHEIM + "hinges: [0, 1]", "found a list; accepted is four angles"),
    (OPPENHEIM + "hinges: 3", "found 3; accepted is four angles"),
    (OPPENHEIM + "hinges: [0, 2, 1, 2.7]", "angles out of order"),
    (OPPENHEIM + "hinges: [0, 1, 2, 3]", "beyond the springings"),
    (OPPENHEIM + "hinges: [0, 1 kg, 2, 2.7]", "found 1 kg; accepted is four angles"),
    (OPPENHEIM + "hinges: [{angle: 0, face: intrados}, {angle: 1, face: intrados}, 2, 2.7]", "faces that do not alternate"),
    (OPPENHEIM + "hinges: [{angle: 0, fac: intrados}, 1, 2, 2.7]", "unknown key 'fac' .did you mean 'face'"),
    (OPPENHEIM + "voussoirs: 7\nhinges: [0, 1, 2, 2.7]", "between two joints"),
    (OPPENHEIM + "hinges: [0, 0.1, 0.2, 0.3]", "do not open on their far faces"),
]


@pytest.mark.parametrize(("text", "words"), REFUSED, ids=range(len(REFUSED)))
def test_refusals(text, words):
    (document,) = parse_documents(text, "f.yaml")
    with pytest.raises(DocumentError, match=words):
        build_structure(document)

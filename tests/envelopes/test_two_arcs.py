"""Bodies that one impact meets in the second push: when and how fast, by other ways, and that nothing changes where nothing may."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from rocking_cli import Motion, Outcome, cosine, linear_response, pulse, sine
from rocking_cli.envelopes.closed_form import _FirstSide
from rocking_cli.envelopes.two_arcs import TwoPushes
from rocking_cli.motions import Harmonic, Piece


def pieces(*parts):
    """A motion of pieces, each (stop, constant, slope, harmonics)."""
    starts = [0.0, *(stop for stop, *_ in parts)]
    return Motion("pieces", tuple(Piece(start, stop, waves, c, r) for start, (stop, c, r, waves) in zip(starts, parts, strict=False)))


SKEWED = pieces((2.0 * math.pi, 0.0, 0.0, (Harmonic(1.0, 1.0, 0.0), Harmonic(-0.2, 2.0, 0.0))))
UNLIKE = pieces(
    (math.pi, 0.0, 0.0, (Harmonic(1.0, 1.0, 0.0),)), (6.0, -0.4, 0.1, (Harmonic(0.3, 0.5, math.pi),))
)  # a jump between its pushes
CROSSING = pieces((3.1, 0.0, 0.0, (Harmonic(1.0, 1.0, 0.0),)), (6.5, 0.04, -0.25, ()))  # zero just inside its last piece
RISING = pieces(
    (math.pi, 0.0, 0.0, (Harmonic(1.0, 1.0, 0.0),)), (math.pi + 20.0, 0.0, -0.03, ())
)  # to its end, with a ridge from A = 1.67 on
MOTIONS = [sine(), cosine(0.5), SKEWED, UNLIKE]
NAMES = ["sine", "half a cosine", "skewed", "unlike"]


def integral(motion, omega, weight, begin, end):
    """int weight(u) s(omega u) du by quadrature."""
    kinks = [x for x in motion.segments.start / omega if begin < x < end]
    value, _ = quad(
        lambda u: weight(u) * float(motion.value(omega * u)), begin, end, points=kinks or None, epsabs=0, epsrel=1e-12, limit=300
    )
    return value


def around(weight, there, sense):
    """exp(sense (u - there))."""
    return lambda u: weight(sense * (u - there))


@pytest.mark.parametrize("motion", [*MOTIONS, CROSSING], ids=[*NAMES, "crossing"])
def test_impacts_and_integrals_are_those_of_quadrature(motion):
    pushes, random = TwoPushes.of(motion.segments), np.random.default_rng(2)
    before, after = motion.value(pushes.turn + np.array([-1e-9, 1e-9]))
    assert before * after < 0.0
    amplitude, omega = random.uniform(1.1, 4.0, 40), random.uniform(0.8, 6.0, 40)
    found = pushes.strikes(amplitude, omega)
    clear = np.flatnonzero(found.clear)[:4]
    assert clear.size >= 3
    for a, w, lift, time, *integrals in zip(amplitude[clear], omega[clear], *(x[clear] for x in found[:7]), strict=True):
        turn, end = pushes.turn / w, pushes.end / w
        push = np.sign(motion.value(w * lift + 1e-9))

        def height(t, a=a, w=w, lift=lift, push=push):
            return a * push * integral(motion, w, around(math.sinh, t, -1.0), lift, t) - (math.cosh(t - lift) - 1.0)

        assert time == pytest.approx(brentq(height, turn, end, xtol=1e-13), rel=0, abs=1e-9)
        expected = (
            integral(motion, w, around(math.exp, turn, 1.0), lift, turn), -integral(motion, w, around(math.exp, time, 1.0), turn, time),
            -integral(motion, w, around(math.exp, time, -1.0), time, end), -integral(motion, w, around(math.exp, end, 1.0), time, end),
            -integral(motion, w, lambda u: 1.0, time, end),
        )  # fmt: skip
        assert integrals == pytest.approx([push * x for x in expected], rel=1e-9, abs=1e-10)


def test_under_a_sine_impacts_are_those_of_the_closed_form():
    random = np.random.default_rng(3)
    amplitude, omega = random.uniform(1.05, 3.5, 300), random.uniform(0.6, 9.0, 300)
    found = TwoPushes.of(sine().segments).strikes(amplitude, omega)
    assert 50 < np.count_nonzero(found.clear) < 250
    for a, w, t, lift in zip(*(x[found.clear] for x in (amplitude, omega, found.time, found.lift)), strict=True):
        assert t - lift == pytest.approx(_FirstSide(a, w).impact(), rel=0, abs=1e-9)


@pytest.mark.parametrize("eta", [0.9, 0.0])  # without a rebound the mode is that of the drive alone
@pytest.mark.parametrize("motion", MOTIONS, ids=NAMES)
def test_over_a_stretch_speeds_and_modes_lie_between_their_bounds(motion, eta):
    pushes, random = TwoPushes.of(motion.segments), np.random.default_rng(5)
    low, omega = random.uniform(1.0, 5.0, 300), random.uniform(0.5, 9.0, 300)
    high = low * (1.0 + 10.0 ** random.uniform(-7.0, -0.5, 300))
    ends = pushes.strikes(low, omega), pushes.strikes(high, omega)
    bounds = pushes.between(*ends, low, high, omega, eta)
    clear = ends[0].clear & ends[1].clear
    for share in (0.0, 0.02, 0.3, 0.5, 0.9, 1.0):
        amplitude = low + share * (high - low)
        there = pushes.strikes(amplitude, omega)
        assert np.all(there.clear[clear])
        faded = np.exp(pushes.turn / omega - there.time)
        speed = eta * (1.0 - np.exp(there.lift - there.time) + amplitude * (there.second - faded * there.first))
        left = pushes.end / omega - there.time
        mode = speed - 1.0 + amplitude * there.ahead
        height = speed * np.sinh(left) - np.cosh(left) + 1.0 + amplitude * 0.5 * (np.exp(left) * there.ahead - there.faded)
        for value, least, most in ((speed, *bounds[:2]), (mode, *bounds[2:4]), (height, bounds.height, np.inf)):
            assert np.all((least <= value) & (value <= most) | ~clear)
    narrow = clear & (high - low < 1e-5)
    assert narrow.sum() > 10
    assert np.all((bounds.fastest - bounds.slowest)[narrow] < 2e-3)


@pytest.mark.parametrize("count", [150, pytest.param(20_000, marks=pytest.mark.soak)])
@pytest.mark.parametrize("motion", MOTIONS, ids=NAMES)
def test_where_nothing_may_change_nothing_does(motion, count):
    pushes, random = TwoPushes.of(motion.segments), np.random.default_rng(4)
    low, omega = random.uniform(1.0, 5.0, count), random.uniform(0.5, 9.0, count)
    high = low * (1.0 + 10.0 ** random.uniform(-4.0, -0.3, count))
    ends = pushes.strikes(low, omega), pushes.strikes(high, omega)
    seen = set()
    for eta in (0.0, 0.5, 0.9, 1.0):
        inside = low + (high - low) * np.linspace(0.0, 1.0, 33)[:, None]
        found = linear_response(motion, inside, omega, eta, peaks=False)
        settled = ~pushes.may_change(*ends, low, high, omega, eta)
        outcome = found.outcome[:, settled]
        assert np.all(outcome == outcome[0])
        assert np.all(found.impacts[:, settled] > 0)
        seen |= set(outcome[0].tolist())
    assert seen == {Outcome.ROCKED, Outcome.OVERTURNED_AFTER_IMPACT}


def test_stretches_are_settled_close_to_a_boundary():
    """Of one sine cycle at Omega = 4 the body overturns from 1.7954 to 4.8501."""
    pushes, omega = TwoPushes.of(sine().segments), np.full(4, 4.0)
    low, high = np.array([1.75, 1.795, 1.81, 2.4]), np.array([1.753, 1.796, 1.812, 2.41])
    ends = pushes.strikes(low, omega), pushes.strikes(high, omega)
    assert pushes.may_change(*ends, low, high, omega, 0.9).tolist() == [False, True, False, False]


@pytest.mark.parametrize(
    ("motion", "low", "high", "omega", "eta"),
    [(sine(), 1.016, 1.287, 0.851, 0.5), (sine(), 1.44, 2.15, 1.188, 1.0), (RISING, 1.38, 1.49, 2.211, 1.0)],
    ids=["the lower end is struck before the second ridge", "the upper end is not struck", "struck once more before the end"],
)
def test_outcomes_change_where_a_condition_of_the_lemma_is_not_met(motion, low, high, omega, eta):
    pushes, (low, high, omega) = TwoPushes.of(motion.segments), np.array([[low], [high], [omega]])
    found = linear_response(motion, np.linspace(low, high, 17), omega, eta, peaks=False)
    assert np.unique(found.outcome).size > 1
    assert pushes.may_change(pushes.strikes(low, omega), pushes.strikes(high, omega), low, high, omega, eta).all()


def test_a_stretch_in_which_the_second_push_gets_a_ridge_is_not_settled():
    """Beside it stretches of as small a change are, without a ridge and with one."""
    pushes, omega = TwoPushes.of(UNLIKE.segments), np.full(3, 4.0)
    largest = float(np.abs(UNLIKE.value(np.linspace(math.pi, 6.0, 100_001)[1:])).max())
    low, high = np.array([0.97, 0.99, 1.01]) / largest, np.array([0.98, 1.01, 1.02]) / largest
    ends = pushes.strikes(low, omega), pushes.strikes(high, omega)
    assert [x.ridge.tolist() for x in ends] == [[False, False, True], [False, True, True]]
    assert np.all(ends[0].clear & ends[1].clear)
    assert pushes.may_change(*ends, low, high, omega, 0.5).tolist() == [False, True, False]


def test_other_motions_are_not_of_this_kind():
    twice = pieces((2.0 * math.pi, 0.0, 0.0, (Harmonic(1.0, 1.0, 0.0), Harmonic(0.9, 3.0, 0.0))))  # each push swells twice
    back = pieces((math.pi, 0.0, 0.0, (Harmonic(1.0, 1.0, 0.0),)), (4.0, 0.0, -0.5, ()), (5.0, -0.3, 0.1, ()), (6.0, -0.2, -0.1, ()))
    assert twice.segments.pushes == back.segments.pushes == 2
    for motion in (back, sine(0.5), sine(1.5), cosine(1), pulse("rectangular-impulse"), pulse("ricker-symmetric"), twice):
        assert TwoPushes.of(motion.segments) is None

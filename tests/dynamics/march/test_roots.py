"""Impacts and turning points of polynomials whose roots are known, and the proof that a
step has one turn at most.
"""

import numpy as np
import pytest
from numpy.polynomial import polynomial

from rocking_cli.dynamics.march.one_turn import one_turn, turns_by_signs
from rocking_cli.dynamics.march.roots import (
    bernstein_form,
    fall_guess,
    only_root,
    turn_guess,
)

TERMS = 12


@pytest.fixture(autouse=True)
def as_in_the_march():
    """The march looks for roots without warnings."""
    with np.errstate(all="ignore"):
        yield


PLACES = [1e-6, 1e-3, 0.05, 0.31, 0.5, 0.77, 0.999, 1.0 - 1e-9, 1.0]


def padded(rows, count=TERMS):
    """Polynomials as terms, (count, lanes)."""
    return np.array([np.pad(row, (0, count - len(row))) for row in rows]).T


def positive(random):
    """A polynomial of degree 8 that is positive on [0, 1]."""
    tail = random.uniform(-1.0, 1.0, 8) / 2.0 ** np.arange(1.0, 9.0)
    return np.append(1.0 + np.abs(tail).sum(), tail)


def value(terms, s, times=0):
    """The derivative of each lane at its s."""
    return np.array(
        [
            polynomial.polyval(x, polynomial.polyder(c, times))
            for c, x in zip(terms.T, s, strict=True)
        ]
    )


@pytest.mark.parametrize("start", [0.3, 0.0], ids=["above", "from the ground"])
def test_the_only_fall_is_found_near_the_start_inside_and_at_the_end(start):
    """y = (s + start)(1 - s/root) q, q > 0."""
    random = np.random.default_rng(1)
    roots = np.repeat(PLACES, 20)
    rows = [
        polynomial.polymul(
            polynomial.polymul([start, 1.0], [1.0, -1.0 / root]), positive(random)
        )
        for root in roots
    ]
    terms = padded(rows)
    guess, low, high = fall_guess(terms)
    assert np.all((low < roots * (1.0 + 1e-9)) & (roots <= high * (1.0 + 1e-9)))
    s, y, speed, rate = only_root(terms, guess, low, high, speed=False)
    assert s == pytest.approx(roots, rel=1e-13, abs=0.0)
    assert np.abs(y).max() < 1e-14
    assert speed == pytest.approx(value(terms, roots, 1), rel=1e-11)
    assert rate == pytest.approx(value(terms, roots, 2), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("after", [0.1, 0.4])
def test_a_fall_is_looked_for_after_an_instant(after):
    """y = (s - 0.8 after)(1.2 after - s)...: below zero, above it, and below again."""
    random = np.random.default_rng(2)
    roots = np.linspace(after + 0.05, 1.0, 40)
    rows = [
        polynomial.polymul(
            polynomial.polyfromroots([0.9 * after, root]), -positive(random)
        )
        for root in roots
    ]
    terms = padded(rows)
    found = only_root(terms, *fall_guess(terms, np.full(40, after)), speed=False)
    assert found[0] == pytest.approx(roots, rel=1e-12)


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12, 0.0])
def test_a_grazing_fall_before_the_turn_at_the_end_is_found(gap):
    """Two roots, gap apart, about the end of the step, where the body turns outwards:
    y is zero to rounding there, and the root is off by what that comes to.
    """
    random = np.random.default_rng(3)
    scale = np.array([positive(random)[0] for _ in range(30)])
    rows = [
        factor * polynomial.polyfromroots([1.0 - 0.5 * gap, 1.0 + 0.5 * gap])
        for factor in scale
    ]
    terms = padded(rows)
    s, y, speed, _ = only_root(terms, *fall_guess(terms), speed=False)
    rounding = 1e-15 * scale
    assert np.all(np.abs(y) <= rounding)
    assert np.all(np.abs(s - (1.0 - 0.5 * gap)) <= 4.0 * np.sqrt(1e-15) + 1e-15)
    if gap >= 1e-6:
        assert speed == pytest.approx(-scale * gap, abs=4e-15 / gap)


def test_the_only_turn_is_found_near_the_start_inside_and_at_the_end():
    """y' = (1 - s/root) q, q > 0, from the polygon of its coefficients."""
    random = np.random.default_rng(4)
    roots = np.repeat(PLACES, 20)
    rows = [
        polynomial.polyint(
            polynomial.polymul([1.0, -1.0 / root], positive(random)), k=[0.2]
        )
        for root in roots
    ]
    terms = padded(rows)
    turns = turns_by_signs(terms)
    assert np.all(turns.outward)
    inside = roots < 1.0
    known = turns.turns & (turns.share == 1.0)
    assert np.count_nonzero(known[inside]) > 0.9 * np.count_nonzero(inside)
    at = np.flatnonzero(known)
    s, y = only_root(terms[:, at], turns.guess[at], speed=True)[:2]
    top = value(terms[:, at], roots[at])
    assert s == pytest.approx(roots[at], rel=1e-7)
    np.testing.assert_allclose(y, top, rtol=1e-14)


def test_the_guess_of_a_turn_is_the_zero_of_the_polygon():
    speeds = np.array([[1.0, -1.0], [0.5, -0.5], [-0.5, 1.5], [-1.0, 2.0]])
    assert turn_guess(speeds, speeds >= 0.0).tolist() == [1.5 / 3.0, 1.25 / 3.0]


def test_bernstein_coefficients_are_those_of_the_polynomial():
    """A line is the line between its ends, and the mean of the coefficients the
    integral.
    """
    random = np.random.default_rng(5)
    terms = random.uniform(-1.0, 1.0, (9, 50))
    found = bernstein_form(terms)
    np.testing.assert_allclose(found[0], terms[0])
    np.testing.assert_allclose(found[-1], terms.sum(axis=0))
    integral = (terms / np.arange(1.0, 10.0)[:, None]).sum(axis=0)
    np.testing.assert_allclose(found.mean(axis=0), integral)


@pytest.mark.parametrize("proof", [turns_by_signs, one_turn])
@pytest.mark.parametrize("growth", [0.05, 0.5, 4.0])
def test_a_part_with_one_turn_at_most_has_the_turns_that_are_said(proof, growth):
    """Polynomials that hardly bend, bend once, and turn several times: their roots by
    the eigenvalues of their companion matrices.
    """
    random, lanes = np.random.default_rng(7), 400
    steep = growth ** np.maximum(np.arange(9.0) - 2.0, 0.0)[:, None]
    terms = random.normal(size=(9, lanes)) * steep / 2.0 ** np.arange(9.0)[:, None]
    found = proof(terms)
    shorter = turned = 0
    for lane in range(lanes):
        speed = polynomial.polyder(terms[:, lane])
        roots = polynomial.polyroots(speed)
        roots = roots.real[np.abs(roots.imag) < 1e-9]
        inside = roots[(roots > 0.0) & (roots < found.share[lane])]
        assert inside.size == found.turns[lane], lane
        assert found.outward[lane] == (speed[0] >= 0.0)
        shorter += found.share[lane] < 1.0
        turned += inside.size
        raster = np.linspace(0.0, found.share[lane], 101)
        fastest = np.abs(polynomial.polyval(raster, speed)).max()
        bend = np.abs(polynomial.polyval(raster, polynomial.polyder(speed))).max()
        share = found.share[lane]
        assert fastest * share <= found.fastest[lane] * (1.0 + 1e-12)
        assert bend * share**2 <= found.largest_acceleration[lane] * (1.0 + 1e-12)
    assert turned > 20
    assert shorter > 5 or growth < 1.0


@pytest.mark.parametrize("lanes", [1, 2, 7, 5000])
def test_terms_of_zero_and_other_lanes_change_no_digit(lanes):
    random = np.random.default_rng(8)
    terms = random.normal(size=(9, lanes)) / 3.0 ** np.arange(9.0)[:, None]
    terms[0] = np.abs(terms[0])
    more = np.concatenate([terms, np.zeros((6, lanes))])
    fall = np.concatenate([terms[:1], -np.abs(terms[1:])]) - 0.0
    fall[1] -= fall[0]
    long = np.concatenate([fall, np.zeros((6, lanes))])
    for one, other in (
        (one_turn(terms), one_turn(more)),
        (fall_guess(fall), fall_guess(long)),
        (
            only_root(fall, *fall_guess(fall), speed=False),
            only_root(long, *fall_guess(long), speed=False),
        ),
    ):
        for x, y in zip(one, other, strict=True):
            np.testing.assert_array_equal(x, y)
    last = terms[:, -1:]
    for x, y in zip(one_turn(terms), one_turn(last), strict=True):
        np.testing.assert_array_equal(x[-1:], y)
    for x, y in zip(turns_by_signs(terms), turns_by_signs(last), strict=True):
        np.testing.assert_array_equal(x[-1:], y)
    alone = only_root(fall[:, -1:], *fall_guess(fall[:, -1:]), speed=False)
    np.testing.assert_array_equal(
        only_root(fall, *fall_guess(fall), speed=False)[:, -1:], alone
    )

"""Steps of a mechanism, against another integration and against shorter ones."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support import references
from support.documents import built

from rocking_cli import pulse, sine
from rocking_cli.dynamics.equations.mechanism import MechanismEquation
from rocking_cli.dynamics.system import System

ARCHES = {
    "voussoirs": "radius: 10 m\nthickness: 1.5 m\nangle: 157.5 deg\nvoussoirs: 7",
    "thick": "radius: 10 m\nthickness: 2.5 m\nangle: 150 deg",
    "barely stands": "radius: 10 m\nthickness: 1.09 m\nangle: 180 deg",
}


def mechanism(name):
    return built(f"kind: arch\n{ARCHES[name]}\nrestitution: 0.8").mechanism


def drive(segments, k, u):
    """s at phase u of segment k, or beyond its end."""
    angle = segments.frequency[:, k] * u
    return segments.s_start[k] + (
        segments.sin[:, k] * (np.cos(angle) - 1.0) + segments.cos[:, k] * np.sin(angle)
    ).sum(axis=0)


def lanes_of(equation, segments, count, seed):
    """Bodies on either side, at any phase of the motion, as fast as they may come to
    be, with the force that acts on them.
    """
    random = np.random.default_rng(seed)
    k = random.integers(0, len(segments), count)
    u, side = random.uniform(0.0, segments.length[k]), random.choice([-1.0, 1.0], count)
    amplitude, omega = (
        random.uniform(1.0, 12.0, count),
        random.uniform(0.5, 12.0, count),
    )
    y, v = (
        random.uniform(0.0, min(2.5, 0.5 * equation.limit), count),
        random.uniform(-3.0, 3.0, count),
    )
    b = equation.force(y, -side * amplitude * drive(segments, k, u))
    return references.lanes(
        amplitude=amplitude,
        omega=omega,
        segment=k,
        phase=u,
        side=side,
        y=y,
        v=v,
        force=b,
    )


@pytest.mark.parametrize(
    ("name", "tolerance", "motion"),
    [
        ("thick", 1e-4, sine()),
        ("barely stands", 1e-9, sine()),
        ("voussoirs", 1e-9, pulse("ricker-symmetric")),
    ],
    ids=lambda x: getattr(x, "name", x),
)
def test_arcs_are_those_of_another_integration(name, tolerance, motion):
    equation = MechanismEquation(mechanism(name), tolerance)
    segments = System(equation).segments(motion)
    lanes = lanes_of(equation, segments, 15, 7)
    arc = equation.flow(segments, lanes)
    looked = 0
    for i in range(lanes.y.size):
        one = arc.take(np.full(3, i))
        times = np.array([0.2, 0.6, 1.0]) * arc.longest[i]
        point, state, begin = one.at(times), [lanes.y[i], lanes.v[i]], 0.0

        def rate(tau, state, i=i):
            s = drive(segments, lanes.segment[i], lanes.phase[i] + lanes.omega[i] * tau)
            return [
                state[1],
                float(
                    equation.force(state[:1], -lanes.side[i] * lanes.amplitude[i] * s)[
                        0
                    ]
                ),
            ]

        for y, v, end in zip(point.y, point.v, times, strict=True):
            state = solve_ivp(
                rate, (begin, end), state, method="DOP853", rtol=1e-12, atol=1e-13
            ).y[:, -1]
            begin = end
            if state[0] < 0.0:  # below the ground, where `force` is not asked
                break
            assert y == pytest.approx(
                state[0], rel=0, abs=0.3 * tolerance * arc.longest[i] + 1e-12
            )
            assert v == pytest.approx(state[1], rel=0, abs=0.3 * tolerance + 1e-12)
            looked += 1
    assert looked > 20


def followed(equation, segments, lanes, until):
    """y and v of every lane after these times, NaN where it has been
    below the ground.
    """
    left, above = until.copy(), np.ones(until.shape, dtype=bool)
    lanes = lanes.take(slice(None))
    while left.any():
        arc = equation.flow(segments, lanes)
        h = np.minimum(
            np.minimum(arc.longest, left), 0.2 / (1.0 + np.abs(lanes.v))
        )  # inside the patch that a series is of
        there = arc.at(h)
        left -= h
        lanes.phase, lanes.y, lanes.v, lanes.force = (
            lanes.phase + h * lanes.omega,
            there.y,
            there.v,
            there.b,
        )
        above &= there.y >= 0.0
        left[~above] = 0.0
    return np.where(above, lanes.y, np.nan), np.where(above, lanes.v, np.nan)


def test_steps_end_where_their_patch_was_fitted():
    """Beyond it they converge to what the polynomial of the patch is there, which is
    not the linkage's.
    """
    equation = MechanismEquation(mechanism("voussoirs"), 1e-12)
    segments = System(equation).segments(sine())
    lanes = lanes_of(equation, segments, 2000, 3)
    lanes = lanes.take(np.flatnonzero(np.abs(lanes.v) > 2.0))
    arc = equation.flow(segments, lanes)
    found, (y, v) = (
        arc.at(arc.longest),
        followed(equation, segments, lanes, arc.longest),
    )
    assert np.isfinite(y).sum() > 300
    assert np.nanmax(np.abs(found.y - y)) < 1e-13
    assert np.nanmax(np.abs(found.v - v)) < 1e-12

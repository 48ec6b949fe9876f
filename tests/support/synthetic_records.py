"""Synthetic records, cells under them, and what rounding may come to in each: for the
tests of the engines.
"""

import numpy as np

from rocking_cli import LinearEquation, Motion, Record, Recording, System, response
from rocking_cli.fragility.measures import MotionMember, pulse_intensity
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical


def recorded(samples, dt, name="r", factor=1.0):
    """Samples [m/s2] as a recording."""
    return Recording(
        Record(
            name,
            "text",
            None,
            dt,
            np.array(samples, dtype=float),
            None,
            "m/s2",
            name,
            name * 64,
        ),
        factor,
    )


def shaken(samples, dt):
    return recorded(samples, dt).motion


def pulsed(motion, acceleration, omega, weight=1.0):
    """A pulse of this peak [m/s2] and frequency [rad/s] as a motion of a set."""
    return MotionMember(
        motion.name,
        acceleration,
        omega,
        pulse_intensity(motion, acceleration, omega),
        weight,
        pulse=motion,
    )


def noise(count, dt, seed, quiet=0):
    """A synthetic record: noise about 2.5 Hz that swells and fades, after `quiet`
    samples of rest.
    """
    random, f = np.random.default_rng(seed), np.fft.rfftfreq(count, dt)
    colour = (
        f
        * f
        / (
            (0.3 + f * f)
            * np.sqrt((1.0 - (f / 2.5) ** 2) ** 2 + (f / 2.5) ** 2)
            * (1.0 + (f / 12.0) ** 4)
        )
    )
    t = np.arange(count) / count
    return np.append(
        np.zeros(quiet),
        np.fft.irfft(np.fft.rfft(random.standard_normal(count)) * colour, count)
        * t
        * np.exp(-6.0 * t),
    )


def long_series(motion):
    """The same motion with a sinusoid of no height in each piece, for which the march
    takes its long series, not the short ones.
    """
    return Motion(
        motion.name,
        tuple(
            Piece(p.start, p.stop, (Harmonic(0.0),), p.constant, p.slope)
            for p in motion.pieces
        ),
    )


def upwards(one, other, share):
    """A record with another one upwards, of `share` times its peak; and both as
    `long_series`.
    """
    share, long = (
        share * one.acceleration / other.acceleration,
        with_vertical(long_series(one), long_series(other), share),
    )
    return with_vertical(one, other, share), long


RECORDS = [noise(100, 0.05, 1), noise(110, 0.05, 2, quiet=40), noise(120, 0.04, 3)]


def weighed(part, share, record, dt=0.04):
    """Samples of RECORDS with others upwards; and both as `long_series`."""
    return upwards(
        shaken(RECORDS[record][part], dt), shaken(noise(120, 0.04, 8)[part], dt), share
    )


def cells(count, seed):
    """A from 1 to 8, some just above uplift; 2 pi/p from 0.5 to 12 s in a record's own
    time.
    """
    random = np.random.default_rng(seed)
    near = count // 5
    amplitude = np.append(
        random.uniform(1.0, 8.0, count - near),
        1.0 + 10.0 ** random.uniform(-4.0, -0.5, near),
    )
    return amplitude, np.exp(random.uniform(np.log(0.5), np.log(12.0), count)) / (
        2.0 * np.pi
    )


LINEAR = System(LinearEquation())


def allowance(motion, amplitude, omega, eta, system=LINEAR):
    """What rounding may come to in each cell of a system, 1e-12 of its condition,
    infinite next to a boundary of outcome.
    """
    cell = np.array(np.broadcast_arrays(amplitude, omega, np.abs(eta)))
    shifted = np.repeat(cell[None], 6, axis=0)
    for k in range(3):
        shifted[2 * k, k] *= 1.0 - 1e-7
        shifted[2 * k + 1, k] = np.minimum(
            shifted[2 * k + 1, k] * (1.0 + 1e-7), 1.0 if k == 2 else np.inf
        )
    amplitudes, omegas, etas = shifted.transpose(1, 0, 2)
    theta = response(
        system, motion, amplitudes, omegas, np.copysign(etas, eta)
    ).theta_ratio
    width = np.array(
        [np.abs(shifted[2 * k + 1, k] - shifted[2 * k, k]) for k in range(3)]
    )
    slope = (
        np.abs(theta[1::2] - theta[::2])
        * np.abs(cell)
        / np.where(width == 0.0, 1.0, width)
    )
    return 1e-12 * (1.0 + np.nan_to_num(slope.sum(axis=0), nan=np.inf))


def room(system):
    """Times rounding: what the closed forms of a system may be off, or its series."""
    return 1.0 if system.equation.bounded else 1e3


def assert_same(found, theta, outcome, allowed):
    np.testing.assert_array_equal(found.outcome, outcome)
    still = np.isfinite(theta)
    np.testing.assert_array_equal(np.isfinite(found.theta_ratio), still)
    assert np.all(np.abs(found.theta_ratio - theta)[still] <= allowed[still])

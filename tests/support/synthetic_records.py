"""Synthetic records, cells under them, and what rounding may come to in each: for the
tests of the engines.

Two have the character of real records, for what a person waits for: `far_shock` (8,000
samples of 0.005 s) and `near_shock` (1,560 samples of 0.02 s). Both return
(samples [m/s2], dt [s]); `at2_file` writes one as a file that the command line reads.
"""

from pathlib import Path

import numpy as np
from support.record_layouts import at2

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


def motion_of_samples(samples, dt):
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


def _filtered(noise, dt, lowest, corner, highest):
    """Samples of which the frequencies [Hz] from `lowest` to `highest` are left, with
    amplitudes that fall as 1/f above `corner`; their sum is zero, so that the ground
    comes to rest.
    """
    # twice the length: the end of the record does not reach round to its start
    f = np.fft.rfftfreq(2 * noise.size, dt)
    low = f**4 / (lowest**4 + f**4)
    high = 1.0 / (1.0 + (f / highest) ** 8)
    shape = low * high / np.sqrt(1.0 + (f / corner) ** 2)
    return np.fft.irfft(np.fft.rfft(noise, 2 * noise.size) * shape)[: noise.size]


def _white(count, seed):
    """Independent values from -1 to 1; a `RandomState` gives the same in every version
    of NumPy.
    """
    return np.random.RandomState(seed).uniform(-1.0, 1.0, count)


def _at_peak(samples, peak):
    """Samples of this peak [m/s2], at rest at both ends, on a step of 1e-6 m/s2: below
    it the last bits of a Fourier transform differ between processors.
    """
    ramp = np.minimum(1.0, np.arange(samples.size) / 50.0)
    samples = samples * ramp * ramp[::-1]
    return np.round(samples * (peak / np.abs(samples).max()), 6)


def far_shock():
    """(samples [m/s2], 0.005 s): 40 s with energy up to 30 Hz; a weak first arrival, a
    strong phase of 10 s with a peak of 4 m/s2, and a long coda of lower frequencies.
    """
    count, dt = 8000, 0.005
    t = dt * np.arange(count)
    first = np.where((t > 1.0) & (t < 4.0), 0.12, 0.0)
    strong = np.clip((t - 4.0) / 1.5, 0.0, 1.0) ** 2 * np.exp(
        -0.45 * np.maximum(t - 14.0, 0.0)
    )
    coda = np.where(t > 9.0, 0.45 * np.exp(-0.08 * (t - 9.0)), 0.0)

    waves = _filtered(_white(count, 11) * (first + strong), dt, 0.15, 5.0, 30.0)
    surface = _filtered(_white(count, 12) * coda, dt, 0.08, 0.6, 6.0)
    # the two parts by their own peaks: the coda is a sixth of the strong phase
    return (
        _at_peak(
            waves / np.abs(waves).max() + surface / (6.0 * np.abs(surface).max()), 4.0
        ),
        dt,
    )


def near_shock():
    """(samples [m/s2], 0.02 s): 31.2 s as El Centro 1940, with a peak of 3.4 m/s2 in
    the first seconds, energy from 0.3 to 8 Hz, and later bursts at 11 s and 25 s.
    """
    count, dt = 1560, 0.02
    t = dt * np.arange(count)
    onset = np.clip(t / 1.5, 0.0, 1.0) ** 2
    main = onset * np.exp(-0.35 * np.maximum(t - 5.0, 0.0))
    later = 0.45 * np.exp(-(((t - 11.0) / 1.5) ** 2)) + 0.3 * np.exp(
        -(((t - 25.0) / 2.0) ** 2)
    )
    noise = _white(count, 5) * (main + later + 0.08 * onset)
    return _at_peak(_filtered(noise, dt, 0.3, 1.5, 8.0), 3.4), dt


def at2_file(path, samples, dt):
    """The path of a record of these samples [m/s2], written there as PEER AT2, in g."""
    Path(path).write_text(at2(samples / 9.81, dt), encoding="ascii")
    return Path(path)


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
        motion_of_samples(RECORDS[record][part], dt),
        motion_of_samples(noise(120, 0.04, 8)[part], dt),
        share,
    )


def random_cells(count, seed):
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

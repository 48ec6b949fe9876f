"""The Taylor series of the linear equation against its closed form in 40 digits."""

import math

import mpmath
import numpy as np
import pytest
from support.bodies import OnSeries
from support.references import lanes

from rocking_cli import Motion
from rocking_cli.dynamics.drive import drive_change
from rocking_cli.motions import Harmonic, Piece

ONE = (Harmonic(0.8, 1.0, 0.4),)
MULTIPLES = (Harmonic(0.5, 0.7, 0.1), Harmonic(0.4, 1.4, 0.9), Harmonic(-0.3, 2.1, 1.7))
OTHERS = (Harmonic(0.5, 1.0, 0.3), Harmonic(0.3, 1.7, 1.0), Harmonic(-0.4, 0.6, 0.2))


def closed_form(y, v, sinusoids, level, slope, h, damping):
    """y and its first three derivatives after h, from both modes and the steady motion
    under the drive level + slope h + sum size sin(w h + angle).
    """
    with mpmath.workdps(40):
        y, v, h, level, slope, zeta = (
            mpmath.mpf(float(x)) for x in (y, v, h, level, slope, damping)
        )
        root = mpmath.sqrt(1 + zeta * zeta)
        up, down = root - zeta, -root - zeta

        def steady(t, n):
            total = (
                1 - level - slope * t - 2 * zeta * slope
                if n == 0
                else -slope * (n == 1)
            )
            for size, w, angle in sinusoids:
                size, w, angle = (mpmath.mpf(float(x)) for x in (size, w, angle))
                gain = size / mpmath.mpc(-w * w - 1, 2 * zeta * w)
                turned = mpmath.mpc(0, w) ** n * mpmath.expj(w * t + angle)
                total += (gain * turned).imag
            return total

        out, rate = y - steady(0, 0), v - steady(0, 1)
        grows, decays = (
            (rate - down * out) / (up - down),
            (up * out - rate) / (up - down),
        )
        return [
            float(
                grows * up**n * mpmath.exp(up * h)
                + decays * down**n * mpmath.exp(down * h)
                + steady(h, n)
            )
            for n in range(4)
        ]


@pytest.mark.parametrize("damping", [0.0, 0.2])
@pytest.mark.parametrize("slope", [0.0, 0.03])
@pytest.mark.parametrize(
    "harmonics",
    [(), ONE, MULTIPLES, OTHERS],
    ids=["none", "one", "multiples", "others"],
)
def test_the_series_is_the_closed_form_up_to_its_longest_step(
    harmonics, slope, damping
):
    motion = Motion("m", (Piece(0.0, 12.0, harmonics, 0.1, slope),))
    segments, equation = motion.segments, OnSeries(damping)
    random, count = np.random.default_rng(3), 10
    k = random.integers(0, len(segments), count)
    u = random.uniform(0.0, 0.9, count) * segments.length[k]
    amplitude, omega = random.uniform(0.5, 3.0, count), random.uniform(0.3, 9.0, count)
    side = random.choice([-1.0, 1.0], count)
    y, v = random.uniform(0.0, 1.0, count), random.uniform(-0.5, 0.5, count)
    drive = -side * amplitude * (segments.s_start[k] + drive_change(segments, k, u))
    body = lanes(
        amplitude=amplitude,
        omega=omega,
        segment=k,
        phase=u,
        side=side,
        y=y,
        v=v,
        force=equation.force(y, drive),
    )
    arc = equation.flow(segments, body)
    left = segments.left_of_piece(k, u) / omega
    h = np.minimum(arc.longest, left) * random.uniform(0.1, 1.0, count)
    found = np.array(arc.at(h))
    for i in range(count):
        outward, phase = -side[i] * amplitude[i], segments.start[k[i]] + u[i]
        sinusoids = [
            (
                outward * one.amplitude,
                one.frequency * omega[i],
                one.frequency * phase + one.phase,
            )
            for one in harmonics
        ]
        wanted = closed_form(
            y[i],
            v[i],
            sinusoids,
            outward * (0.1 + slope * phase),
            outward * slope * omega[i],
            h[i],
            damping,
        )
        size = (1.0 + amplitude[i]) * math.exp(h[i])
        fast = 1.0 + 2.1 * omega[i]
        errors = np.abs(found[:, i] - wanted)
        assert np.all(errors[:2] < 1e-12 * size)
        assert np.all(errors[2:] < 1e-11 * size * fast ** np.arange(1, 3))

"""The exact flow against its definition in 40 digits."""

import mpmath
import numpy as np
import pytest

from rocking_cli.dynamics.equations.flow import LinearFlow


def arcs(lanes, harmonics=5, seed=3):
    """Random arcs of drives with frequencies from 1 to 4 times a slowest one, and times
    from 1e-3 to 10 over the fastest.
    """
    random = np.random.default_rng(seed)
    ratios = random.uniform(1.0, 4.0, harmonics)
    ratios /= ratios.max()
    top = 4.0 * 10.0 ** random.uniform(-1.0, 1.0, lanes)
    sin, cos = random.uniform(-1.0, 1.0, (2, harmonics, lanes))
    y = np.where(random.random(lanes) < 0.5, 0.0, random.uniform(0.0, 0.5, lanes))
    v, b = random.uniform(-0.5, 0.5, (2, lanes))
    h = 10.0 ** random.uniform(-3.0, 1.0, lanes) / (1.0 + top)
    return ratios, y, v, b, sin, cos, top, h


def exact(y, v, b, sin, cos, w, h, ramp=0.0):
    """y, v, b, j after h from the modes and the steady motion, in 40 digits."""
    with mpmath.workdps(40):
        y, v, b, h, ramp = (mpmath.mpf(float(x)) for x in (y, v, b, h, ramp))
        terms = [
            tuple(mpmath.mpf(float(x)) for x in term)
            for term in zip(sin, cos, w, strict=True)
        ]
        # y'' = y - 1 + a with a = c + r t + sum S sin + C cos and b = y - 1 + a at 0
        level = b - y - sum(c for _, c, _ in terms)  # c - 1

        def steady(t, n):
            turned = [
                (
                    s * mpmath.sin(x * t + n * mpmath.pi / 2)
                    + c * mpmath.cos(x * t + n * mpmath.pi / 2)
                )
                * x**n
                for s, c, x in terms
            ]
            line = (level + ramp * t, ramp, 0, 0)[n]
            return (
                -sum(
                    z / (1 + x * x) for z, (_, _, x) in zip(turned, terms, strict=True)
                )
                - line
            )

        up, out = y - steady(0, 0), v - steady(0, 1)
        modes = (
            up * mpmath.cosh(h) + out * mpmath.sinh(h),
            up * mpmath.sinh(h) + out * mpmath.cosh(h),
        )
        return [float(modes[n % 2] + steady(h, n)) for n in range(4)]


@pytest.mark.parametrize("ramp", [None, 0.4])
@pytest.mark.parametrize("harmonics", [1, 3])
def test_the_flow_of_few_sinusoids_is_that_of_the_definition(harmonics, ramp):
    """y and v are sums of terms that may cancel: the error is a few units in the last
    place of the largest of them.
    """
    ratios, y, v, b, sin, cos, top, h = arcs(60, harmonics)
    h = np.where(np.arange(60) % 3, h, 6.0 * h / h.max())
    w = ratios[:, None] * top
    found = np.array(
        LinearFlow(
            y, v, b, sin, cos, w, None if ramp is None else np.full(60, ramp)
        ).at(h)
    )
    wanted = np.array(
        [
            exact(*(x[..., i] for x in (y, v, b, sin, cos, w, h)), ramp or 0.0)
            for i in range(60)
        ]
    ).T
    drive = np.abs(sin).sum(axis=0) + np.abs(cos).sum(axis=0) + (ramp or 0.0)
    size_y = (
        y + np.abs(v) * np.sinh(h) + (np.abs(b) + drive) * 2.0 * np.sinh(0.5 * h) ** 2
    )
    size_v = np.abs(v) * np.cosh(h) + (np.abs(b) + drive) * np.sinh(h)
    assert np.all(np.abs(found[0] - wanted[0]) < 3e-15 * size_y)
    assert np.all(np.abs(found[1] - wanted[1]) < 3e-15 * size_v)
    assert np.all(
        np.abs(found[2:] - wanted[2:])
        < 1e-14 * (1.0 + w.max(axis=0)) * (np.cosh(h) + drive)
    )

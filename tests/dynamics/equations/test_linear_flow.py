"""The exact flow against its definition in 40 digits."""

import mpmath
import numpy as np

from rocking_cli.dynamics.equations.linear_flow import LinearFlow


def exact(y, v, b, s, c, w, h):
    """y, v, b, j after h from the modes and the steady motion, in 40 digits."""
    with mpmath.workdps(40):
        y, v, b, s, c, w, h = (mpmath.mpf(float(x)) for x in (y, v, b, s, c, w, h))

        # y'' = y + level + S sin + C cos, and y'' = b at 0
        def steady(t, n):
            angle = w * t + n * mpmath.pi / 2
            wave = (s * mpmath.sin(angle) + c * mpmath.cos(angle)) * w**n
            return -wave / (1 + w * w) - (b - y - c if n == 0 else 0)

        up, out = y - steady(0, 0), v - steady(0, 1)
        modes = (
            up * mpmath.cosh(h) + out * mpmath.sinh(h),
            up * mpmath.sinh(h) + out * mpmath.cosh(h),
        )
        return [float(modes[n % 2] + steady(h, n)) for n in range(4)]


def test_the_flow_is_that_of_the_definition():
    """y and v are sums of terms that may cancel: the error is a few units in the last
    place of the largest of them.
    """
    random = np.random.default_rng(3)
    w = 4.0 * 10.0 ** random.uniform(-1.0, 1.0, 60)
    s, c = random.uniform(-1.0, 1.0, (2, 60))
    y = np.where(random.random(60) < 0.5, 0.0, random.uniform(0.0, 0.5, 60))
    v, b = random.uniform(-0.5, 0.5, (2, 60))
    h = 10.0 ** random.uniform(-3.0, 1.0, 60) / (1.0 + w)
    h = np.where(np.arange(60) % 3, h, 6.0 * h / h.max())
    arc = LinearFlow(y, v, b, s, c, w)
    found = np.array(arc.at(h))
    wanted = np.array([exact(*x) for x in zip(y, v, b, s, c, w, h, strict=True)]).T
    drive = np.abs(s) + np.abs(c)
    cosh1, sinh = 2.0 * np.sinh(0.5 * h) ** 2, np.sinh(h)
    size_y = y + np.abs(v) * sinh + (np.abs(b) + drive) * cosh1
    size_v = np.abs(v) * np.cosh(h) + (np.abs(b) + drive) * sinh
    assert np.all(np.abs(found[0] - wanted[0]) < 3e-15 * size_y)
    assert np.all(np.abs(found[1] - wanted[1]) < 3e-15 * size_v)
    rest = 1e-14 * (1.0 + w) * (np.cosh(h) + drive)
    assert np.all(np.abs(found[2:] - wanted[2:]) < rest)
    at_ground = found[2] - found[0]  # y'' of the same drive where y = 0
    assert np.all(np.abs(arc.at_ground(h) - at_ground) < rest)

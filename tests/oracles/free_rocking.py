"""Free rocking by direct integration of theta'' = -p^2 sin(s alpha - theta), s = sgn
theta, with DOP853 and events at theta = 0. It shares no formula with the closed form.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class Motion(NamedTuple):
    """A motion from a release at rest."""

    t: np.ndarray  # [s]
    theta: np.ndarray  # [rad]
    rate: np.ndarray  # [rad/s]
    impacts: list[float]  # times [s]
    eta: list[float]  # of each impact


def free_rocking(t, alpha, p, theta0, eta, *, held=0.0, rtol=1e-11):
    """The motion at times t of a body that is held at theta0 up to `held`. alpha, p:
    numbers, or pairs (right, left); eta: function of theta/alpha before the impact.
    """
    alpha, p = (np.broadcast_to(x, 2) for x in (alpha, p))
    theta, rate = np.full(t.size, float(theta0)), np.zeros(t.size)
    now, state, impacts, etas = held, np.array([theta0, 0.0]), [], []
    peak = abs(theta0)
    while now < t[-1]:
        sign = 1.0 if state[0] > 0.0 or (state[0] == 0.0 and state[1] > 0.0) else -1.0
        i = 0 if sign > 0.0 else 1

        def slope(_, y, sign=sign, i=i):
            return y[1], -(p[i] ** 2) * math.sin(sign * alpha[i] - y[0])

        def touches(_, y, sign=sign):
            return sign * y[0]

        touches.terminal, touches.direction = True, -1
        done = solve_ivp(
            slope,
            (now, t[-1]),
            state,
            "DOP853",
            events=touches,
            dense_output=True,
            rtol=rtol,
            atol=1e-13,
        )
        inside = (t >= now) & (t <= done.t[-1])
        if inside.any():
            theta[inside], rate[inside] = done.sol(t[inside])
        if not done.t_events[0].size:
            break
        fine = done.sol(np.linspace(now, done.t[-1], 400))[0]
        peak = max(float(np.max(np.abs(fine))), abs(state[0]))
        ratio = float(eta(peak / alpha[i]))
        now = float(done.t_events[0][0])
        impacts.append(now)
        etas.append(ratio)
        # the angular speed goes on to the other edge
        speed = ratio * float(done.y_events[0][0][1])
        if abs(speed) < 1e-5 * p[i] * alpha[i]:
            rest = t > now
            theta[rest] = rate[rest] = 0.0
            break
        state = np.array([-sign * 1e-300, speed])
    return Motion(t, theta, rate, impacts, etas)

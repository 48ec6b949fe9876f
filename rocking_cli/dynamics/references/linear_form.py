"""The linear equation in closed form, for the general solver: on a piece of a motion of
sinusoids and a line, theta is the sum of two exponentials and of the steady response.
It shares nothing with the flow of the engine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from ...motions.motion import Piece
from .extrapolation import StatePoint


class LinearForm(NamedTuple):
    """The linear equation on an edge, with p the pace,

    theta'' + 2 zeta p theta' - p^2 theta = -p^2 (alpha + a_scale push s(Omega tau))
    """

    alpha: float  # critical angle [rad]
    a_scale: float  # a_scale of Eq. 3.9 [-]
    pace: float  # p of the edge over the p of tau [-]
    damping: float  # zeta [-]

    def under(
        self, piece: Piece, omega: float, push: float
    ) -> Callable[[StatePoint, float], StatePoint]:
        """Return the function of a state and a length that returns the state so much
        later under a piece; push: inward ground acceleration over s [g].
        """
        root = math.sqrt(1.0 + self.damping**2)
        grows = self.pace * (root - self.damping)  # exponents by tau
        falls = self.pace * (root + self.damping)
        steady = _steady(self, piece, omega, push)

        def after(start: StatePoint, length: float) -> StatePoint:
            time, theta, w = start
            at, rate = steady(time)
            # The rest of the state is a sum of the two exponentials.
            far, fast = theta - at, w - rate
            one = (fast + falls * far) / (grows + falls) * math.exp(grows * length)
            other = (grows * far - fast) / (grows + falls) * math.exp(-falls * length)
            at, rate = steady(time + length)
            return StatePoint(
                time + length, at + one + other, rate + grows * one - falls * other
            )

        return after


def _steady(
    form: LinearForm, piece: Piece, omega: float, push: float
) -> Callable[[float], tuple[float, float]]:
    """Return the function of tau that returns theta and theta' of the response without
    exponentials.
    """
    pull = form.a_scale * push  # of a unit of s, over p^2
    if not math.isfinite(piece.stop):  # still ground
        return lambda time: (form.alpha, 0.0)
    drag = 2.0 * form.damping * form.pace
    # of each sinusoid: frequency by tau, phase, and the amplitudes of the response in
    # phase and out of phase
    waves = []
    for h in piece.harmonics:
        nu = h.frequency * omega
        inertia = nu * nu + form.pace**2
        sine = form.pace**2 * pull * h.amplitude * inertia
        sine /= inertia**2 + (drag * nu) ** 2
        waves.append((nu, h.phase, sine, sine * drag * nu / inertia))
    slope = pull * piece.slope * omega
    level = form.alpha + pull * piece.constant + drag * slope / form.pace**2
    begin = piece.start / omega

    def steady(time: float) -> tuple[float, float]:
        theta, rate = level + slope * (time - begin), slope
        for nu, phase, a, b in waves:
            sine, cosine = math.sin(nu * time + phase), math.cos(nu * time + phase)
            theta += a * sine + b * cosine
            rate += nu * (a * cosine - b * sine)
        return theta, rate

    return steady

"""The nonlinear equations by a second, slower path, for checking: SciPy's DOP853 on the equation as the paper writes it.

It shares no series, table, window or energy argument with the engine. The state is (theta, w), w = sqrt(M) theta', which takes
the velocity term out of Eq. 3.4; for a rigid body M = 1. Strides are half a radian of the fastest motion, in five steps or
more; impacts and crests are events.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from scipy.integrate import solve_ivp

from ...motions.motion import Motion, Piece
from ...structures.kinematics import Mechanism, linearise
from ..outcome import Outcome
from .uplift import next_uplift

_MAX_STRIDES, _A_SEGMENT = 5_000, 50  # strides of a cell, and these for each segment of the motion
_SCRIPT_STRIDE = 10.0  # tau between two looks at whether a body is lost, where steps are the solver's own
_AT_REST = 1e-11


class Equation(Protocol):
    """An equation of motion: alpha, uplift lambda, the ground acceleration of A = 1 (over g), and the rates by tau."""

    alpha: float
    uplift: float
    scale: float

    def rates(self, theta: float, w: float, push: float) -> list[float]:
        """(theta', w') under the inward ground acceleration push [g]."""


class RigidBody:
    """Eq. 2.3."""

    def __init__(self, alpha: float) -> None:
        self.alpha, self.uplift, self.scale = alpha, math.tan(alpha), alpha

    def rates(self, theta: float, w: float, push: float) -> list[float]:
        """-sin(alpha - theta) - push cos(alpha - theta)."""
        z = self.alpha - theta
        return [w, -math.sin(z) - push * math.cos(z)]


class Linkage:
    """Eq. 3.4, from the mechanism's own coefficients."""

    def __init__(self, mechanism: Mechanism) -> None:
        form = linearise(mechanism)
        self.mechanism, self.stiffness = mechanism, form.stiffness
        self.alpha, self.uplift, self.scale = form.alpha, form.uplift, form.uplift

    def rates(self, theta: float, w: float, push: float) -> list[float]:
        """w/sqrt(M) and -(L + push B)/sqrt(M), over p^2/g."""
        c = self.mechanism.coefficients(theta)
        root = math.sqrt(c.inertia)
        return [w / root, -float(c.lift + push * c.push) / root / self.stiffness]


class Oscillator:
    """Eq. 2.4 over alpha, for general solvers; the engine's own reference for it is `reference`."""

    alpha = uplift = scale = 1.0

    def rates(self, theta: float, w: float, push: float) -> list[float]:
        """theta - 1 - push."""
        return [w, theta - 1.0 - push]


@dataclass(frozen=True)
class Solver:
    """A method of SciPy's `solve_ivp`; small steps and events met by integrating anew to them, or as a script would call it."""

    method: str = "DOP853"
    tolerance: float = 1e-13
    careful: bool = True

    def __call__(self, rate: Any, span: tuple[float, float], state: list[float], **options: Any) -> Any:
        absolute = 1e-2 * self.tolerance if self.careful else self.tolerance
        return solve_ivp(rate, span, state, method=self.method, rtol=max(self.tolerance, 2.3e-14), atol=absolute, **options)


CAREFUL = Solver()


class _Ground:
    """Event: the body comes down on the ground, where the integration stops."""

    terminal, direction = True, -1

    def __call__(self, t: float, state: np.ndarray) -> float:
        return float(state[0])


class _Crest:
    """Event: the body turns back."""

    terminal, direction = False, -1

    def __call__(self, t: float, state: np.ndarray) -> float:
        return float(state[1])


def reference_nonlinear(
    motion: Motion, amplitude: float, omega: float, eta: float, equation: Equation, solver: Solver = CAREFUL
) -> tuple[Outcome, float]:
    """(outcome, max |theta|/alpha, NaN where overturned) of one cell; FAILED if it takes too long."""
    body = _Body(equation, amplitude, omega, eta, solver)
    most_strides = _MAX_STRIDES + _A_SEGMENT * len(motion.segments)
    for piece in motion.pieces:
        end = piece.stop / omega
        while end - body.time > 1e-14 * end:
            body.strides += 1
            if body.strides > most_strides:
                return Outcome.FAILED, math.nan
            if body.side == 0:
                body.wait(piece, end)
            else:
                body.move(piece, end)
            if body.theta > 0.5 * math.pi or (body.theta > equation.alpha and body.lost(motion, piece)):
                return body.overturned(), math.nan
    return body.still()


class _Body:
    def __init__(self, equation: Equation, amplitude: float, omega: float, eta: float, solver: Solver) -> None:
        self.solver = solver
        self.equation, self.drive, self.omega, self.eta = equation, amplitude * equation.scale, omega, eta
        self.time = self.theta = self.w = self.peak = 0.0
        self.side = self.strides = 0
        self.bounced = False

    def stride(self, piece: Piece) -> float:
        return 0.5 / (1.0 + self.omega * max((h.frequency for h in piece.harmonics), default=1.0))

    def excess(self, piece: Piece, time: float) -> float:
        return self.drive * abs(float(piece.value(self.omega * time))) - self.equation.uplift

    def wait(self, piece: Piece, end: float) -> None:
        """At rest: on to the first instant of uplift, or to the end of the piece."""
        lift = next_uplift(piece, self.omega * self.time, self.drive / self.equation.uplift)
        self.time = end if lift is None else max(self.time, lift[0] / self.omega)
        self.side, self.theta, self.w = 0 if lift is None else lift[1], 0.0, 0.0

    def move(self, piece: Piece, end: float) -> None:
        """One stride, or on to the impact in it."""
        time, careful = self.time, self.solver.careful
        stop = min(end, time + (self.stride(piece) if careful else _SCRIPT_STRIDE))

        def rate(t: float, state: np.ndarray) -> list[float]:
            push = self.side * self.drive * float(piece.value(self.omega * t))
            return self.equation.rates(float(state[0]), float(state[1]), push)

        def at(t: float) -> np.ndarray:
            return np.asarray(self.solver(rate, (time, t), [self.theta, self.w], first_step=t - time).y[:, -1])

        limit = {"max_step": (stop - time) / 5} if careful else {}
        path = self.solver(rate, (time, stop), [self.theta, self.w], events=(_Ground(), _Crest()), **limit)
        for i in np.flatnonzero(path.t_events[1] > time):
            t = path.t_events[1][i]
            there = at(t) if careful else path.y_events[1][i]
            speed, force = rate(t, there)
            self.peak = max(self.peak, float(there[0] - 0.5 * speed * there[1] / force))
        if path.status == 0:
            self.time, (self.theta, self.w) = stop, (float(x) for x in path.y[:, -1])
            return
        t = max(float(path.t_events[0][0]), np.nextafter(time, math.inf))
        there = at(t) if careful else path.y_events[0][0]
        speed, force = rate(t, there)
        miss = -float(there[0]) / speed if speed < 0.0 else 0.0
        self.time, self.side, self.bounced = t + miss, -self.side, True
        self.theta, self.w = 0.0, -self.eta * (float(there[1]) + miss * force)
        if self.w <= 0.0 or (self.w < _AT_REST and self.excess(piece, self.time) < 0.0 and self.eta < 1.0):
            self.side, self.w = 0, 0.0

    def lost(self, motion: Motion, piece: Piece) -> bool:
        """Moving outwards where no ground acceleration of this motion pushes inwards."""
        theta, w = self.theta, self.w
        return w > 0.0 and self.equation.rates(theta, w, self.drive * motion.peak)[1] > 0.0

    def overturned(self) -> Outcome:
        return Outcome.OVERTURNED_AFTER_IMPACT if self.bounced else Outcome.OVERTURNED_NO_IMPACT

    def still(self) -> tuple[Outcome, float]:
        """After the shaking: on over still ground, until the fate shows."""
        ground, impacts = Piece(0.0, math.inf), 0
        for _ in range(_MAX_STRIDES):
            if self.side == 0 or impacts > 1:
                return (Outcome.ROCKED if self.peak > 0.0 else Outcome.NO_UPLIFT), self.peak / self.equation.alpha
            if self.theta > self.equation.alpha and self.w >= 0.0:
                return self.overturned(), math.nan
            side = self.side
            self.move(ground, math.inf)
            impacts += self.side != side
        return Outcome.FAILED, math.nan

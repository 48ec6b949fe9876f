"""SciPy's `solve_ivp` with events, as a script would call it: what `rocking accuracy` compares with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from .extrapolation import Path, Point, Rate


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


class _Fallen:
    """Event: the body is beyond its limit; what a strong motion does with it from there on takes many steps and tells nothing."""

    terminal, direction = True, 1

    def __init__(self, limit: float) -> None:
        self.limit = limit

    def __call__(self, t: float, state: np.ndarray) -> float:
        return float(state[0]) - self.limit


@dataclass(frozen=True)
class Script:
    """A method of `solve_ivp` at a tolerance."""

    method: str
    tolerance: float

    def __call__(self, rate: Rate, start: Point, stop: float, limit: float) -> Path:
        """As `extrapolation.path`."""

        def rates(t: float, state: np.ndarray) -> tuple[float, float]:
            return rate(t, float(state[0]), float(state[1]))

        events = (_Ground(), _Crest(), _Fallen(limit))
        tolerance = max(self.tolerance, 2.3e-14)
        found = solve_ivp(rates, (start.time, stop), start[1:], method=self.method, rtol=tolerance, atol=self.tolerance, events=events)
        at = [[Point(float(t), *map(float, y)) for t, y in zip(*x, strict=True)] for x in zip(found.t_events, found.y_events, strict=True)]
        crests = [point for point in at[1] if point.time > start.time]
        steps = [Point(float(t), *map(float, y)) for t, y in zip(found.t, found.y.T, strict=True)]
        return Path(crests, at[0][0] if at[0] else steps[-1], bool(at[0]), steps)

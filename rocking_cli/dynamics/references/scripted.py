"""SciPy's `solve_ivp` with events, as a script would call it: `rocking accuracy` compares the engine with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from .extrapolation import Path, Point, Rate

State = np.ndarray


def _event(value: Callable[[State], float], direction: int, terminal: bool) -> Callable[[float, State], float]:
    def event(t: float, state: State) -> float:
        return float(value(state))

    event.__dict__.update(direction=direction, terminal=terminal)
    return event


@dataclass(frozen=True)
class Script:
    """A method of `solve_ivp` at a tolerance."""

    method: str
    tolerance: float

    def __call__(self, rate: Rate, start: Point, stop: float, limit: float) -> Path:
        """As `extrapolation.path`."""
        events = (  # an impact, a peak, and a body beyond its limit, where a strong motion asks for many steps
            _event(lambda state: state[0], -1, True),
            _event(lambda state: state[1], -1, False),
            _event(lambda state: state[0] - limit, 1, True),
        )
        found = solve_ivp(
            lambda t, state: rate(t, float(state[0]), float(state[1])), (start.time, stop), start[1:],
            method=self.method, rtol=max(self.tolerance, 2.3e-14), atol=self.tolerance, events=events,
        )  # fmt: skip
        impacts, peaks, _ = ([Point(float(t), *map(float, y)) for t, y in zip(*x, strict=True)]
                             for x in zip(found.t_events, found.y_events, strict=True))  # fmt: skip
        steps = [Point(float(t), *map(float, y)) for t, y in zip(found.t, found.y.T, strict=True)]
        return Path([p for p in peaks if p.time > start.time], impacts[0] if impacts else steps[-1], bool(impacts), steps)

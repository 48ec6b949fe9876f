"""SciPy's `solve_ivp` with events, as a script would call it: `rocking accuracy` compares the engine with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scipy.integrate import solve_ivp

from .extrapolation import Path, Point, Rate


@dataclass(frozen=True)
class Script:
    """A method of `solve_ivp` at a tolerance."""

    method: str
    tolerance: float

    def __call__(self, rate: Rate, start: Point, stop: float, limit: float) -> Path:
        """See `extrapolation.path`."""
        events: tuple[Any, ...] = (lambda t, state: state[0], lambda t, state: state[1], lambda t, state: state[0] - limit)
        for event, direction, terminal in zip(events, (-1, -1, 1), (True, False, True), strict=True):  # impact, peak, fallen
            event.direction, event.terminal = direction, terminal
        found = solve_ivp(
            lambda t, state: rate(t, float(state[0]), float(state[1])), (start.time, stop), start[1:],
            method=self.method, rtol=max(self.tolerance, 2.3e-14), atol=self.tolerance, events=events,
        )  # fmt: skip
        impacts, peaks, _ = ([Point(float(t), *map(float, y)) for t, y in zip(*x, strict=True)]
                             for x in zip(found.t_events, found.y_events, strict=True))  # fmt: skip
        steps = [Point(float(t), *map(float, y)) for t, y in zip(found.t, found.y.T, strict=True)]
        return Path([p for p in peaks if p.time > start.time], impacts[0] if impacts else steps[-1], bool(impacts), steps)

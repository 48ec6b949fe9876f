"""SciPy's solvers as a user's script would call them."""

from dataclasses import dataclass
from typing import Any

from .extrapolation import EdgeMotion, Path, StatePoint


@dataclass(frozen=True)
class Script:
    """SciPy's `solve_ivp` with events, as a user's script would call it. `rocking
    accuracy` compares the engine with it.
    """

    method: str  # name of the method of `solve_ivp`
    tolerance: float  # tolerance that `solve_ivp` is given

    def __call__(
        self, flow: EdgeMotion, start: StatePoint, stop: float, limit: float
    ) -> Path:
        """Return the same as `path`."""
        from scipy.integrate import solve_ivp

        events: tuple[Any, ...] = (
            lambda t, state: state[0],
            lambda t, state: state[1],
            lambda t, state: state[0] - limit,
        )
        # The three events in order: impact, peak, end of the body's range. Only a peak
        # does not stop the integration.
        for event, direction, terminal in zip(
            events, (-1, -1, 1), (True, False, True), strict=True
        ):
            event.direction, event.terminal = direction, terminal
        found = solve_ivp(
            lambda t, state: flow.rate(t, float(state[0]), float(state[1])),
            (start.time, stop),
            start[1:],
            method=self.method,
            rtol=max(self.tolerance, 2.3e-14),
            atol=self.tolerance,
            events=events,
        )
        impacts, peaks, _ = (
            [StatePoint(float(t), *map(float, y)) for t, y in zip(*x, strict=True)]
            for x in zip(found.t_events, found.y_events, strict=True)
        )
        steps = [
            StatePoint(float(t), *map(float, y))
            for t, y in zip(found.t, found.y.T, strict=True)
        ]
        return Path(
            [p for p in peaks if p.time > start.time],
            impacts[0] if impacts else steps[-1],
            bool(impacts),
            steps,
        )

"""The response of one body in time: every arc as a series, and the events.

`history` records the march of one body on floats. Only the last, invisible part of a
sequence of impacts is summed; all else is followed in time. After the motion the ground
is at rest.
"""

import math
from collections.abc import Sequence

import numpy as np

from ..dynamics.batch import MAX_STEPS
from ..dynamics.one.lane import Lane
from ..dynamics.one.march import march
from ..dynamics.one.state import Ended, Listener
from ..dynamics.outcome import FALLEN, LOST, Outcome
from ..dynamics.system import System
from ..errors import ArgumentError
from ..motions.given import AnyMotion, motion_from
from ..motions.motion import Motion, Piece
from ..motions.segments import Segments
from .arcs import INVISIBLE, Event, History, HistoryArcs, Writer

LONGEST = 1e9  # tau: beyond, doubles do not tell the times of an arc apart


def history(
    system: System,
    motion: AnyMotion,
    amplitude: float,
    omega: float,
    eta: float | None = None,
    *,
    release: float = 0.0,
    duration: float,
) -> History:
    """Return the response in time of one body, in dimensionless form (Eqs. 2.3, 2.4,
    3.4).

    The body begins at rest, or released at theta/alpha = release to its right side. The
    history goes up to tau = p t = duration or to the end of the shaking, whichever is
    later. `time_history` does the same for a structure in SI units.

    Parameters
    ----------
    system
        the equation of motion on its contact, such as `Method().system_of(structure)`
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    amplitude
        A = a_scale a_g / (alpha g) [-], finite, not negative; 0 is free rocking
    omega
        Omega = omega_g / p [-], finite, positive
    eta
        restitution [-] in place of that of the system
    release
        theta/alpha at the start [-], from 0 to below 1
    duration
        tau = p t up to which the history goes [-], positive

    Returns
    -------
    History
        arcs and events, and the outcome of the whole motion

    Raises
    ------
    ArgumentError
        for a number out of range, or if neither `eta` nor the system has a restitution

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> system = Method().system_of(column)
    >>> found = history(system, sine(), 2.0, 6.0, duration=40.0)
    >>> [event.event for event in found.events][:3]
    ['uplift', 'peak', 'impact']
    """
    motion = motion_from(motion)
    system = system if eta is None else system.with_restitution(eta)
    numbers = {
        "amplitude": amplitude,
        "omega": omega,
        "release": release,
        "duration": duration,
    }
    for name, x in numbers.items():
        if not (math.isfinite(x) and x >= 0.0):
            raise ArgumentError(
                f"{name}: found {x:g}; expected a finite number that is not negative"
            )
    if not (omega > 0.0 and duration > 0.0 and release < 1.0):
        raise ArgumentError("omega and duration must be positive and release below 1")
    if motion.duration / omega > LONGEST:
        raise ArgumentError(
            f"omega: found {omega:g}; expected a larger one, so that the shaking ends"
            f" before tau = {LONGEST:g}"
        )
    duration = max(motion.duration / omega, duration)
    segments = system.segments(motion.coarsest.still_until(1.001 * duration * omega))
    kind: type[MarchWriter] = MarchWriter
    if system.devices is not None:
        from .tied_history import TiedWriter

        kind = TiedWriter
    return kind(system, segments, omega).record(amplitude, release, duration)


class MarchWriter(Writer, Listener):
    """Writes down the march of one body on floats."""

    visible = INVISIBLE

    def __init__(self, system: System, segments: Segments, omega: float) -> None:
        super().__init__(system.equation, omega)
        self.lane = Lane(system, segments, omega)
        self.fallen = self._fallen(1.0), self._fallen(-1.0)

    def _fallen(self, side: float) -> float:
        """Return the y at which a body counts as fallen: theta/alpha = `FALLEN`, or the
        rotation at which it lies on the ground.
        """
        equation = self.equation.on(np.array([side]))
        return min(
            self.lane.edge_of(side).limit,
            float(equation.displacement(np.array([FALLEN]))[0]),
        )

    def record(self, amplitude: float, release: float, duration: float) -> History:
        with np.errstate(all="ignore"):
            ended = march(
                self.lane,
                amplitude,
                listener=self,
                release=release,
                most=MAX_STEPS + 40 * len(self.lane.segments),
            )
            return self._history(ended, duration)

    def _history(self, ended: Ended, duration: float) -> History:
        """Return the history of a march that has ended so."""
        arcs = self.arcs()
        if ended.outcome.overturned:
            self._overturn(arcs)
        if ended.outcome == Outcome.LOST_CONTACT and ended.lost is not None:
            self._lose(arcs, ended.lost)
        return self.history(
            arcs, duration, self._became(ended.outcome), ended.theta_ratio
        )

    def _became(self, outcome: Outcome) -> Outcome:
        words = [e.event for e in self.events]
        if outcome.overturned and "overturning" in words:
            return (
                Outcome.OVERTURNED_AFTER_IMPACT
                if "impact" in words
                else Outcome.OVERTURNED_NO_IMPACT
            )
        if outcome in (Outcome.ROCKED, Outcome.NO_UPLIFT):
            return Outcome.ROCKED if words else Outcome.NO_UPLIFT
        return outcome

    def keep(
        self,
        start: float,
        reach: float,
        side: float,
        pace: float,
        h: float,
        terms: Sequence[float],
    ) -> None:
        self.add_arc(start, reach, side, pace, h, terms)

    def note(
        self, tau: float, event: str, side: float, y: float, v: float, device: str = ""
    ) -> None:
        pace = self.omega / self.lane.edge_of(side).omega
        self.add_event(tau, event, side, y, v, pace, device)

    def _overturn(self, arcs: HistoryArcs) -> None:
        """Note the overturning at the last time at which the body passes y of
        `_fallen`, which may be many arcs before the march is certain of the fall.
        """
        i = arcs.start.size - 1
        fallen = self._fallen(float(arcs.side[i]))
        while i and arcs.flow.terms[0, i] >= fallen:
            i -= 1
        start = float(arcs.start[i])
        length = float(arcs.stop[i] - arcs.start[i])
        arc = np.array([i])
        share = np.linspace(0.0, 1.0, 65)  # beyond it, and perhaps back within this arc
        beyond = np.flatnonzero(
            arcs.flow.take(np.full(65, i)).at(share * (length * arcs.pace[i])).y
            >= fallen
        )
        low = start
        high = start + float(share[beyond[0]] if beyond.size else 1.0) * length
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (
                (low, middle)
                if arcs.points(arc, np.array([middle])).y[0] >= fallen
                else (middle, high)
            )
        point = arcs.points(arc, np.array([high]))
        if float(point.y[0]) >= fallen * (1.0 - 1e-9):
            self.events = [e for e in self.events if e.tau <= high]
            self.note(
                high,
                "overturning",
                float(arcs.side[i]),
                float(point.y[0]),
                float(point.v[0]),
            )

    def _lose(self, arcs: HistoryArcs, tau: float) -> None:
        """Note the loss of contact at tau, when the ground begins to fall as fast as
        the body.
        """
        self.events = [e for e in self.events if e.tau <= tau]
        found = History(self.equation, arcs, (), tau, Outcome.LOST_CONTACT, math.nan)
        ratio, rate = (float(x[0]) for x in found.at(np.array([tau])))
        self.events.append(
            Event(
                tau, LOST, ratio, rate, float(arcs.side[-1]) if arcs.side.size else 1.0
            )
        )


def quarter_period(system: System, release: float) -> float:
    """Return the time tau [-] from the release at theta/alpha = release to the first
    impact, on still ground. Raises ArgumentError.
    """
    reach = 4.0 * math.acosh(1.0 / (1.0 - release)) + 10.0
    free = history(
        system,
        Motion("still", (Piece(0.0, reach),)),
        0.0,
        1.0,
        0.0,
        release=release,
        duration=reach,
    )
    return next((e.tau for e in free.events if e.event == "impact"), math.inf)

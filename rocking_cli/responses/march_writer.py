"""The writer of the march of one body on floats: its events, its fall and its loss of
contact.
"""

import math
from dataclasses import replace

import numpy as np

from ..dynamics.one.lane import Lane
from ..dynamics.one.march import march
from ..dynamics.one.state import Ended, Listener
from ..dynamics.outcome import FALLEN, LOST, Outcome
from ..dynamics.system import System
from ..motions.motion import Motion
from .arcs import INVISIBLE, Event, History, HistoryArcs, Writer


class MarchWriter(Writer, Listener):
    """Writes down the march of one body on floats."""

    visible = INVISIBLE
    # True if the history of a body that loses contact ends there
    ends_at_loss = False

    def __init__(self, system: System, motion: Motion, omega: float) -> None:
        super().__init__(system.equation, omega)
        self.lane = Lane(system, motion, omega)
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
            )
            return self._history(ended, duration)

    def _history(self, ended: Ended, duration: float) -> History:
        """Return the history of a march that has ended so."""
        arcs, loses = self.arcs(), ended.outcome == Outcome.LOST_CONTACT
        lost = min((e.tau for e in self.events if e.event == LOST), default=ended.lost)
        # A body that overturns has overturned whatever its Fz.
        if not (loses and self.ends_at_loss):
            self.events = [e for e in self.events if e.event != LOST]
        if ended.outcome.overturned:
            self._overturn(arcs)
        if loses and ended.lost is not None:
            self._lose(arcs, ended.lost)
        found = self.history(
            arcs, duration, self._became(ended.outcome), ended.theta_ratio
        )
        return replace(found, lost=lost)

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

    def note(
        self, tau: float, event: str, side: float, y: float, v: float, device: str = ""
    ) -> None:
        pace = self.omega / self.lane.edge_of(side).omega
        self.add_event(tau, event, side, y, v, pace, device)

    def _overturn(self, arcs: HistoryArcs, held: float = 0.0) -> None:
        """Note the overturning at the last time at which the body passes y of
        `_fallen`, which may be many arcs before the march is certain of the fall; held:
        time [tau] up to which restraints may hold a body beyond this y.
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
        if high < held:
            high, i = held, int(np.searchsorted(arcs.start, held, side="right")) - 1
            arc = np.array([i])
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

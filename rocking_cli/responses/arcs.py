"""The record of a response in time, every arc as a series and the events, and the class
that writes it down during a march.
"""

import math
from array import array
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.equations.equation import Equation
from ..dynamics.equations.taylor import Instant, TaylorSeries
from ..dynamics.outcome import LOST, Outcome
from ..motions.blocks import blocks
from ..showing import Shown

if TYPE_CHECKING:
    from ..dynamics.one.state import MarchedArc
    from ..dynamics.tied.devices import Devices


INVISIBLE = 1e-4  # speed of a bounce, y' by tau: its height is below 1e-8
_KNOWN = (Outcome.ROCKED, Outcome.LEANING)  # outcomes with a largest rotation
LATE = 1.0 + 1e-14  # of a time: what still belongs to the arc that ends there


class HistoryArcs(NamedTuple):
    """All arcs in the order of time. An arc is the motion on one side between two times
    tau, given by one series.
    """

    start: Array  # [tau], (arcs,)
    stop: Array  # [tau], (arcs,)
    side: Array  # +1 on the right edge, -1 on the left, (arcs,)
    flow: TaylorSeries  # the series of each arc, one lane an arc
    pace: Array  # tau of the side over tau of the history [-], (arcs,)

    def at(self, tau: Array) -> tuple[Array, Array]:
        """Return (the indices of the times that lie on an arc, the index of the arc of
        each).
        """
        arc = np.searchsorted(self.start, tau * LATE, side="right") - 1
        inside = (
            np.flatnonzero((arc >= 0) & (tau <= self.stop.take(arc) * LATE))
            if self.start.size
            else np.zeros(0, dtype=np.int64)
        )
        return inside, arc[inside]

    def points(self, arc: Array, tau: Array) -> Instant:
        """Return y and its derivatives at times tau; arc: the index of the arc of each
        time.
        """
        return self.flow.take(arc).at((tau - self.start[arc]) * self.pace[arc])


class Event(NamedTuple):
    """An event at a time tau = p t, p of the edge that lifts first."""

    tau: float  # its time [-]
    # release, uplift, impact, peak, rest, overturning, lost contact, or of a device
    event: str
    theta_ratio: float  # theta/alpha, alpha of the side on which the body is [-]
    rate: float  # of theta/alpha by tau, before an impact [-]
    side: float  # +1 or -1
    device: str = ""  # the tie or tendon, "" without one


class Resultant(NamedTuple):
    """The resultant of ties and a tendon on a body over m g."""

    inward: Any  # against the side on which the body is, at rest against +x [-]
    down: Any  # [-]


FREE = Resultant(0.0, 0.0)  # nothing pulls


class DeviceForces(NamedTuple):
    """The forces of ties and the tendon over time, fixed + rate e from each start on.
    At rest a tie of both sides has the larger of its two forces.
    """

    devices: "Devices"  # the ties and the tendon
    start: Array  # times [tau], (times,)
    row: Array  # index of the side, as in `Devices`, (times,)
    fixed: Array  # [N], (devices, times)
    rate: Array  # [N/m], (devices, times)
    # forces with which the devices hold the body at the ground against each side [N],
    # (sides, devices, times)
    held: Array

    def pull(self, tau: Array, y: Array) -> Resultant:
        """Return what pulls at displacements y of moving bodies, by the laws at times
        tau, both (n,).
        """
        at = np.searchsorted(self.start, tau, side="right") - 1
        row, devices = self.row[at], self.devices
        force = self.fixed[:, at] + self.rate[:, at] * devices.elongation(row, y)
        half = 0.5 * devices.unit[row, 0] * y
        tendon = devices.tendon[:, None]
        across = np.where(tendon, np.sin(half), 1.0) * force
        down = np.where(tendon, np.cos(half), 0.0) * force
        return Resultant(*(x.sum(axis=0) / devices.weight for x in (across, down)))

    def at_ground(self, tau: Array, side: float | None = None) -> Resultant:
        """Return what pulls at times tau on a body that has just left the ground onto a
        side, None: on one that rests, which the ties of either side pull.
        """
        row, held = self._row(side), self._held(tau)
        across = np.where(self.devices.tendon[:, None], 0.0, held).sum(axis=1)
        inward = across[row]
        if side is None and len(across) > 1:
            inward = across[0] - across[1]
        down = held[row, self.devices.tendon].sum(axis=0)
        return Resultant(inward / self.devices.weight, down / self.devices.weight)

    def holds(self, tau: Array, side: float) -> Array:
        """Return the restoring acceleration -y'' that the devices add at times tau to a
        body that has just left the ground onto a side.
        """
        row = self._row(side)
        moment = self._held(tau)[row] * self.devices.height[row, :, None]
        return np.asarray(moment.sum(axis=0) / self.devices.moment[row, 0])

    def _row(self, side: float | None) -> int:
        return int(self.devices.row(np.array([side or 1.0]))[0])

    def _held(self, tau: Array) -> Array:
        at = np.searchsorted(self.start, tau * LATE, side="right") - 1
        return self.held[:, :, np.maximum(at, 0)]

    def columns(self, tau: Array, theta: Array) -> dict[str, Array]:
        """Return the force [N] of each device at times tau, with rotations theta [rad]
        of either sign, as tie_1_force, tendon_force.
        """
        at = np.searchsorted(self.start, tau, side="right") - 1
        row = self.row[at]
        elongation = self.devices.elongation(
            row, np.abs(theta) / self.devices.unit[row, 0]
        )
        force = np.maximum(self.fixed[:, at] + self.rate[:, at] * elongation, 0.0)
        return {
            f"{name.replace(' ', '_')}_force": of
            for name, of in zip(self.devices.names, force, strict=True)
        }


@dataclass(frozen=True, repr=False)
class History(Shown):
    """A response in time, as `history` returns it.

    `at` evaluates rotation and speed at any time, `events` lists uplifts, impacts,
    peaks and overturning, `peak` is the largest of them. `TimeHistory` holds one for
    each equation and gives rows in SI units.

    Attributes
    ----------
    arcs: in the order of time
    events: in the order of time
    end: the time at which arcs and events end [tau]
    outcome: of the whole motion, which may last longer than the arcs
    highest: largest |theta|/alpha of the whole motion, NaN if the body overturned [-]
    devices: a row for each tie and tendon
    device_forces: forces of the ties and the tendon over time
    lost: first time at which Fz = 0, also in a fall [tau], None without one up to the
        end

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> system = Method("nonlinear").system_of(column)
    >>> found = history(system, sine(), 2.0, 6.0, duration=10.0)
    >>> ratio, rate = found.at(found.peak.tau)
    >>> f"{float(ratio):.5f}", f"{float(found.theta_ratio):.5f}", found.outcome.flag
    ('0.30973', '0.30973', 'rocked')
    """

    equation: Equation  # the equation of motion
    arcs: HistoryArcs  # in the order of time
    events: tuple[Event, ...]  # in the order of time
    end: float  # the time at which arcs and events end [tau]
    outcome: Outcome  # of the whole motion, which may last longer than the arcs
    # largest |theta|/alpha of the whole motion, NaN if the body overturned [-]
    highest: float
    devices: tuple[dict[str, Any], ...] = ()  # a row for each tie and tendon
    # forces of the ties and the tendon over time
    device_forces: DeviceForces | None = None
    # first time at which Fz = 0 [tau], None without one up to the end
    lost: float | None = None

    def _shown(self) -> dict[str, Any]:
        return {
            "outcome": self.outcome.flag,
            "theta_ratio": None if math.isnan(self.highest) else self.highest,
            "end [tau]": self.end,
            "arcs": int(self.arcs.side.size),
            "events": len(self.events),
        }

    def _rows(self) -> list[dict[str, Any]]:
        return [event._asdict() for event in self.events]

    def at(self, tau: Array) -> tuple[Array, Array]:
        """Return the rotation and its rate at some times.

        Parameters
        ----------
        tau
            times p t [-], of any shape

        Returns
        -------
        tuple of two arrays
            theta/alpha [-] and its derivative by tau [-], in the shape of `tau`; zero
            at rest, NaN after the end
        """
        tau = np.asarray(tau, dtype=float)
        ratio, rate = np.zeros(tau.size), np.zeros(tau.size)
        for part in blocks(tau.size):
            here = tau.ravel()[part]
            inside, arc = self.arcs.at(here)
            if inside.size:
                side, pace = self.arcs.side[arc], self.arcs.pace[arc]
                point = self.arcs.points(arc, here[inside])
                equation = self.equation.on(side)
                ratio[part][inside] = side * equation.rotation(point.y)
                rate[part][inside] = (
                    side * equation.rotation_rate(point.y, point.v) * pace
                )
        over = tau.ravel() > self.end
        ratio[over] = rate[over] = np.nan
        # Adding 0.0 turns -0.0 into 0.0.
        return (ratio + 0.0).reshape(tau.shape), (rate + 0.0).reshape(tau.shape)

    def sides(self, tau: Array) -> Array:
        """Return the side on which the body is at some times.

        Parameters
        ----------
        tau
            times p t [-], of any shape

        Returns
        -------
        array
            +1 on the right edge (theta > 0) and at rest, -1 on the left, in the shape
            of `tau`
        """
        side: Array = np.ones(np.size(tau))
        inside, arc = self.arcs.at(np.ravel(tau))
        side[inside] = self.arcs.side[arc]
        return side.reshape(np.shape(tau))

    def steps(self) -> Array:
        """Return the times tau of the ends of all arcs and of the events."""
        return np.unique(
            np.concatenate(
                [
                    [0.0, self.end],
                    self.arcs.start,
                    self.arcs.stop,
                    [e.tau for e in self.events],
                ]
            )
        )

    @property
    def theta_ratio(self) -> float | None:
        """max |theta|/alpha [-]: 0 if the body never lifted, None if it overturned,
        lost contact or has no outcome.
        """
        if self.outcome == Outcome.NO_UPLIFT:
            return 0.0
        if self.outcome not in _KNOWN:
            return None
        return (
            self.highest
            if self.peak is None
            else max(self.highest, abs(self.peak.theta_ratio))
        )

    @cached_property
    def peak(self) -> Event | None:
        """The event of the largest |theta|/alpha up to the end; None if the body never
        lifted, or overturned.
        """
        if self.outcome not in _KNOWN:
            return None
        found = [e for e in self.events if e.event in ("peak", "release")]
        return max(found, key=lambda e: abs(e.theta_ratio)) if found else None


class Writer:
    """Writes down the arcs and events of one body; times are tau of the history, which
    is the phase over omega.
    """

    def __init__(self, equation: Equation, omega: float) -> None:
        self.equation, self.omega = equation, omega
        self.numbers, self.terms, self.lengths = array("d"), array("d"), array("l")
        self.events = list[Event]()

    def keep(self, arc: "MarchedArc") -> None:
        """Add an arc."""
        self.numbers.extend(arc[:5])
        self.terms.extend(arc.terms)
        self.lengths.append(len(arc.terms))

    def add_event(
        self,
        tau: float,
        event: str,
        side: float,
        y: float,
        v: float,
        pace: float,
        device: str = "",
    ) -> None:
        """Add an event at y and y', both in the unit of the side."""
        # Events stay in order even where rounding moves the last digit.
        tau = max(tau, self.events[-1].tau if self.events else 0.0)
        equation = self.equation.on(np.array([side]))
        rotation = equation.rotation(np.array([y]))
        rate = equation.rotation_rate(np.array([y]), np.array([v]))
        # Adding 0.0 turns -0.0 into 0.0.
        numbers = (
            float(side * rotation[0]) + 0.0,
            float(side * rate[0]) * pace + 0.0,
        )
        self.events.append(Event(tau, event, *numbers, float(side), device))

    def arcs(self) -> HistoryArcs:
        """Return the arcs; each series gets as many terms as the longest one."""
        start, reach, side, pace, unit = np.array(self.numbers).reshape(-1, 5).T
        lengths = np.array(self.lengths, dtype=np.int64)
        most = max(self.lengths, default=5)
        terms = np.zeros((start.size, most))
        terms[np.arange(most) < lengths[:, None]] = self.terms
        flow = TaylorSeries(
            np.ascontiguousarray(terms.T),
            unit,
            unit,
            float(self.equation.damping),
        )
        return HistoryArcs(start, start + reach / pace, side, flow, pace)

    def history(
        self, arcs: HistoryArcs, duration: float, outcome: Outcome, highest: float
    ) -> History:
        """Return the history up to tau = duration, or to the overturning or the loss of
        contact.
        """
        end = min(
            [
                duration,
                *(e.tau for e in self.events if e.event in ("overturning", LOST)),
            ]
        )
        events = tuple(e for e in self.events if e.tau <= end)
        kept = int(np.searchsorted(arcs.start, end, side="right"))
        flow = arcs.flow.take(np.arange(kept))
        arcs = HistoryArcs(
            arcs.start[:kept],
            np.minimum(arcs.stop[:kept], end),
            arcs.side[:kept],
            flow,
            arcs.pace[:kept],
        )
        return History(self.equation, arcs, events, end, outcome, highest)

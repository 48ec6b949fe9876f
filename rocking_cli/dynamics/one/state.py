"""The state of one body on floats and its end: overturning, free fall, still ground."""

import math
from collections.abc import Sequence
from functools import cached_property
from operator import mul
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...arrays import Array
from ..batch import FreeFall, cannot_return
from ..body import relief
from ..condition import ErrorMoments, along, slope_between
from ..contacts.sequences import STILL
from ..equations.taylor import WITHIN, TaylorSeries
from ..lanes import Cells, Lanes
from ..march.carried import carry_free_peaks
from ..march.roots import from_powers
from ..observers.observer import Arcs
from ..outcome import FALLEN, LOST, Outcome
from .lane import Lane, LaneEdge
from .step import BENDS, NUMBERS, shorter, value

if TYPE_CHECKING:
    from ..observers.contact_watch import ContactWatch
    from ..tied.devices import Branch
    from ..tied.tied_lanes import TiedLanes


_STANDS = (Outcome.ROCKED, Outcome.LEANING)


class Ended(NamedTuple):
    """The end of a march."""

    outcome: Outcome  # outcome of the body
    theta_ratio: float  # max |theta|/alpha [-], NaN where the body fell
    impacts: int  # number of impacts during the shaking
    # instant at which the ground falls away from the body [tau], None if it does not
    lost: float | None = None
    # condition of the largest rotation, where it is carried
    condition: float = math.nan
    # the ties and the tendon of the body at its end, None without them
    restraints: "TiedLanes | None" = None


class MarchedArc(NamedTuple):
    """An arc of one body."""

    start: float  # instant of its start [tau]
    reach: float  # its duration [tau of the side]
    side: float  # +1 on the right edge, -1 on the left
    pace: float  # tau of the side over tau [-]
    h: float  # step of its terms [tau of the side]
    terms: Sequence[float]  # Taylor terms of y in powers of the time over h


class Listener:
    """What a march shows of its motion. The methods do nothing; a subclass overrides
    those that it needs.
    """

    # speed |y'| down to which bounces are shown, infinite if the instant at which the
    # body comes to rest does not matter
    visible = math.inf
    # y to which a fall is followed, on the right side and on the left; None up to where
    # it is certain
    fallen: tuple[float, float] | None = None

    def keep(self, arc: MarchedArc) -> None:
        """Called with each arc."""

    def note(
        self, tau: float, event: str, side: float, y: float, v: float, device: str = ""
    ) -> None:
        """Called with each event; device: the tie or tendon whose event it is."""

    def hold(self, law: "LawOfDevices") -> None:
        """Called where the force laws of ties and a tendon change."""


class LawOfDevices(NamedTuple):
    """The force laws of ties and a tendon from an instant on."""

    tau: float  # the instant [tau]
    row: int  # index of the side, as in `Devices`
    fixed: Array  # force at e = 0 [N], (devices,)
    rate: Array  # growth of the force with e [N/m], (devices,)
    # forces with which the devices hold the body at the ground against each side [N],
    # (sides, devices)
    held: Array


class MarchState:
    """The state of a march: segment k and phase u in it, the edge the body is on, y and
    y', the force if it is known to more digits than the drive tells, and the largest y
    so far in the unit of the first side.
    """

    still = STILL  # speed that counts as zero after an impact
    rate = 1.0  # rate of the fastest change of the body on still ground [1/tau]

    def __init__(
        self,
        lane: Lane,
        amplitude: float,
        peaks: bool,
        listener: Listener | None,
    ) -> None:
        self.lane, self.motion, self.segments = lane, lane.motion, lane.segments
        self.contact, self.equation = lane.system.contact, lane.system.equation
        self.cells = self.contact.cells(
            self.equation, np.array([amplitude]), lane.omega
        )
        self.edges = lane.edges(amplitude)
        self.listener = listener
        # The state, as in `Lanes`; the force is None where it follows from the drive.
        self.segment, self.phase, self.y, self.v = 0, 0.0, 0.0, 0.0
        self.force: float | None = None
        self.edge = self.edges[1.0]
        # largest y so far, in the unit of the first side; infinite if none is wanted
        self.watched = peaks or listener is not None
        self.peak = 0.0 if self.watched else math.inf
        # second moments of an error (`condition`), where they are carried: of the state
        # y, y' in `carried`, with the time since [tau], and of |theta|/alpha at the
        # largest peak
        self.carries = peaks and listener is None
        self.moments: ErrorMoments = (0.0, 0.0, 0.0)
        self.carried = (0.0, 0.0, 0.0)
        self.peak_moment = 0.0
        self.impacts = self.steps = 0
        self.bounced = False  # True after the first impact
        # speed at which the rest of a bouncing is summed, while it is no longer shown
        self.ending = 0.0
        self.unseen = 0
        self.least = WITHIN * self.equation.tolerance
        self.factors: list[float] = []  # factors of the last series ...
        self.factors_of = (0.0, 0)  # ... and their (unit, degree)
        # terms of the weight over m g in that step, None for 1
        self.weight: list[float] | None = None
        # largest sizes for which series of degree 3, 4 ... hold, by side
        self.limits = (
            {side: lane.size_limits(edge.omega) for side, edge in self.edges.items()}
            if self.motion.straight
            else {}
        )
        self.end: Ended | None = None  # None while the march goes on
        self.free_fall = FreeFall.of(lane.segments, self.cells, lane.shaken)
        # True where Lemma 13 does not prove beforehand that the body keeps contact
        self.doubtful = amplitude > lane.safe
        self.lost = False  # True after Fz <= 0

    def _leave_on_still_ground(self) -> None:
        """End the march on still ground: undamped by the closed form of the free motion
        (Lemma 8).
        """
        if self.lane.zeta:
            # the march does not test this before if there is a listener
            if not self._settled():
                self._finish(Outcome.FAILED)
            return
        lanes = self._lanes()
        if self.doubtful and not self.lost:
            self.watch.free(lanes)
            self.lost = bool(self.watch.lost(lanes.cell)[0])
        free = self.contact.free_motion(
            self.equation, lanes, np.array([0]), lanes.y, lanes.v
        )
        outcome = Outcome(int(free.outcome(self.bounced)[0]))
        if outcome == Outcome.ROCKED:
            if self.carries:
                self._carry_on(self.y, self.v, 0.0)
                lanes.moments[:3, 0] = self.moments
                carry_free_peaks(self.lane.system, lanes, np.array([0]), free.peak)
                self.peak_moment = float(lanes.moments[3, 0])
            highest = self._onto_first(float(free.peak[0]))
            self.peak = max(self.peak, highest)
        self._finish(outcome)

    def _settled(self) -> bool:
        """True, and the march ends, if a damped body on still ground stays upright
        (`Contact.settles`).
        """
        lanes = self._lanes()
        upright, peak = self.contact.settles(self.equation, lanes)
        if peak[0] > lanes.peak[0]:
            self.peak = self._onto_first(float(peak[0]))
        if not upright[0] or (
            self.doubtful and not self.watch.may_settle(lanes, np.zeros(1))[0]
        ):
            return False
        self._finish(Outcome.ROCKED)
        return True

    def _test_overturning(self) -> None:
        """End the march of a body beyond the unstable equilibrium if no later drive can
        bring it back (Lemma 6).
        """
        edge, top = self.edge, self.edge.top
        if self.listener is not None and self.listener.fallen is not None:
            top = self.listener.fallen[0 if edge.side > 0.0 else 1]
        if not (self.y >= edge.limit or (self.y >= top and self.v > 0.0)):
            return
        if self._cannot_return(self.y, self.v):
            self._finish(self._overturned())

    def _cannot_return(self, y: float, v: float) -> bool:
        """True if no later drive brings the body back on its present side (Lemma 6)."""
        here = self._lanes()
        here.y[0], here.v[0] = y, v
        return bool(cannot_return(self.segments, self.equation, here)[0])

    def _fall_freely(self) -> None:
        """End the march of a body from which the ground falls away now."""
        equation = self.equation.on(np.array([self.edge.side]))
        fallen = float(equation.rotation(np.array([self.y]))[0]) >= FALLEN
        self._finish(self._overturned() if fallen else Outcome.LOST_CONTACT)

    def _lanes(self) -> Lanes:
        """Return this body as `Lanes` with one lane."""
        edge = self.edge
        force = self.force
        if force is None:
            force = self._net(edge, self.segment, self.phase) - 1.0
        numbers = (
            0,
            abs(edge.drive),
            edge.omega,
            edge.speed_ratio,
            self.segment,
            self.phase,
            edge.side,
            self.y,
            self.v,
            force,
            self._between(self.peak, 1.0, edge.side),
            0,
            0,
            0.0,
        )
        lanes = Lanes(*(np.array([x]) for x in numbers))
        lanes.moments = np.array([[*self.moments, self.peak_moment]]).T
        return lanes

    @property
    def law(self) -> Any:
        """The equation of motion on this arc, with numbers that are floats."""
        return self.edge.equation

    def _at_ground(self, edge: LaneEdge) -> float:
        """y'' + 2 zeta y' of the body at the ground, on this edge."""
        return self._net(edge, self.segment, self.phase) - 1.0

    def _lifted(self) -> Cells:
        """The drive of the body, over what lifts it from rest."""
        return self.cells

    def _onto(self, edge: LaneEdge) -> None:
        """Put the body that is at the ground on this edge."""
        self.edge = edge

    def _moments_at(self, y: float, v: float, t: float) -> ErrorMoments:
        """The moments at a state (y, v) on this arc, t [tau] after the present one."""
        y0, v0, since = self.carried
        slope = slope_between(self.law, (y0, v0), (y, v), since + t)
        if not isinstance(slope, float):
            slope = float(np.ravel(slope)[0])
        return along(self.moments, since + t, slope, self.lane.zeta)

    def _carry_on(self, y: float, v: float, t: float, least: float = 0.0) -> None:
        """Carry the moments on to a state (y, v), t [tau] after the present one, if
        they have waited for longer than `least`: they change slowly.
        """
        y0, v0, since = self.carried
        if self.carries and since + t > least:
            self.moments = self._moments_at(y, v, t)
            self.carried = y, v, 0.0
        else:
            self.carried = y0, v0, since + t

    def _at_peak(self, moment: float, y: float) -> None:
        """Keep the second moment of y at the largest peak so far, at y."""
        equation = self.equation.on(np.array([self.edge.side]))
        rate = float(equation.rotation_rate(np.array([y]), np.ones(1))[0])
        self.peak_moment = rate * rate * moment

    def _onto_first(self, y: float) -> float:
        """The displacement on the first side that is as large a part of alpha as y on
        the present side.
        """
        return self._between(y, self.edge.side, 1.0)

    def _between(self, y: float, side: float, to: float) -> float:
        if side == to or self.contact.alike:
            return y
        own, here, there = (np.array([x]) for x in (y, side, to))
        cell = np.zeros(1, dtype=np.int64)
        return float(self.contact.converted(own, here, there, cell)[0])

    def _net(self, edge: LaneEdge, k: int, u: float) -> float:
        """The net drive c at phase u of segment k; 0 on the still ground after the
        motion.
        """
        if k >= self.motion.count:
            return 0.0
        return edge.net(*self.motion.value(k, u))

    def _overturned(self) -> Outcome:
        return (
            Outcome.OVERTURNED_AFTER_IMPACT
            if self.bounced
            else Outcome.OVERTURNED_NO_IMPACT
        )

    def _keep(self, reach: float, h: float, terms: list[float]) -> None:
        """Watch contact along an arc from the present instant on, and show it to the
        listener, if there is one.
        """
        shown = self.listener is not None and self.lane.body is not None
        if (self.doubtful or shown) and not self.lost and reach:  # also of a fall
            self._watch_contact(reach, h, terms)
        if self.listener is not None and not self.ending:
            start = self.lane.tau(self.segment, self.phase)
            pace = float(self.lane.omega[0]) / self.edge.omega
            arc = MarchedArc(start, reach, self.edge.side, pace, h, terms)
            self.listener.keep(arc)

    @cached_property
    def watch(self) -> "ContactWatch":
        """Finds out whether the body loses contact with the ground."""
        return self.lane.watch()

    def _watch_contact(self, reach: float, h: float, terms: list[float]) -> None:
        """Find out whether Fz <= 0 occurs on a step; note the first such instant."""
        own = terms if reach == h else shorter(terms, reach / h)
        sizes = list(map(abs, own))
        speed, bend = (sum(map(mul, x, sizes)) for x in (NUMBERS, BENDS))
        if self._presses(reach, speed, bend):
            return
        # The Bernstein coefficients of y' bound it more closely.
        rate = list(map(mul, NUMBERS[1:], own[1:]))
        speeds = from_powers(len(rate)) @ rate
        speed = float(np.abs(speeds).max())
        bend = float(np.abs(np.diff(speeds)).max()) * (len(rate) - 1.0)
        if self._presses(reach, speed, bend):
            return
        arcs = self._as_arrays(reach, own, speed, bend)
        self.lost = bool(self.watch.losses(arcs).size)
        if self.lost and self.listener is not None:
            instant = self.watch.first(arcs)
            y, v = value(own, instant / reach, reach)
            self._note(LOST, y, v, instant * self.edge.omega)

    def _presses(self, reach: float, speed: float, bend: float) -> bool:
        """True if the largest speed and acceleration of a step leave Fz > 0, times the
        duration of the step and its square.
        """
        lightest, weight = 1.0, self.weight
        if weight is not None:
            share = reach / self.factors_of[0]
            lightest = weight[0]
            for w in weight[1:]:
                lightest -= abs(w) * share
                share *= reach / self.factors_of[0]
        foot, over = self.lane.feet[self.edge.side], 1.0 / reach
        taken = relief(foot, self.y + speed, speed * over, bend * over * over)
        return bool(taken < lightest)

    def _as_arrays(
        self, reach: float, terms: list[float], speed: float, bend: float
    ) -> Arcs:
        """This step as the step of one lane."""
        h, zeta = np.array([reach]), self.lane.zeta
        arc = TaylorSeries(np.array(terms)[:, None], h, h, zeta)
        of_weight = None
        if self.weight is not None:
            unit = np.array([self.factors_of[0]])
            rows = np.array(self.weight)[:, None]
            of_weight = TaylorSeries(rows, unit, unit)
        bounds = np.array([speed]) / h, np.array([bend]) / (h * h)
        wanted, held = np.ones(1, dtype=bool), self._devices_now()
        return Arcs(self._lanes(), arc, h, *bounds, wanted, of_weight, held)

    def _devices_now(self) -> "tuple[Array, Branch] | None":
        """The row of the devices of the side and their branches; None without."""
        return None

    def _note(
        self, event: str, y: float, v: float, ahead: float = 0.0, device: str = ""
    ) -> None:
        """Show an event to the listener, if there is one; ahead: phase from the present
        instant on [rad].
        """
        if self.listener is not None and not self.ending:
            tau = self.lane.tau(self.segment, self.phase + ahead)
            self.listener.note(tau, event, self.edge.side, y, v, device)

    def _note_rest(self, tau: float) -> None:
        """Show a rest, which begins at tau, to the listener."""
        assert self.listener is not None
        self.listener.note(tau, "rest", 1.0, 0.0, 0.0)

    def _finish(self, outcome: Outcome) -> Ended:
        """End the march with this outcome. A body that would rock where the ground
        falls away from it has lost contact.
        """
        if self.lost and outcome in _STANDS:
            outcome = Outcome.LOST_CONTACT
        ratio = math.nan
        if outcome == Outcome.NO_UPLIFT:
            ratio = 0.0
        elif outcome in _STANDS and self.watched:
            first = self.equation.on(np.ones(1))
            ratio = float(np.ravel(first.rotation(np.array([self.peak])))[0])
        if (
            outcome in _STANDS
            and self.free_fall is not None
            and self.free_fall.occurs[0]
        ):
            outcome, ratio = Outcome.LOST_CONTACT, math.nan
        lost = None
        if outcome == Outcome.LOST_CONTACT and self.free_fall is not None:
            lost = self.lane.tau(
                int(self.free_fall.segment[0]), float(self.free_fall.phase[0])
            )
        condition = math.sqrt(self.peak_moment)
        self.end = Ended(outcome, ratio, self.impacts, lost, condition)
        return self.end

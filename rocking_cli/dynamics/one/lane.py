"""One body on floats before its march: the motion as lists, its edges, and its equation
on each.
"""

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...motions.motion import Motion
from ..batch import Batch
from ..body import Edge
from ..equations.equation import Equation
from ..equations.straight_lines import GROWTH, size_limits
from ..equations.taylor import LONGEST
from ..lanes import Cells, Lanes
from ..system import System
from .motion_lists import MotionLists

if TYPE_CHECKING:
    from ..observers.contact_watch import ContactWatch

# the longest of the first so many segments gives the number of terms of the series
_SAMPLED = 1 << 12


class LaneEdge(NamedTuple):
    """An edge that the body rocks on."""

    side: float  # +1 right (theta > 0), -1 left
    drive: float  # outward drive of s = 1 [-]
    omega: float  # omega_g / p of the side [-]
    sway: float  # zg''/g of s_v = 1 [-]
    # speed after over speed before the impact that leaves the side [-], each speed in
    # the unit of its side
    speed_ratio: float
    cycle_ratio: float  # the same for a bounce until the body is back on this side [-]
    top: float  # y of the unstable equilibrium
    limit: float  # y from which the body lies on its side
    equation: Equation  # equation of this edge, with numbers that are floats

    def net(self, s: float, up: float) -> float:
        """The net drive c at these values of s and of the vertical s_v."""
        return self.drive * s - self.sway * up


def _float_of(number: Any) -> float:
    """The first of the numbers of an array, or the number itself."""
    return float(np.ravel(number)[0])


class Lane:
    """One body under one motion at one Omega, for any amplitude: its edges, and the
    motion as lists.
    """

    def __init__(self, system: System, motion: Motion, omega: float) -> None:
        self.omega = np.array([omega])
        batch = Batch.of(system, system.segments(motion), np.ones(1), self.omega)
        cells, segments = batch.cells, batch.segments
        self.system, self.segments = system, segments
        self.shaken = batch.shaken  # number of segments of the motion itself
        self.most = batch.most_steps  # number of steps that are too many
        self.motion = MotionLists(segments)
        self.zeta = float(system.equation.damping)
        self.longest = float(np.max(segments.length[: min(self.shaken, _SAMPLED)]))
        # amplitude above which contact with the ground is watched
        self.safe = system.safe_amplitude(motion)
        self.body = system.body  # forces on the ground, None if they are not known
        self.restraints = None  # ties and a tendon, None without them
        ends = np.full(2, np.inf)  # y of the right and the left side at which they fail
        if system.devices is not None:
            from .lane_restraints import LaneRestraints

            self.restraints = LaneRestraints(system, segments, system.devices)
            self.body = system.devices.body
            self.safe = math.inf if self.body is None else -math.inf
            ends = system.devices.lever_ends()
        # The edges under A = 1. A body that comes back on the same side has one edge.
        self._unit = {1.0: self._edge(cells, 1.0)}
        if system.contact.alike:
            right = self._unit[1.0]
            self._unit[-1.0] = right._replace(side=-1.0, drive=-right.drive)
        elif system.contact.left:
            self._unit[-1.0] = self._edge(cells, -1.0)
        for (side, edge), end in zip(self._unit.items(), ends.tolist(), strict=False):
            self._unit[side] = edge._replace(limit=min(edge.limit, end))

        # numbers of the edge of each side for the forces of the ground, floats
        self.feet: dict[float, Edge] = {}
        if self.body is not None:
            for side in (1.0, -1.0):
                foot = self.body.on(np.array([side]), np.zeros(1, dtype=np.int64))
                self.feet[side] = Edge(*map(_float_of, foot))

    def watch(self) -> "ContactWatch":
        """Return what finds out whether the body loses contact; its forces on the
        ground must be known.
        """
        from ..observers.contact_watch import ContactWatch

        assert self.body is not None
        bounces = None if self.restraints is None else self.restraints.bounces
        equation, contact = self.system.equation, self.system.contact
        watched = np.ones(1, dtype=bool)
        return ContactWatch(
            self.body, equation, contact, self.segments, watched, bounces
        )

    def edges(self, amplitude: float) -> dict[float, LaneEdge]:
        """Return the edges, by the sign of their side, under a motion of this amplitude
        A: those of A = 1 with their drive and sway scaled.
        """
        return {
            side: edge._replace(
                drive=amplitude * edge.drive, sway=amplitude * edge.sway
            )
            for side, edge in self._unit.items()
        }

    def _edge(self, cells: Cells, side: float) -> LaneEdge:
        """Return the edge of a side under A = 1."""
        at, lanes = np.array([side]), self.lanes(cells, side)
        equation, weighed = self.system.equation.on(at), self.segments.weighed
        there = self.system.contact.other_side(lanes)
        sway = 0.0
        if weighed is not None:
            sway = _float_of(weighed.sway(at, lanes.amplitude))
        eta = float(lanes.eta[0])
        return LaneEdge(
            side=side,
            drive=-side * float(lanes.amplitude[0]),
            omega=float(lanes.omega[0]),
            sway=sway,
            speed_ratio=eta,
            cycle_ratio=eta if there is None else eta * _float_of(there.back),
            top=_float_of(equation.displacement(np.ones(1))),
            limit=_float_of(equation.limit),
            equation=self.system.equation.edge(side),
        )

    def size_limits(self, omega: float, growth: float = GROWTH) -> list[float]:
        """Return the largest sizes for which series of degree 3, 4 ... hold over the
        longest line (`straight_lines.size_limits`); growth: rate of the motion [1/tau].
        """
        unit = min(self.longest / omega, LONGEST)
        return size_limits(unit, self.system.equation.tolerance, growth)

    def lanes(self, cells: Cells, side: float) -> Lanes:
        """Return a lane for each cell on a side, at rest at the start of the motion."""
        at = np.arange(cells.amplitude.shape[1])
        return Lanes.at_rest(cells, at, np.full(at.size, side))

    def tau(self, k: int, u: float) -> float:
        """Time [tau of the first side] from the start of the motion to phase u of
        segment k.
        """
        seg, last = self.segments, len(self.segments) - 1
        return (
            float(seg.start[min(k, last)])
            + (u if k <= last else float(seg.length[last]))
        ) / float(self.omega[0])

    def edge_of(self, side: float) -> LaneEdge:
        """The edge of a side under A = 1."""
        return self._unit.get(side, self._unit[1.0])

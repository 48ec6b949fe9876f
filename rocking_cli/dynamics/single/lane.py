"""One body on floats before its march: the motion as lists, its edges, and its equation
on each.
"""

import math
from typing import Any, NamedTuple, Self

import numpy as np

from ...motions.segments import Segments
from ..batch import SETTLING
from ..equations.equation import Equation
from ..equations.taylor import LONGEST, size_limits
from ..lanes import Cells, Lanes
from ..system import System

# the longest of the first so many segments gives the number of terms of the series
_SAMPLED = 1 << 12
_BLOCK = 1 << 15  # segments whose lists are held at once


class Block(NamedTuple):
    """Segments that follow one another, as lists with a number for each."""

    first: int  # index of the first segment
    start: list[float]  # s at the start of each segment [-], (segments,)
    rise: list[float]  # increase of s over each segment [-], (segments,)
    length: list[float]  # length of each segment [rad], (segments,)
    # start of the vertical motion in each segment [-], (segments,); empty without one
    up: list[float]
    # its increase over each segment [-], (segments,); empty without one
    up_rise: list[float]


class Wave(NamedTuple):
    """The closed form of one segment: sinusoids and a straight line."""

    # of each sinusoid: sine part at the start of the segment [-], cosine part there
    # [-], frequency over that of the motion [-]
    parts: list[tuple[float, float, float]]
    slope: float  # slope of the straight line by the phase [1/rad]

    @classmethod
    def of(cls, segments: Segments, k: int) -> Self:
        """Return the wave of segment k."""
        columns = (
            x[:, k].tolist() for x in (segments.sin, segments.cos, segments.frequency)
        )
        return cls(
            [row for row in zip(*columns, strict=True) if row[0] or row[1]],
            float(segments.slope[k]),
        )

    def change(self, u: float) -> float:
        """s at phase u of the segment, less s at its start."""
        total = self.slope * u
        for sin, cos, w in self.parts:
            t = math.tan(0.5 * w * u)
            total += 2.0 * t * (cos - sin * t) / (1.0 + t * t)
        return total

    def terms(self, u: float, length: float, order: int) -> list[float]:
        """Terms 1 ... order, an even number, of s from phase u on, in powers of the
        phase over this length [rad]; term 0 is left at 0.
        """
        found = [0.0] * (order + 1)
        found[1] = self.slope * length
        for sin, cos, w in self.parts:
            x, c, s = w * length, math.cos(w * u), math.sin(w * u)
            odd, even = (cos * c - sin * s) * x, -0.5 * (sin * c + cos * s) * x * x
            for n in range(1, order, 2):
                found[n] += odd
                found[n + 1] += even
                odd *= -x * x / ((n + 1) * (n + 2))
                even *= -x * x / ((n + 2) * (n + 3))
        return found


class DriveLists:
    """The segments of a motion, read block by block as lists of floats."""

    def __init__(self, segments: Segments) -> None:
        self.segments = segments
        self.straight = segments.straight  # True if every segment is a straight line
        self.count = len(segments)
        self.vertical = None if segments.weighed is None else segments.weighed.vertical
        self.block = Block(0, [], [], [], [], [])  # the block that was read last
        self._waves: dict[int, tuple[Wave, ...]] = {}

    def at(self, k: int) -> Block:
        """The block that holds segment k."""
        block = self.block
        if not block.first <= k < block.first + len(block.length):
            first = k - k % _BLOCK
            part = slice(first, min(first + _BLOCK, self.count))
            lists: list[Any] = []
            for segments in (self.segments, self.vertical):
                start = (
                    np.empty(0)
                    if segments is None
                    else np.asarray(segments.s_start[part])
                )
                end = start if segments is None else np.asarray(segments.s_end[part])
                lists += [start.tolist(), (end - start).tolist()]
            length = np.asarray(self.segments.length[part]).tolist()
            block = self.block = Block(
                first, lists[0], lists[1], length, lists[2], lists[3]
            )
        return block

    def waves(self, k: int) -> tuple[Wave, ...]:
        """The waves of a segment that is not straight: the horizontal one, and the
        vertical one if there is one.
        """
        found = self._waves.get(k)
        if found is None:
            signals = (
                [self.segments]
                if self.vertical is None
                else [self.segments, self.vertical]
            )
            found = self._waves[k] = tuple(Wave.of(x, k) for x in signals)
        return found

    def value(self, k: int, u: float) -> tuple[float, float]:
        """s and the vertical s_v at phase u of segment k."""
        block = self.at(k)
        i = k - block.first
        share = u / block.length[i]
        if self.straight:
            return block.start[i] + block.rise[i] * share, (
                block.up[i] + block.up_rise[i] * share if block.up else 0.0
            )
        waves = self.waves(k)
        return block.start[i] + waves[0].change(u), (
            block.up[i] + waves[1].change(u) if block.up else 0.0
        )


class LaneEdge(NamedTuple):
    """An edge that the body rocks on."""

    side: float  # +1 right (theta > 0), -1 left
    drive: float  # outward drive of s = 1 [-]
    omega: float  # omega_g / p of the side [-]
    eta: float  # restitution of the cell on this side, as in `Cells` [-]
    sway: float  # zg''/g of s_v = 1 [-]
    # largest l up to `limit`, times the largest weight over m g [-]
    largest_lift: float
    largest_push: float  # largest m up to `limit` [-]
    largest_fall: float  # K of Lemma 12: bound of the inward force -f [-]
    # speed after over speed before the impact that leaves the side [-], each speed in
    # the unit of its side
    speed_ratio: float
    cycle_ratio: float  # the same for a bounce until the body is back on this side [-]
    unit: float  # y = 1 of this side, in the unit of the first side
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

    def __init__(
        self, system: System, segments: Segments, omega: float, eta: float
    ) -> None:
        self.omega = np.array([omega])
        self.eta = np.array([eta])
        self.shaken = len(segments)  # number of segments of the motion itself
        cells = system.contact.cells(system.equation, np.ones(1), self.omega, self.eta)
        # no closed form of the free motion: march on over still ground
        if system.equation.damping:
            segments = segments.followed_by_rest(
                SETTLING
                * (1.0 + 3.0 * system.equation.damping)
                * float(cells.omega.max())
            )
        self.system = system
        self.segments = segments
        self.drive_lists = DriveLists(segments)
        self.weighed = segments.weighed is not None
        self.zeta = float(system.equation.damping)
        # The largest |s|, also of the effective motions at the edges, and |s_v|.
        self.largest_vertical = 0.0
        self.largest = max(float(segments.later_max[0]), -float(segments.later_min[0]))
        if (weighed := segments.weighed) is not None:
            self.largest = max(
                self.largest, float(weighed.inward[0][0]), -float(weighed.inward[1][0])
            )
            self.largest_vertical = max(
                float(weighed.vertical.later_max[0]),
                -float(weighed.vertical.later_min[0]),
            )
        self.longest = float(np.max(segments.length[: min(self.shaken, _SAMPLED)]))
        # The edges under A = 1. A body that comes back on the same side has one edge.
        self._unit = {
            side: self._edge(cells, side)
            for side in (
                (1.0,) if self._after_impact(cells, 1.0)[0] > 0.0 else (1.0, -1.0)
            )
        }

    def edges(self, amplitude: float) -> dict[float, LaneEdge]:
        """Return the edges, by the sign of their side, under a motion of this amplitude
        A: those of A = 1 with their drive, sway and bounds of the force scaled.
        """
        edges = {}
        for side, edge in self._unit.items():
            drive, sway = amplitude * edge.drive, amplitude * edge.sway
            # Lemma 12: K = w_+ L + M max |a|, with w_+ the largest weight.
            largest_weight = 1.0 + abs(sway) * self.largest_vertical
            lift = largest_weight * edge.largest_lift
            fall = lift + edge.largest_push * abs(drive) * self.largest
            edges[side] = edge._replace(
                drive=drive, sway=sway, largest_lift=lift, largest_fall=fall
            )
        return edges

    def _edge(self, cells: Cells, side: float) -> LaneEdge:
        """Return the edge of a side under A = 1; `edges` sets `largest_fall`."""
        at = np.array([side])
        equation, weighed = self.system.equation.on(at), self.segments.weighed
        amplitude, omega, eta = (_float_of(x[cells.row(at), 0]) for x in cells)
        sway = 0.0
        if weighed is not None:
            sway = _float_of(weighed.sway(at, np.array([amplitude])))
        largest_lift, largest_push = (_float_of(x) for x in equation.bounds)
        speed_ratio, cycle_ratio = self._speed_ratios(cells, side)
        return LaneEdge(
            side=side,
            drive=-side * amplitude,
            omega=omega,
            eta=eta,
            sway=sway,
            largest_lift=largest_lift,
            largest_push=largest_push,
            largest_fall=0.0,
            speed_ratio=speed_ratio,
            cycle_ratio=cycle_ratio,
            unit=self._unit_of(cells, side),
            top=_float_of(equation.displacement(np.ones(1))),
            limit=_float_of(equation.limit),
            equation=self.system.equation.edge(side),
        )

    def _speed_ratios(self, cells: Cells, side: float) -> tuple[float, float]:
        """(speed after over before the impact that leaves a side, the same for a bounce
        until the body is back on this side).
        """
        to, speed_ratio = self._after_impact(cells, side)
        _, back = self._after_impact(cells, to)
        return speed_ratio, speed_ratio * back if to != side else speed_ratio

    def _unit_of(self, cells: Cells, side: float) -> float:
        """y = 1 of a side, in the unit of the first side."""
        lanes = self.lanes(cells, side)
        lanes.peak[:] = 1.0
        self.system.contact.turn(cells, lanes, np.array([0]), np.ones(1))
        return float(lanes.peak[0])

    def _after_impact(self, cells: Cells, side: float) -> tuple[float, float]:
        """(side after an impact on this side, speed after over speed before)."""
        lanes = self.lanes(cells, side)
        self.system.contact.impact(cells, lanes, -np.ones(1), -np.ones(1))
        return float(lanes.side[0]), float(lanes.v[0])

    def size_limits(self, omega: float) -> list[float]:
        """Return the largest sizes for which series of degree 3, 4 ... hold over the
        longest line (`taylor.size_limits`).
        """
        return size_limits(
            min(self.longest / omega, LONGEST), self.system.equation.tolerance
        )

    def lanes(self, cells: Cells, side: float) -> Lanes:
        """Return a lane for each cell on a side, at rest at the start of the motion."""
        at = np.arange(cells.amplitude.shape[1])
        sides = np.full(at.size, side)
        zero = np.zeros(at.size)
        count = np.zeros(at.size, dtype=np.int64)
        amplitude, omega, eta = (
            np.broadcast_to(values, cells.amplitude.shape)[cells.row(sides), at].astype(
                float
            )
            for values in cells
        )
        return Lanes(
            at,
            amplitude,
            omega,
            eta,
            count,
            zero,
            sides,
            zero.copy(),
            zero.copy(),
            zero.copy(),
            zero.copy(),
            count.copy(),
            count.copy(),
            np.zeros((4, at.size)),
        )

    def tau(self, k: int, u: float) -> float:
        """Time [tau of the first side] from the start of the motion to phase u of
        segment k.
        """
        seg, last = self.segments, len(self.segments) - 1
        return (
            float(seg.start[min(k, last)])
            + (u if k <= last else float(seg.length[last]))
        ) / float(self.omega[0])

    def omega_of(self, side: float) -> float:
        """omega_g over the p of a side."""
        return self._unit.get(side, self._unit[1.0]).omega

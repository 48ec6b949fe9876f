"""One body on floats before its march: its sides, the code of its equation on each, and the motion as lists."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..equations.taylor import LONGEST, MOST_TERMS, degrees
from ..lanes import Cells, Lanes
from ..march.batch import SETTLING
from ..system import System
from .drive_lists import Reel
from .recurrence import Code, compiled

_ORDER = 18  # order of series under sinusoids
_COMPOSED = 12  # largest order for an equation whose cost goes with the third power of the order
_NO_CODE = Code(0, lambda *_: (), None)
_SAMPLED = 1 << 12  # the longest of the first so many segments gives the number of terms of the series


class Face(NamedTuple):
    """A side that the body rocks on.

    drive: outward drive of s = 1; lift, push: the largest l and m; fall: K of Lemma 12; keeps: speed after over speed before an impact on
    leaving the side, each in the unit of its side; cycle: the same for a bounce until the body is back here; unit: y = 1 of this side in
    the unit of the first side; top: y of the unstable equilibrium; limit: y from which the body lies on its side.
    """

    side: float
    drive: float
    omega: float
    eta: float
    sway: float
    lift: float
    push: float
    fall: float
    keeps: float
    cycle: float
    unit: float
    top: float
    limit: float
    code: Code


class Lane:
    """One body under one motion at one Omega, for any amplitude: its equation as compiled code, and the motion as lists."""

    def __init__(self, system: System, segments: Segments, omega: float, eta: float) -> None:
        self.omega, self.eta, self.shaken = np.array([omega]), np.array([eta]), len(segments)
        cells = system.contact.cells(system.equation, np.ones(1), self.omega, self.eta)
        if system.equation.damping:  # no closed form of the free motion: march on over still ground
            segments = segments.followed_by_rest(SETTLING * (1.0 + 3.0 * system.equation.damping) * float(cells.omega.max()))
        self.system, self.segments, self.reel = system, segments, Reel(segments)
        self.weighed = segments.weighed is not None
        self.zeta = float(system.equation.damping)
        self.most_up = 0.0
        self.largest = max(float(segments.later_max[0]), -float(segments.later_min[0]))
        if (weighed := segments.weighed) is not None:
            self.largest = max(self.largest, float(weighed.inward[0][0]), -float(weighed.inward[1][0]))
            self.most_up = max(float(weighed.vertical.later_max[0]), -float(weighed.vertical.later_min[0]))
        self._codes: dict[tuple[float, int], Code] = {}
        self.laws = {side: system.equation.law(side) for side in (1.0, -1.0)}
        self.composed = self.laws[1.0].local is not None
        self.longest = float(np.max(segments.length[: min(self.shaken, _SAMPLED)]))
        self._unit = {side: self._face(cells, side) for side in ((1.0,) if self._strike(cells, 1.0)[0] > 0.0 else (1.0, -1.0))}

    def faces(self, amplitude: float) -> dict[float, Face]:
        """Returns the sides, by their sign, under a motion of this amplitude A."""
        faces = {}
        for side, face in self._unit.items():
            drive, sway = amplitude * face.drive, amplitude * face.sway
            heaviest = 1.0 + abs(sway) * self.most_up
            faces[side] = face._replace(drive=drive, sway=sway, lift=heaviest * face.lift, code=self._code(face, abs(drive)),
                                        fall=heaviest * face.lift + face.push * abs(drive) * self.largest)  # fmt: skip
        return faces

    def _face(self, cells: Cells, side: float) -> Face:
        """Returns the side under A = 1."""
        equation, seg, at = self.system.equation.on(np.array([side])), self.segments, np.array([side])
        row = cells.row(at)
        amplitude, omega, eta = (float(np.ravel(values[row, 0])[0]) for values in cells)
        lift, push, limit, top = (float(np.ravel(x)[0]) for x in (*equation.bounds, equation.limit, equation.displacement(np.ones(1))))
        sway = 0.0 if seg.weighed is None else float(np.ravel(seg.weighed.sway(at, np.array([amplitude])))[0])
        to, keeps = self._strike(cells, side)
        _, back = self._strike(cells, to)
        lanes = self.lanes(cells, side)
        lanes.peak[:] = 1.0
        self.system.contact.turn(cells, lanes, np.array([0]), np.ones(1))
        cycle = keeps * back if to != side else keeps
        return Face(side, -side * amplitude, omega, eta, sway, lift, push, 0.0, keeps, cycle, float(lanes.peak[0]), top, limit, _NO_CODE)

    def _strike(self, cells: Cells, side: float) -> tuple[float, float]:
        """(side after an impact on this side, share of the speed that is left)."""
        lanes = self.lanes(cells, side)
        self.system.contact.strike(cells, lanes, -np.ones(1), -np.ones(1))
        return float(lanes.side[0]), float(lanes.v[0])

    def _code(self, face: Face, drive: float) -> Code:
        """The code of a side, with the number of terms that an outward drive of this size under s = 1 needs."""
        order = _ORDER
        if self.reel.straight:
            unit = np.array([min(self.longest / face.omega, LONGEST)])
            order = int(degrees(np.array([4.0 + drive * self.largest]), unit, self.system.equation.tolerance)[0])
        key = face.side, min(order, _COMPOSED if self.composed else MOST_TERMS)
        if key not in self._codes:
            self._codes[key] = compiled(self.laws[face.side], key[1], self.zeta, self.reel.straight, self.weighed)
        return self._codes[key]

    def lanes(self, cells: Cells, side: float) -> Lanes:
        """Returns a lane for each cell on a side, at rest at the start of the motion."""
        at = np.arange(cells.amplitude.shape[1])
        sides, zero, count = np.full(at.size, side), np.zeros(at.size), np.zeros(at.size, dtype=np.int64)
        amplitude, omega, eta = (np.broadcast_to(values, cells.amplitude.shape)[cells.row(sides), at].astype(float) for values in cells)
        return Lanes(at, amplitude, omega, eta, count, zero, sides, zero.copy(), zero.copy(), zero.copy(), zero.copy(), count.copy(),
                     count.copy())  # fmt: skip

    def tau(self, k: int, u: float) -> float:
        """Time [tau of the first side] from the start of the motion to phase u of segment k."""
        seg, last = self.segments, len(self.segments) - 1
        return (float(seg.start[min(k, last)]) + (u if k <= last else float(seg.length[last]))) / float(self.omega[0])

    def omega_of(self, side: float) -> float:
        """omega_g over the p of a side."""
        return self._unit.get(side, self._unit[1.0]).omega

"""Tied bodies at the ground: how strongly their restraints hold them there, and which
of their bounces end in rest.
"""

from dataclasses import replace

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..contacts.contact import Contact
from ..contacts.sequences import (
    OtherSide,
    sequence_ends,
    sequence_time,
)
from ..drive import segment_value
from ..equations.equation import Equation
from .devices import BROKEN, Devices
from .tied_lanes import TiedLanes


class Bounces:
    """The bounces of a body with these restraints under a motion."""

    def __init__(
        self, devices: Devices, contact: Contact, equation: Equation, segments: Segments
    ) -> None:
        self.devices = devices
        self.contact = contact
        self.equation = equation
        self.segments = segments
        # theta^2 P h/(m g R sin(alpha)) over y, both in the unit in which the held body
        # falls back with acceleration 1 and y < 1/2
        held = (devices.unit * devices.held_at_first()).reshape(-1, devices.sides)
        # of each row, (rows,)
        self._levers = np.repeat(0.5 * held.max(axis=1) ** 2, devices.sides)
        if devices.linear:
            self._levers[:] = 0.0

    def uplift_ratios(self, lanes: TiedLanes) -> Array:
        """The drive at which lanes at rest leave the ground onto each side, over that
        of the free body, (sides, lanes).
        """
        return np.array(
            [
                1.0 + self.devices.pull(row, lanes.branch[i], lanes.plastic[i])
                for i, row in enumerate(self._rows(lanes))
            ]
        )

    def _rows(self, lanes: TiedLanes) -> list[Array]:
        """The rows of lanes on each of their sides."""
        sides = (1.0, -1.0)[: self.devices.sides]
        ones = np.ones(lanes.cell.size)
        return [self.devices.row(side * ones, lanes.cell) for side in sides]

    def end(self, lanes: TiedLanes) -> Array:
        """True for lanes just after an impact whose bouncing ends in rest before any
        other event (Lemma 7). A restraint that neither yields nor breaks gives back the
        work that it takes. Its moment is at least P h (1 - theta^2), P its force at the
        ground, if its stiffness makes up for a lever that falls (x < 0, down to -0.4 h)
        and theta < 1. The lemma's e covers this loss of moment.
        """
        free, there = self.free(lanes)
        devices = self.devices
        lowest = np.full(lanes.cell.size, np.inf)
        falls = np.zeros(lanes.cell.size, dtype=bool)
        every, rows = self.uplift_ratios(lanes), self._rows(lanes)
        for i, (ratio, row) in enumerate(zip(every, rows, strict=True)):
            whole = lanes.branch[i] != BROKEN
            # y at which the first device yields or breaks: the lemma's peak must stay
            # below it.
            limit = np.minimum(
                devices.thresholds(row, lanes.plastic[i])[1],
                devices.on(devices.ultimate, row),
            )
            level = np.where(whole, devices.level(row, limit), np.inf).min(axis=0)
            lowest = np.minimum(lowest, level / ratio)
            # No proof for devices whose moment falls with the rotation, or whose lever
            # falls too fast.
            h, x = devices.on(devices.height, row), devices.on(devices.behind, row)
            soft = (
                devices.on(devices.prestress, row) * x
                + devices.on(devices.stiffness, row) * h * h
                < 0.0
            )
            falls |= (whole & (soft | (x < -0.4 * h))).any(axis=0)
        free.peak[:] = np.minimum(free.peak, lowest)
        # The drive goes up to that at uplift, which is larger than of the free body.
        on_edge = self.equation.on(lanes.side, lanes.cell)
        gain = on_edge.gain * (every.max(axis=0) - 1.0)
        return ~falls & sequence_ends(
            self.segments, free, self.equation, there, self._levers[rows[0]] + gain
        )

    def free(self, lanes: TiedLanes) -> tuple[TiedLanes, OtherSide | None]:
        """(lanes, their other side) of a free body on which the restraints act as the
        constant forces that they have at the ground. The unit of y is the one in which
        the body at rest falls back with acceleration 1.
        """
        every = self.uplift_ratios(lanes)
        row = self.devices.row(lanes.side, lanes.cell) % self.devices.sides
        there = self.contact.other_side(lanes)
        ratio = every[row, np.arange(row.size)]
        seg, k = self.segments, np.minimum(lanes.segment, len(self.segments) - 1)
        amplitude = lanes.amplitude / ratio
        # Force at the ground in the new unit: outward drive - 1.
        s = seg.s_start[k] + segment_value(seg, k, lanes.phase)[0]
        b = seg.force_at_impact(
            lanes.side, amplitude, k, lanes.phase, -lanes.side * amplitude * s - 1.0
        )
        if there is not None:
            # The other side has its own restraints, and so its own unit.
            over = every[1 - row, np.arange(row.size)] / ratio
            drive, time, rotation = (
                np.broadcast_to(x, ratio.shape)
                for x in (there.drive, there.time, there.rotation)
            )
            there = OtherSide(
                drive / over, time, there.eta / over, there.back * over, rotation * over
            )
        return (
            replace(
                lanes,
                amplitude=amplitude,
                v=lanes.v / ratio,
                force=b,
                peak=lanes.peak / ratio,
            ),
            there,
        )

    def during(
        self, lanes: TiedLanes, side: Array, height: Array
    ) -> tuple[Array, Array, Array]:
        """(y of a side over the y of the free body of `free`; what the devices add to
        -y'' up to y = height of the free body, at most; the vertical force of a tendon
        at the ground over m g) of lanes for which `end` is True, (lanes,) each.
        """
        devices = self.devices
        row = devices.row(side, lanes.cell)
        here = devices.place(row)
        unit = self.uplift_ratios(lanes)[here[0], here[2]]
        branch, plastic = lanes.branch[here].T, lanes.plastic[here].T
        most = devices.largest_pull(row, branch, plastic, unit * height)
        pull = most - devices.pull(row, branch, plastic)
        return unit, pull, devices.press(row, branch, plastic)

    def time(self, lanes: TiedLanes) -> Array:
        """The time [tau] that the bounces of lanes after an impact take, (lanes,)."""
        return sequence_time(self.segments, *self.free(lanes))

"""What the ground does to bodies along their march: the push, the weight, and how long a bouncing lasts under them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..body import Body
from ..contacts.contact import Contact
from ..drive import segment_value, summed
from ..lanes import Array, Lanes

_TRIALS = 4  # of the time that a bouncing lasts


class Shaking(NamedTuple):
    """The outward push over g and the weight over m g, and their slopes by tau; the weight's are floats where it does not vary."""

    push: Array
    push_slope: Array
    weight: Array | float
    weight_slope: Array | float


class Ground:
    """The ground of a motion under a rigid body."""

    def __init__(self, body: Body, segments: Segments) -> None:
        self.body, self.segments = body, segments

    def shaking(self, lanes: Lanes, h: Array) -> Shaking:
        """After h [tau] on the present side of lanes, by the closed form of the piece that they are in."""
        phase = lanes.u + lanes.omega * h
        outward = -lanes.side * lanes.amplitude * self.body.on(lanes.side).uplift
        push, push_slope = value_and_slope(self.segments, lanes.k, phase)
        weighed = self.segments.weighed
        if weighed is None:
            return Shaking(outward * push, outward * lanes.omega * push_slope, 1.0, 0.0)
        sway = weighed.sway(lanes.side, lanes.amplitude)
        rise, rise_slope = value_and_slope(weighed.vertical, lanes.k, phase)
        return Shaking(outward * push, outward * lanes.omega * push_slope, 1.0 + sway * rise, sway * lanes.omega * rise_slope)

    def push(self, lanes: Lanes, h: Array) -> Array:
        """The outward push over g after h."""
        change = segment_value(self.segments, lanes.k, lanes.u + lanes.omega * h)[0]
        return -lanes.side * lanes.amplitude * self.body.on(lanes.side).uplift * (self.segments.s_start[lanes.k] + change)

    def weight(self, lanes: Lanes, h: Array | float) -> Array | float:
        """The weight over m g after h."""
        return self.segments.weight(lanes.side, lanes.amplitude, lanes.k, lanes.u + lanes.omega * h)

    def bouncing_lasts(self, lanes: Lanes, contact: Contact) -> Array:
        """How long [tau] lanes just after an impact bounce until they rest, as long as under the drive half way, at most to the end of
        their segment."""
        here = self.body.on(lanes.side)
        room, trial = (self.segments.length[lanes.k] - lanes.u) / lanes.omega, lanes.take(np.arange(lanes.cell.size))
        lasts = np.zeros(lanes.cell.size)
        for _ in range(_TRIALS):
            push, weight = self.push(lanes, 0.5 * lasts), self.weight(lanes, 0.5 * lasts)
            trial.b = self.body.lifting(here, push, weight) / here.unit
            lasts = np.clip(contact.sequence_time(trial, weight), 0.0, room)
        return lasts


def value_and_slope(segments: Segments, k: Array, phase: Array) -> tuple[Array, Array]:
    """s and its slope by the phase."""
    change, _, cos = segment_value(segments, k, phase)
    return segments.s_start[k] + change, summed(segments.frequency.take(k, axis=1) * cos) + segments.slope[k]

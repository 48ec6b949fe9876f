"""Lost contact of tied bodies: where along a step of their march the vertical force Fz
of the ground falls to zero.

With u = |theta|, z = alpha - u, w the weight over m g and D the vertical force of a
tendon on the body over m g,

    Fz/(m g) = w + kappa (u'' sin z - u'^2 cos z) + D,    D = F cos(u/2)/(m g)

A tie pulls horizontally: it changes Fz by the acceleration alone. Between two instants
h apart Fz does not leave its chord by more than h^2/8 times a bound of |Fz''|. With
bounds V, B, J and Q of the first four derivatives of u (by tau), and F the largest
force and k b the largest stiffness of the tendon,

    |Fz''|/(m g) <= |w''| + kappa [(Q + 6 V^2 B) |sin z| + 4 V J + 3 B^2 + V^4]
                    + [(F/4 + k b) V^2 + (F/2 + k b) B]/(m g)
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.blocks import blocks
from ..body import Body, Edge, ground_reaction
from ..drive import summed
from ..equations.taylor import TaylorSeries, powers
from ..lanes import Lanes
from .devices import Branch, Devices
from .series import Step

# parts of a step at which Fz is computed where the whole step proves nothing
_INSTANTS = np.linspace(0.0, 1.0, 33)
_TOGETHER = 256  # lanes whose instants are computed together
# after so many, Fz was positive at every instant computed: it touches zero at most
_HALVINGS = 30


class Steps(NamedTuple):
    """The steps of lanes along which Fz is computed, (lanes,)."""

    lanes: Lanes  # the state at the start of the steps
    row: Array  # row of the devices of their side
    now: Branch  # the branches of the devices
    step: Step  # the motion
    reach: Array  # time from the start that the lane goes along the step [tau]
    weight: TaylorSeries | None  # of the weight over m g along the steps, None for 1


class StepParts(NamedTuple):
    """Parts of steps between two instants after their start, (parts,)."""

    lane: Array  # index of the lane
    low: Array  # first instant [tau]
    high: Array  # last instant [tau]
    fz_low: Array  # Fz/(m g) at the first instant [-]
    fz_high: Array  # Fz/(m g) at the last instant [-]

    def take(self, at: Array) -> StepParts:
        """Return these parts only."""
        return StepParts(*(x[at] for x in self))


class ContactWatch:
    """Finds steps of tied bodies on which Fz <= 0 occurs."""

    def __init__(self, devices: Devices, body: Body) -> None:
        # body: gives the forces of the free body on the ground
        self.devices, self.body = devices, body

    def losses(self, steps: Steps, known: Array) -> tuple[Array, Array]:
        """Return (indices of the lanes that lose the ground on their steps, instants
        (2, lanes) [tau] around the first Fz = 0 found).

        known: True for lanes that are not looked at.
        """
        # Three proofs of Fz > 0, each for the lanes that the one before leaves open: by
        # the largest speed and acceleration, by the chord over the whole step, and by
        # the chords of its parts.
        at = np.flatnonzero(~known & ~self._proved_by_size(steps))
        if not at.size:
            return at, np.zeros((2, 0))
        curvature = self._largest_curvature(steps, at)
        whole = self._parts(steps, at, np.array([0.0, 1.0]))
        at, curvature = (x[~_proved(whole, curvature)] for x in (at, curvature))
        lost, found = [np.zeros(0, dtype=np.int64)], [np.zeros((2, 0))]
        for block in blocks(at.size, _TOGETHER):
            which, around = self._search(steps, at[block], curvature[block])
            lost.append(which)
            found.append(around)
        return np.concatenate(lost), np.concatenate(found, axis=1)

    def fz(self, steps: Steps, at: Array, h: Array) -> Array:
        """Return Fz/(m g) of the lanes `at`, h [tau] after the start of their steps."""
        lanes, row, now, step, _, of_weight = steps
        side, here = (
            self.body.on(lanes.side[at], lanes.cell[at]),
            step.arc.take(at).at(h),
        )
        weight = 1.0 if of_weight is None else of_weight.take(at).at(h).y
        u, v, b = (side.unit * x for x in (here.y, here.v, here.b))
        _, fz = ground_reaction(side, u, v, b, 0.0, weight)
        return np.asarray(fz + self.devices.downwards(row[at], now.take(at), here.y))

    def first(self, steps: Steps, low: Array, high: Array) -> Array:
        """Return the instant [tau], (1,), between these two at which Fz of the first
        lane falls to zero.
        """
        lane = np.zeros(1, dtype=np.int64)
        while (low < (middle := 0.5 * (low + high))) and (middle < high):
            in_contact = self.fz(steps, lane, middle)[0] > 0.0
            low, high = (middle, high) if in_contact else (low, middle)
        return high

    def _proved_by_size(self, steps: Steps) -> Array:
        """True where the largest speed and acceleration of a step leave Fz > 0."""
        edge, step = self.body.on(steps.lanes.side, steps.lanes.cell), steps.step
        downwards = (
            np.minimum(self._lean(edge, steps), 1.0) * step.largest_acceleration
            + edge.unit * step.fastest**2
        )
        lightest, _ = _weight_bounds(steps)
        return np.asarray(edge.kappa * edge.unit * downwards < lightest)

    def _lean(self, edge: Edge, steps: Steps) -> Array:
        """The largest |z| on each step [rad]."""
        highest = steps.lanes.y + steps.step.h * steps.step.fastest
        return np.maximum(edge.alpha, edge.unit * highest - edge.alpha)

    def _largest_curvature(self, steps: Steps, at: Array) -> Array:
        """A bound of |Fz''|/(m g) on the steps of the lanes `at`."""
        edge, step = self.body.on(steps.lanes.side, steps.lanes.cell), steps.step
        unit = np.broadcast_to(edge.unit, steps.reach.shape)[at]
        v, b = unit * step.fastest[at], unit * step.largest_acceleration[at]
        # Bounds of u''' (j) and u'''' (q): the sums of the sizes of the terms.
        arc, n = step.arc.take(at), np.arange(3.0, len(step.arc.terms))[:, None]
        share = steps.reach[at] / arc.unit
        third = n * (n - 1.0) * (n - 2.0) * np.abs(arc.terms[3:])
        j = unit * np.sum(third * share ** (n - 3.0), axis=0) / arc.unit**3
        q = (
            unit
            * np.sum(third[1:] * (n[1:] - 3.0) * share ** (n[1:] - 4.0), axis=0)
            / arc.unit**4
        )
        # Second derivative of kappa (u'' sin z - u'^2 cos z), with |cos z| <= 1.
        sin = np.minimum(self._lean(edge, steps)[at], 1.0)
        kappa = np.broadcast_to(edge.kappa, steps.reach.shape)[at]
        of_body = kappa * (
            (q + 6.0 * v * v * b) * sin + 4.0 * v * j + 3.0 * b * b + v**4
        )
        # A tendon adds its force times cos(u/2).
        turned = unit * (steps.lanes.y[at] + step.h[at] * step.fastest[at])
        force, stiffness = self.devices.tendon_bounds(
            steps.row[at], steps.now.take(at), turned
        )
        of_tendon = (0.25 * force + stiffness) * v * v + (0.5 * force + stiffness) * b
        _, bends = _weight_bounds(steps)
        return np.asarray(of_body + of_tendon + bends[at])

    def _parts(self, steps: Steps, at: Array, shares: Array) -> StepParts:
        """Return the parts between these shares of the steps of the lanes `at`, lane
        by lane.
        """
        h = steps.reach[at][:, None] * shares
        lane = np.repeat(at, shares.size)
        fz = self.fz(steps, lane, h.ravel()).reshape(h.shape) if at.size else h
        each = np.repeat(at, shares.size - 1)
        return StepParts(
            each, *(x.ravel() for x in (h[:, :-1], h[:, 1:], fz[:, :-1], fz[:, 1:]))
        )

    def _search(self, steps: Steps, at: Array, curvature: Array) -> tuple[Array, Array]:
        """As `losses`, for the lanes `at`, on parts of steps that are halved until Fz >
        0 is proved or Fz <= 0 is found.
        """
        found = np.full((2, steps.reach.size), math.inf)
        bound = np.zeros(steps.reach.size)
        bound[at] = curvature
        left = self._parts(steps, at, _INSTANTS)
        for _ in range(_HALVINGS):
            falls = np.flatnonzero((left.fz_low <= 0.0) | (left.fz_high <= 0.0))
            # In reverse: the first part of a lane is stored last, and stays.
            for i in falls[::-1].tolist():
                found[:, left.lane[i]] = (
                    left.low[i],
                    left.high[i] if left.fz_low[i] > 0.0 else left.low[i],
                )
            left = left.take(
                np.flatnonzero(
                    ~_proved(left, bound[left.lane]) & np.isinf(found[0, left.lane])
                )
            )
            if not left.lane.size:
                break
            middle = 0.5 * (left.low + left.high)
            fz = self.fz(steps, left.lane, middle)
            halves = (
                (left.low, middle, left.fz_low, fz),
                (middle, left.high, fz, left.fz_high),
            )
            left = StepParts(
                np.repeat(left.lane, 2),
                *(np.stack(pair, axis=1).ravel() for pair in zip(*halves, strict=True)),
            )
        lost = at[np.isfinite(found[0, at])]
        return lost, found[:, lost]


def _weight_bounds(steps: Steps) -> tuple[Array, Array]:
    """(the least weight over m g, a bound of its second derivative) on each step."""
    if steps.weight is None:
        return np.ones(steps.reach.size), np.zeros(steps.reach.size)
    weight, n = steps.weight, np.arange(float(len(steps.weight.terms)))[:, None]
    sizes, powers_of_h = np.abs(weight.terms), powers(steps.reach / weight.unit, n.size)
    bends = n[2:] * (n[2:] - 1.0) * powers_of_h[: n.size - 2] / weight.unit**2
    # No weight is less than the first term less the sizes of all others.
    return (
        weight.terms[0] - summed(sizes[1:] * powers_of_h[1:]),
        summed(sizes[2:] * bends),
    )


def _proved(these: StepParts, curvature: Array) -> Array:
    """True where the chord of Fz, less its error, is positive; curvature: a bound of
    |Fz''|/(m g).
    """
    h = these.high - these.low
    return np.asarray(
        np.minimum(these.fz_low, these.fz_high) > 0.125 * h * h * curvature
    )

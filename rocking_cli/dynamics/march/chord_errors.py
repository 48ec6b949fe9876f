"""By how much Fz of a rigid body can leave its chord along a step, from bounds of the motion.

Along a step y is smooth. With bounds V, B, J and Q of the first four derivatives of u = |theta| [rad by tau], P and W of the push over g
and the weight over m g, the second derivative of Fz over m g is at most

    W'' + kappa [T |sin z| + S],   T = Q + 6 V^2 B,   S = 4 V J + 3 B^2 + V^4

while V <= max(|u'| at its ends) + (h^2/8) J: between its ends Fz does not leave its chord by more than h^2/8 of that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Arrays
from ..body import Body, Edge

Array = np.ndarray

_ROOM = 0.25  # of the bound of a speed; a longer stretch has none


@dataclass
class Ends(Arrays):
    """u, u', u'' [rad by tau] and Fz/(m g) at one end of stretches, (stretches,)."""

    u: Array
    v: Array
    b: Array
    fz: Array


class Shakes(NamedTuple):
    """The largest push over g of each stretch and its first two derivatives by tau, and the same of the change of the weight over m g."""

    push: Array
    push1: Array
    push2: Array
    sway: Array
    sway1: Array
    sway2: Array


def fastest(body: Body, edge: Edge, s: Shakes, h: Array, u0: Array, v0: Array, u1: Array, v1: Array) -> Array:
    """Bound of |u'| on stretches of length h between these ends; infinite where they are too long for one.

    |u'''| is at most P' + W' |z| + 2 zeta (P + W |z|) and (P + W + 4 zeta^2) |u'|, for the nonlinear
    equation with |sin z| for |z|; the linear one has no P |u'|.
    """
    zeta2, weight = 2.0 * body.damping, 1.0 + s.sway
    by_turn = s.sway1 + zeta2 * weight
    flat, steep = s.push1 + zeta2 * s.push, weight + zeta2 * zeta2
    if body.linear:
        flat, steep = flat + by_turn * (edge.alpha + 0.5 * (u0 + u1)), steep + by_turn * 0.5 * h
    else:
        flat, steep = flat + by_turn, steep + s.push
    eighth = 0.125 * h * h
    room = 1.0 - eighth * steep
    return np.where(room > _ROOM, (np.maximum(np.abs(v0), np.abs(v1)) + eighth * flat) / np.maximum(room, _ROOM), np.inf)


def chord_errors(body: Body, edge: Edge, s: Shakes, h: Array, one: Ends, other: Ends) -> Array:
    """h^2/8 times a bound of |Fz''| over m g."""
    zeta2, heavy, v = 2.0 * body.damping, 1.0 + s.sway, fastest(body, edge, s, h, one.u, one.v, other.u, other.v)
    middle = edge.alpha - 0.5 * (one.u + other.u)
    turn = np.abs(middle) + 0.5 * v * h
    sin = np.sin(np.minimum(turn, 0.5 * np.pi))
    lean = turn if body.linear else sin
    b = s.push + heavy * lean + zeta2 * v
    j = s.push1 + (s.push * sin + heavy) * v + s.sway1 * lean + zeta2 * b
    b = np.minimum(b, 0.5 * (np.abs(one.b) + np.abs(other.b) + j * h))
    square = v * v
    q = s.push2 + 2.0 * (s.push1 * sin + s.sway1) * v + (s.push + heavy * sin) * square + (s.push * sin + heavy) * b
    q += s.sway2 * lean + zeta2 * j + 6.0 * square * b
    rest = 4.0 * v * j + 3.0 * b * b + square * square
    return 0.125 * h * h * (s.sway2 + edge.kappa * (q * sin + rest))

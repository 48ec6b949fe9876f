"""An independent answer for one cell of an unequal, one-sided or damped body: theta(t) in SI units, no code of the package.

Steps of Gauss collocation with fourteen nodes (order 28), solved by Picard iteration and halved until the Legendre series of
the acceleration has ended. Impacts, crests and dips are looked for on 48 points of every step's polynomial, each refined on
that polynomial, and an impact once more by a step that ends in it. The contact rules are plain Python.

    linear      theta'' = p^2 (theta - alpha sgn theta - a_scale xg/g) - 2 zeta p theta'
    nonlinear   theta'' = -p^2 (sin(alpha sgn theta - theta) + xg/g cos(alpha sgn theta - theta)) - 2 zeta p theta'

with p and alpha of the edge on which the body stands: right for theta > 0, left for theta < 0. Positive xg drives theta
negative.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import brentq, minimize_scalar

NODES, FINE = 14, 48
SLOW, REST = 1e-9, 1e-12  # of alpha p: bounces this slow have ended if they end before the next uplift, or in any case
LONGEST = 0.75  # of 1/p, and of a radian of the motion's phase

_x, _w = legendre.leggauss(NODES)
_c, _weights = 0.5 * (_x + 1.0), 0.5 * _w
_analyse = (np.arange(NODES)[:, None] + 0.5) * legendre.legvander(_x, NODES - 1).T * _w  # values at the nodes to Legendre terms
_once = legendre.legint(np.eye(NODES), lbnd=-1, scl=0.5)
_twice = legendre.legint(_once, lbnd=-1, scl=0.5)
_fine = np.arange(FINE + 1) / FINE


def _integrals(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Matrices from values at the nodes to the first and second integral at these points of [0, 1]."""
    x = 2.0 * at - 1.0
    return legendre.legvander(x, NODES) @ _once @ _analyse, legendre.legvander(x, NODES + 1) @ _twice @ _analyse


_V, _Y = _integrals(_c)
_V_FINE, _Y_FINE = _integrals(_fine)
_END = _weights * (1.0 - _c)


@dataclass(frozen=True)
class Edge:
    """One edge: p [rad/s], alpha [rad], eta (speed after over before on leaving it), a_scale of the linear equation."""

    p: float
    alpha: float
    eta: float
    a_scale: float = 1.0


@dataclass(frozen=True)
class Body:
    """Its edges; left None: it leaves the ground on its right edge only, and right.eta is e < 0. damping: zeta."""

    right: Edge
    left: Edge | None
    damping: float = 0.0
    nonlinear: bool = False
    gravity: float = 9.81

    def edge(self, side: int) -> Edge:
        return self.right if side > 0 or self.left is None else self.left

    def threshold(self, side: int) -> float:
        """|xg| [m/s2] beyond which the body at rest leaves the ground onto this side."""
        if side < 0 and self.left is None:
            return math.inf
        edge = self.edge(side)
        return self.gravity * (math.tan(edge.alpha) if self.nonlinear else edge.alpha / edge.a_scale)

    def acceleration(self, side: int, turned: Any, speed: Any, ground: Any) -> Any:
        """d2|theta|/dt2 on a side."""
        edge = self.edge(side)
        pushed = side * ground / self.gravity
        if self.nonlinear:
            gap = edge.alpha - turned
            force = -np.sin(gap) - pushed * np.cos(gap)
        else:
            force = turned - edge.alpha - edge.a_scale * pushed
        return edge.p**2 * force - 2.0 * self.damping * edge.p * speed


class Answer(NamedTuple):
    """Outcome flag, max of |theta|/alpha of the side it is on (NaN where overturned), impacts during the shaking."""

    outcome: str
    rotation: float
    impacts: int


class Step(NamedTuple):
    """A step of length h from (t, y, v): the acceleration at its nodes, and the state at its end."""

    t: float
    y: float
    v: float
    h: float
    nodes: np.ndarray
    y_end: float
    v_end: float

    def dense(self) -> tuple[Callable[[float], float], Callable[[float], float]]:
        """y and v as functions of the part of the step."""
        terms = _analyse @ self.nodes
        speed, way = (_once @ terms).tolist(), (_twice @ terms).tolist()
        return (
            lambda part: self.y + self.h * (part * self.v + self.h * _sum(way, part)),
            lambda part: self.v + self.h * _sum(speed, part),
        )


def _sum(terms: list[float], part: float) -> float:
    """A Legendre series at 2 part - 1, by Clenshaw's recurrence."""
    x, a, b = 2.0 * part - 1.0, 0.0, 0.0
    for k in range(len(terms) - 1, 0, -1):
        a, b = terms[k] + (2 * k + 1) / (k + 1) * x * a - (k + 1) / (k + 2) * b, a
    return terms[0] + x * a - 0.5 * b


class Shaking(NamedTuple):
    """Ground acceleration a_g s(omega_g t) [m/s2]; s takes an array of phases. It ends at `end` [s] and jumps at `marks`."""

    s: Callable[[np.ndarray], np.ndarray]
    a_g: float
    omega_g: float
    end: float
    marks: tuple[float, ...]

    def ground(self, t: np.ndarray) -> np.ndarray:
        return self.a_g * np.asarray(self.s(self.omega_g * t), dtype=float)

    def next_mark(self, t: float) -> float:
        """The end of the piece that begins at t or holds it; t's own rounding is no piece."""
        return next((m for m in self.marks if m > t + 1e-13 * self.end), math.inf)


def _advance(body: Body, shaking: Shaking, side: int, state: tuple[float, float, float], longest: float) -> Step:
    """A step of at most this length on which the series of the acceleration has ended."""
    t, y, v = state
    h, scale = longest, body.edge(side).p ** 2 * body.edge(side).alpha
    while True:
        at = t + h * _c
        ground = shaking.ground(at) if t < shaking.end else np.zeros(NODES)
        free = y + h * v * _c
        f = body.acceleration(side, free, v + 0.0 * _c, ground)
        change, least = math.inf, math.inf
        for _ in range(60):
            new = body.acceleration(side, free + h * h * (_Y @ f), v + h * (_V @ f), ground)
            change, f = float(np.abs(new - f).max()), new
            if change <= 1e-16 * scale or (change >= least and change < 1e-14 * (scale + np.abs(f).max())):
                break
            least = min(least, change)
        tail = np.abs(_analyse[-3:] @ f).max()
        if tail < 3e-14 * (scale + np.abs(f).max()) or h < 1e-9 * longest:
            return Step(t, y, v, h, f, y + h * (v + h * float(_END @ f)), v + h * float(_weights @ f))
        h *= 0.5


def _zero(function: Callable[[float], float], low: float, high: float) -> float:
    below, above = function(low), function(high)
    if below == 0.0 or (below > 0.0) == (above > 0.0):
        return low if abs(below) < abs(above) else high
    return float(brentq(function, low, high, xtol=1e-16, rtol=1e-15))


def _events(step: Step) -> tuple[float | None, float]:
    """(part of the step at its first impact or None, largest y before it)."""
    y = step.y + step.h * (_fine * step.v + step.h * (_Y_FINE @ step.nodes))
    v = step.v + step.h * (_V_FINE @ step.nodes)
    y[0], v[0] = step.y, step.v
    height, speed = step.dense()
    highest = step.y
    for i in np.flatnonzero((y[1:] <= 0.0) | ((v[1:] > 0.0) != (v[:-1] > 0.0))):
        a, b = float(_fine[i]), float(_fine[i + 1])
        highest = max(highest, float(y[: i + 1].max()))
        hit = None
        if v[i] > 0.0 >= v[i + 1]:
            highest = max(highest, height(_zero(speed, a, b)))
        if y[i + 1] <= 0.0:
            low = a if i or step.y > 0.0 else 1e-9 * b  # past the root at the start itself
            hit = _zero(height, low, b) if height(low) > 0.0 else low
        elif v[i] < 0.0 < v[i + 1] and min(y[i], y[i + 1]) < (b - a) * step.h * max(-v[i], v[i + 1]):
            dip = _zero(speed, a, b)
            hit = _zero(height, a, dip) if height(dip) <= 0.0 else None
        if hit is not None:
            return hit, highest
    return None, max(highest, float(y.max()))


def _uplift(body: Body, shaking: Shaking, t: float) -> tuple[float, int] | None:
    """Instant and side of the first uplift from rest at or after t."""
    limits = {side: body.threshold(side) for side in (1, -1)}

    def excess(x: float, side: int) -> float:
        return -side * float(shaking.ground(np.array([x]))[0]) - limits[side]

    while t < shaking.end * (1.0 - 1e-14):
        stop = min(shaking.next_mark(t), shaking.end)
        inset = 1e-13 * (stop - t)
        times = np.linspace(t + inset, stop - inset, 65)
        found: list[tuple[float, int]] = []
        for side, limit in limits.items():
            over = -side * shaking.ground(times) - limit
            for i in range(times.size):
                if over[i] > 0.0:
                    found.append((t if i == 0 else brentq(excess, times[i - 1], times[i], (side,), xtol=1e-300, rtol=1e-15), side))
                    break
                # A crest between two samples that only just passes the limit.
                if 0 < i < times.size - 1 and over[i] >= max(over[i - 1], over[i + 1]) and over[i] > -1e-3 * limit:
                    top = minimize_scalar(lambda x, side=side: -excess(x, side), bounds=(times[i - 1], times[i + 1]), method="bounded",
                                          options={"xatol": 1e-12 * stop})  # fmt: skip
                    if top.fun < 0.0:
                        found.append((brentq(excess, times[i - 1], top.x, (side,), xtol=1e-300, rtol=1e-15), side))
                        break
        if found:
            return min(found)
        t = stop
    return None


def _stays_up(body: Body, shaking: Shaking, side: int, t: float, longest: float) -> float:
    """A step after an uplift no longer than the stretch on which the ground goes on to push outwards."""
    h = longest
    while h > 1e-7 * longest:
        drive = -side * shaking.ground(t + h * np.array([0.5, 0.75, 1.0 - 1e-12]))
        if np.all(drive > body.threshold(side)):
            return h
        h *= 0.7
    return h


def integrate(
    body: Body,
    s: Callable[[np.ndarray], np.ndarray],
    phase_end: float,
    a_g: float,
    omega_g: float,
    breaks: tuple[float, ...] = (),
    kick: float = 0.0,
) -> Answer:
    """The answer of a body to a_g s(omega_g t), 0 <= omega_g t <= phase_end.

    `s` takes an array of phases and is asked inside the pieces only; `breaks`: the phases at which it or a derivative jumps.
    `kick`: relative change of the speed after every impact, to see how much the answer depends on it.
    """
    turns = np.arange(0.0, phase_end, LONGEST)
    marks = tuple(sorted({float(m) / omega_g for m in (*turns, *breaks, phase_end) if 0.0 < m <= phase_end}))
    shaking = Shaking(s, a_g, omega_g, phase_end / omega_g, marks)
    strongest = 1.01 * max(float(np.abs(shaking.ground(m * (1.0 - 1e-13) - np.linspace(0.0, 1.0, 9)[:-1] * (m - n))).max())
                           for n, m in zip((0.0, *marks), marks, strict=False))  # fmt: skip
    t, side, y, v, peak, impacts, after, lifted = 0.0, 0, 0.0, 0.0, 0.0, 0, 0, False

    def overturned() -> Answer:
        return Answer("overturned_after_impact" if impacts + after else "overturned_no_impact", math.nan, impacts)

    while True:
        if side == 0:
            lift = _uplift(body, shaking, t)
            if lift is None:
                return Answer("rocked" if lifted else "no_uplift", peak, impacts)
            (t, side), y, v, lifted = lift, 0.0, 0.0, True
        edge, shaken = body.edge(side), t < shaking.end * (1.0 - 1e-13)
        if not shaken:
            t = shaking.end
            if (v >= 0.0 and y >= edge.alpha) or y >= 0.5 * math.pi:
                return overturned()
            if after > 2:
                return Answer("rocked", peak, impacts)
        h = LONGEST / edge.p
        if shaken:
            h = min(h, shaking.next_mark(t) - t)
            if y == v == 0.0:
                h = _stays_up(body, shaking, side, t, h)
        falling = body.acceleration(side, y, v, float(shaking.ground(np.array([t + 1e-13 * h]))[0]) if shaken else 0.0)
        if y == 0.0 and v > 0.0 and falling < 0.0:
            h = min(h, -6.0 * v / falling)
        step = _advance(body, shaking, side, (t, y, v), h)
        hit, highest = _events(step)
        while hit is not None and hit < 0.05 and step.h > 1e-13 * shaking.end:  # an early impact is better seen from nearby
            step = _advance(body, shaking, side, (t, y, v), 3.0 * max(hit, 1e-6) * step.h)
            hit, highest = _events(step)
        peak = max(peak, float(highest) / edge.alpha)
        if hit is None:
            t, y, v = step.t + step.h, step.y_end, step.v_end
            far = edge.alpha * (1.0 + strongest / body.threshold(side))  # no push brings a linear body back from there
            if (not body.nonlinear and v > 0.0 and y > far) or (body.nonlinear and y >= 0.5 * math.pi):
                return overturned()
            continue
        last = _advance(body, shaking, side, (t, y, v), hit * step.h)
        t, speed = t + last.h, -last.v_end
        if last.v_end < 0.0 and abs(last.y_end) < 1e-6 * last.h * speed:
            slope = body.acceleration(side, 0.0, -speed, float(shaking.ground(np.array([min(t, shaking.end)]))[0]) if shaken else 0.0)
            t, speed = t + last.y_end / speed, speed - slope * last.y_end / speed
        y, v = 0.0, max(0.0, abs(edge.eta) * speed * (1.0 + kick))
        side = side if body.left is None else -side
        impacts, after = (impacts + 1, after) if shaken else (impacts, after + 1)
        if _rests(body, shaking, t, v):
            side, v = 0, 0.0


def _rests(body: Body, shaking: Shaking, t: float, v: float) -> bool:
    """Whether a body that leaves the ground with this speed has come to rest: its bounces end before anything else begins."""
    edges = [body.right, *([body.left] if body.left else [])]
    slow = v / max(edge.alpha * edge.p for edge in edges)
    if v == 0.0:
        return True
    if slow > SLOW:
        return False
    loss = 1.0 - max(edge.eta**2 for edge in edges)

    def push(when: float) -> float:
        ground = float(shaking.ground(np.array([when]))[0]) if when < shaking.end else 0.0
        return max(-sense * ground / body.threshold(sense) for sense in (1, -1))

    room = 1.0 - push(t)
    if room <= 0.0:
        return False
    lasts = 4.0 * v / (min(edge.alpha * edge.p**2 for edge in edges) * loss * room) if loss > 0.0 else math.inf
    return slow < REST or (t + 2.0 * lasts < shaking.next_mark(t) and push(t + 2.0 * lasts) < 1.0)


def conditioning(
    body: Body,
    s: Callable[[np.ndarray], np.ndarray],
    phase_end: float,
    a_g: float,
    omega_g: float,
    breaks: tuple[float, ...] = (),
    delta: float = 1e-9,
) -> float:
    """Largest change of the rotation over the relative change `delta` of a_g, omega_g, p, alpha or every impact's speed.

    Infinite where one of them changes the outcome; NaN where the body overturns in all of them.
    """

    def scaled(edge: Edge | None, key: str) -> Edge | None:
        return None if edge is None else replace(edge, **{key: getattr(edge, key) * (1.0 + delta)})

    def right(key: str) -> Edge:
        return replace(body.right, **{key: getattr(body.right, key) * (1.0 + delta)})

    here = integrate(body, s, phase_end, a_g, omega_g, breaks)
    others = [
        integrate(body, s, phase_end, a_g * (1.0 + delta), omega_g, breaks),
        integrate(body, s, phase_end, a_g, omega_g * (1.0 + delta), breaks),
        integrate(body, s, phase_end, a_g, omega_g, breaks, kick=delta),
        *(integrate(replace(body, right=right(k), left=scaled(body.left, k)), s, phase_end, a_g, omega_g, breaks) for k in ("p", "alpha")),
    ]
    if any(other.outcome != here.outcome for other in others):
        return math.inf
    return max(abs(other.rotation - here.rotation) for other in others) / delta

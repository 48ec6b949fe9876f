"""An independent answer for one rocking body: u(t) = |theta| in SI units, no code of
the package.

Steps of Gauss collocation with fourteen nodes (order 28), solved by Picard iteration
and halved until the Legendre series of the acceleration has ended. Impacts, peaks and
dips are looked for on 48 points of every step's polynomial, each refined on that
polynomial, and an impact once more by a step that ends in it. The contact rules are
plain Python.

    linear      u'' = -p^2 [w (alpha - u) + s a_scale xg/g] - 2 zeta p u',
                w = 1 + zg/g
    nonlinear   u'' = -p^2 [w sin(alpha - u) + s xg/g cos(alpha - u)] - 2 zeta p u'

with p and alpha of the edge on which the body stands: right for theta > 0 (s = 1), left
for theta < 0 (s = -1).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import brentq, minimize_scalar

NODES, FINE = 14, 48
# of alpha p: bounces this slow have ended if they end before the next uplift, or in any
# case
SLOW, REST = (1e-9, 1e-12)
TOUCH = 1e-13  # of the largest u of a step: so deep a dip may be rounding
LONGEST = 0.75  # of 1/p, and of a radian of the motion's phase

_x, _w = legendre.leggauss(NODES)
_c, _weights = 0.5 * (_x + 1.0), 0.5 * _w
_analyse = (
    (np.arange(NODES)[:, None] + 0.5) * legendre.legvander(_x, NODES - 1).T * _w
)  # values at the nodes to Legendre terms
_once = (
    legendre.legint(np.eye(NODES), lbnd=-1, scl=0.5) @ _analyse
)  # and to those of the first integral
_twice = (
    legendre.legint(legendre.legint(np.eye(NODES), lbnd=-1, scl=0.5), lbnd=-1, scl=0.5)
    @ _analyse
)
FINE_PARTS = np.arange(FINE + 1) / FINE
_V, _Y = (
    legendre.legval(_x, _once).T,
    legendre.legval(_x, _twice).T,
)  # from values at the nodes to both integrals there
_V_FINE, _Y_FINE = (
    legendre.legval(2.0 * FINE_PARTS - 1.0, _once).T,
    legendre.legval(2.0 * FINE_PARTS - 1.0, _twice).T,
)
_END = _weights * (1.0 - _c)


class Shaking(NamedTuple):
    """xg and zg [m/s2] as functions of an array of t [s]; they jump, or bend, at
    `marks`, end at the last, and are asked between them.
    """

    across: Callable[[Any], Any]
    up: Callable[[Any], Any]
    marks: tuple[float, ...]

    @classmethod
    def of(
        cls,
        s: Callable,
        a_g: float,
        omega_g: float,
        breaks: Any,
        up: Callable = np.zeros_like,
    ) -> "Shaking":
        """a_g s(omega_g t), and `up` like s; breaks: the phases at which they or a
        derivative jump, and the last one.
        """
        turns = (*np.arange(LONGEST, breaks[-1], LONGEST), *breaks)
        marks = tuple(sorted({float(m) / omega_g for m in turns if m > 0.0}))
        return cls(
            lambda t: a_g * s(omega_g * t), lambda t: a_g * up(omega_g * t), marks
        )

    @property
    def end(self) -> float:
        return self.marks[-1]

    def at(self, t: Any) -> tuple[Any, Any]:
        """xg and zg; nothing after the end."""
        on = np.asarray(t) < self.end
        return np.where(on, self.across(t), 0.0), np.where(on, self.up(t), 0.0)

    def next_mark(self, t: float) -> float:
        """The end of the piece that begins at t or holds it; t's own rounding is no
        piece.
        """
        return next((m for m in self.marks if m > t + 1e-13 * self.end), math.inf)

    def changed(self, size: float = 1.0, pace: float = 1.0) -> "Shaking":
        """The same shaking so many times as strong and as fast."""
        marks = tuple(m / pace for m in self.marks)
        return Shaking(
            lambda t: size * self.across(pace * t),
            lambda t: size * self.up(pace * t),
            marks,
        )


@dataclass(frozen=True)
class Edge:
    """One edge: p [rad/s], alpha [rad], eta (speed after over before on leaving it),
    a_scale of the linear equation.
    """

    p: float
    alpha: float
    eta: float
    a_scale: float = 1.0


@dataclass
class Body:
    """Its edges; left None: it leaves the ground on its right edge only, and right.eta
    is e < 0. damping: zeta.
    """

    right: Edge
    left: Edge | None
    damping: float = 0.0
    nonlinear: bool = False
    gravity: float = 9.81

    @property
    def sides(self) -> tuple[int, ...]:
        return (1,) if self.left is None else (1, -1)

    def edge(self, side: int) -> Edge:
        return self.right if side > 0 or self.left is None else self.left

    def acceleration(self, side: int, u: Any, v: Any, across: Any, up: Any) -> Any:
        """u'' on a side."""
        edge, weight, push = (
            self.edge(side),
            1.0 + up / self.gravity,
            side * across / self.gravity,
        )
        gap = edge.alpha - u
        force = (
            -weight * np.sin(gap) - push * np.cos(gap)
            if self.nonlinear
            else -weight * gap - edge.a_scale * push
        )
        return edge.p**2 * force - 2.0 * self.damping * edge.p * v

    def excess(self, side: int, ground: tuple[Any, Any]) -> Any:
        """By how much the ground lifts the body at rest onto a side, over what holds it
        on still ground; below 0 where it does not.
        """
        return self.acceleration(side, 0.0, 0.0, *ground) / -self.acceleration(
            side, 0.0, 0.0, 0.0, 0.0
        )

    def far(self, side: int, across: Any, up: Any) -> float:
        """The rotation from which a body on its way out does not come back under ground
        motion of these sizes.
        """
        edge, weight = self.edge(side), np.maximum(1.0 + up / self.gravity, 0.025)
        return (
            0.5 * math.pi
            if self.nonlinear
            else edge.alpha
            + 1.01
            * edge.a_scale
            * float(np.max(np.abs(across) / weight))
            / self.gravity
        )

    def fallen(self, side: int, u: float, v: float) -> bool:
        """Whether it does not come back on still ground."""
        return (v >= 0.0 and u >= self.edge(side).alpha) or u >= 0.5 * math.pi

    def cut(self, side: int, step: "Step", upto: float) -> float | None:
        """The first part of a step, before `upto`, at which the acceleration gets
        another law; None without one.
        """

    def begins(self, side: int, u: float, v: float) -> None:
        """Called at the start of every step, and at the end of the shaking."""


class Answer(NamedTuple):
    """Outcome flag, max of |theta|/alpha of the side it is on (NaN where overturned),
    impacts during the shaking.
    """

    outcome: str
    rotation: float
    impacts: int


class Step(NamedTuple):
    """A step of length h from (t, u, v): the acceleration at its nodes, and the state
    at its end.
    """

    t: float
    u: float
    v: float
    h: float
    nodes: np.ndarray
    u_end: float
    v_end: float

    def height(self, part: Any) -> Any:
        return self.u + self.h * (
            part * self.v
            + self.h * legendre.legval(2.0 * part - 1.0, _twice @ self.nodes)
        )

    def speed(self, part: Any) -> Any:
        return self.v + self.h * legendre.legval(2.0 * part - 1.0, _once @ self.nodes)

    def __call__(self, t: Any) -> tuple[Any, Any]:
        """u and v at instants t of the step."""
        part = (t - self.t) / self.h
        return self.height(part), self.speed(part)


def _advance(
    body: Body,
    shaking: Shaking,
    side: int,
    state: tuple[float, float, float],
    longest: float,
) -> Step:
    """A step of at most this length on which the series of the
    acceleration has ended.
    """
    t, u, v = state
    h, scale = longest, body.edge(side).p ** 2 * body.edge(side).alpha
    while True:
        ground = shaking.at(t + h * _c)
        free = u + h * v * _c
        f = body.acceleration(side, free, v + 0.0 * _c, *ground)
        change, least = math.inf, math.inf
        for _ in range(60):
            new = body.acceleration(
                side, free + h * h * (_Y @ f), v + h * (_V @ f), *ground
            )
            change, f = float(np.abs(new - f).max()), new
            if change <= 1e-16 * scale or (
                change >= least and change < 1e-14 * (scale + np.abs(f).max())
            ):
                break
            least = min(least, change)
        tail = np.abs(_analyse[-3:] @ f).max()
        if tail < 3e-14 * (scale + np.abs(f).max()) or h < 1e-9 * longest:
            return Step(
                t,
                u,
                v,
                h,
                f,
                u + h * (v + h * float(_END @ f)),
                v + h * float(_weights @ f),
            )
        h *= 0.5


def zero(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function changes its sign, or the end at which it nearly does."""
    below, above = function(low), function(high)
    if below == 0.0 or (below > 0.0) == (above > 0.0):
        return low if abs(below) < abs(above) else high
    return float(brentq(function, low, high, xtol=1e-16, rtol=1e-15))


def _events(step: Step) -> tuple[float | None, float]:
    """(part of the step at its first impact or None, largest u before it)."""
    u = step.u + step.h * (FINE_PARTS * step.v + step.h * (_Y_FINE @ step.nodes))
    v = step.v + step.h * (_V_FINE @ step.nodes)
    u[0], v[0] = step.u, step.v
    highest = step.u
    for i in np.flatnonzero((u[1:] <= 0.0) | ((v[1:] > 0.0) != (v[:-1] > 0.0))):
        a, b = float(FINE_PARTS[i]), float(FINE_PARTS[i + 1])
        highest = max(highest, float(u[: i + 1].max()))
        hit = None
        if v[i] > 0.0 >= v[i + 1]:
            highest = max(highest, step.height(zero(step.speed, a, b)))
        if u[i + 1] <= 0.0:
            low = (
                a if i or step.u > 0.0 else 1e-9 * b
            )  # past the root at the start itself
            hit = zero(step.height, low, b) if step.height(low) > 0.0 else low
        elif v[i] < 0.0 < v[i + 1] and min(u[i], u[i + 1]) < (b - a) * step.h * max(
            -v[i], v[i + 1]
        ):
            dip = zero(step.speed, a, b)
            # A dip within rounding touches the ground without an impact.
            deep = step.height(dip) <= -TOUCH * u.max()
            hit = zero(step.height, a, dip) if deep else None
        if hit is not None:
            return hit, highest
    return None, max(highest, float(u.max()))


def _uplift(body: Body, shaking: Shaking, t: float) -> tuple[float, int] | None:
    """Instant and side of the first uplift from rest at or after t."""

    def excess(x: float, side: int) -> float:
        return float(body.excess(side, shaking.at(x)))

    while t < shaking.end * (1.0 - 1e-14):
        stop = min(shaking.next_mark(t), shaking.end)
        inset = 1e-13 * (stop - t)
        times = np.linspace(t + inset, stop - inset, 65)
        found: list[tuple[float, int]] = []
        for side in body.sides:
            over = body.excess(side, shaking.at(times))
            for i in range(times.size):
                if over[i] > 0.0:
                    found.append(
                        (
                            (
                                t
                                if i == 0
                                else brentq(
                                    excess,
                                    times[i - 1],
                                    times[i],
                                    (side,),
                                    xtol=1e-300,
                                    rtol=1e-15,
                                )
                            ),
                            side,
                        )
                    )
                    break
                # A peak between two samples that only just passes the limit.
                if (
                    0 < i < times.size - 1
                    and over[i] >= max(over[i - 1], over[i + 1])
                    and over[i] > -1e-3
                ):
                    top = minimize_scalar(
                        lambda x, side=side: -excess(x, side),
                        bounds=(times[i - 1], times[i + 1]),
                        method="bounded",
                        options={"xatol": 1e-12 * stop},
                    )
                    if top.fun < 0.0:
                        found.append(
                            (
                                brentq(
                                    excess,
                                    times[i - 1],
                                    top.x,
                                    (side,),
                                    xtol=1e-300,
                                    rtol=1e-15,
                                ),
                                side,
                            )
                        )
                        break
        if found:
            return min(found)
        t = stop
    return None


def _stays_up(
    body: Body, shaking: Shaking, side: int, t: float, longest: float
) -> float:
    """A step after an uplift no longer than the stretch on which the ground goes on to
    push outwards.
    """
    h = longest
    while h > 1e-7 * longest and not np.all(
        body.excess(side, shaking.at(t + h * np.array([0.5, 0.75, 1.0 - 1e-12]))) > 0.0
    ):
        h *= 0.7
    return h


def integrate(
    body: Body,
    shaking: Shaking,
    kick: float = 0.0,
    seen: Callable[[int, Step], None] | None = None,
    rested: Callable[[float, float], None] | None = None,
    still_impacts: int = 2,
    release: float = 0.0,
) -> Answer:
    """The answer of a body at rest, or released to the right from so many rad. kick:
    relative change of the speed after every impact; seen: called with the side and
    every step, rested: with the ends of every rest; still_impacts: to be followed after
    the shaking.
    """
    ends = np.array([0.0, *shaking.marks])
    sampled = np.concatenate(
        [
            shaking.at(ends[:-1] + part * np.diff(ends))
            for part in np.linspace(1e-9, 1.0 - 1e-9, 9)
        ],
        axis=-1,
    )
    far = {side: body.far(side, *sampled) for side in body.sides}
    t, side, u, v, peak, impacts, after, lifted = (
        0.0,
        int(release > 0.0),
        release,
        0.0,
        0.0,
        0,
        0,
        release > 0.0,
    )

    def overturned() -> Answer:
        return Answer(
            "overturned_after_impact" if impacts + after else "overturned_no_impact",
            math.nan,
            impacts,
        )

    while True:
        if side == 0:
            lift = _uplift(body, shaking, t)
            if rested is not None:
                rested(t, shaking.end if lift is None else lift[0])
            if lift is None:
                return Answer("rocked" if lifted else "no_uplift", peak, impacts)
            (t, side), u, v, lifted = lift, 0.0, 0.0, True
        edge, shaken = body.edge(side), t < shaking.end * (1.0 - 1e-13)
        body.begins(side, u, v)
        if not shaken:
            t = max(t, shaking.end)
            if body.fallen(side, u, v):
                return overturned()
            if after > still_impacts:
                return Answer("rocked", peak, impacts)
        h = LONGEST / edge.p
        if shaken:
            h = min(h, shaking.next_mark(t) - t)
            if u == v == 0.0:
                h = _stays_up(body, shaking, side, t, h)
        falling = body.acceleration(side, u, v, *shaking.at(t + 1e-13 * h))
        if u == 0.0 and v > 0.0 and falling < 0.0:
            h = min(h, -6.0 * v / falling)
        step = _advance(body, shaking, side, (t, u, v), h)
        hit, highest = _events(step)
        while (
            hit is not None and hit < 0.05 and step.h > 1e-13 * shaking.end
        ):  # an early impact is better seen from nearby
            step = _advance(
                body, shaking, side, (t, u, v), 3.0 * max(hit, 1e-6) * step.h
            )
            hit, highest = _events(step)
        part = body.cut(side, step, 1.0 if hit is None else hit)
        if part is not None:
            step = _advance(body, shaking, side, (t, u, v), part * step.h)
            hit, highest = None, _events(step)[1]
        peak = max(peak, float(highest) / edge.alpha)
        last = (
            step
            if hit is None
            else _advance(body, shaking, side, (t, u, v), hit * step.h)
        )
        if (
            hit is not None and last.h < 0.75 * hit * step.h
        ):  # it was halved, and ends before the impact
            step, hit = last, None
        if seen is not None and last.h > 0.0:
            seen(side, last)
        if hit is None:
            t, u, v = step.t + step.h, step.u_end, step.v_end
            if v > 0.0 and u > far[side]:
                return overturned()
            continue
        t, speed = t + last.h, -last.v_end
        if last.v_end < 0.0 and abs(last.u_end) < 1e-6 * last.h * speed:
            slope = body.acceleration(side, 0.0, -speed, *shaking.at(t))
            t, speed = t + last.u_end / speed, speed - slope * last.u_end / speed
        u, v = 0.0, max(0.0, abs(edge.eta) * speed * (1.0 + kick))
        side = side if body.left is None else -side
        impacts, after = (impacts + 1, after) if shaken else (impacts, after + 1)
        if _rests(body, shaking, t, v):
            side, v = 0, 0.0


def _rests(body: Body, shaking: Shaking, t: float, v: float) -> bool:
    """Whether a body that leaves the ground with this speed has come to rest: its
    bounces end before anything else begins.
    """
    edges = [body.edge(side) for side in body.sides]
    slow = v / max(edge.alpha * edge.p for edge in edges)
    if v == 0.0 or slow > SLOW:
        return v == 0.0
    loss = 1.0 - max(edge.eta**2 for edge in edges)

    def room(when: float) -> float:
        return -float(max(body.excess(side, shaking.at(when)) for side in body.sides))

    if room(t) <= 0.0:
        return False
    lasts = (
        4.0 * v / (min(edge.alpha * edge.p**2 for edge in edges) * loss * room(t))
        if loss > 0.0
        else math.inf
    )
    return slow < REST or (
        t + 2.0 * lasts < shaking.next_mark(t) and room(t + 2.0 * lasts) > 0.0
    )


def conditioning(body: Body, shaking: Shaking, delta: float = 1e-9) -> float:
    """Largest change of the rotation over the relative change `delta` of a_g, omega_g,
    p, alpha or every impact's speed.

    Infinite where one of them changes the outcome; NaN where the body overturns in all
    of them.
    """

    def other(key: str) -> Body:
        edges = (
            edge and replace(edge, **{key: getattr(edge, key) * (1.0 + delta)})
            for edge in (body.right, body.left)
        )
        return replace(body, **dict(zip(("right", "left"), edges, strict=True)))

    here = integrate(body, shaking)
    others = [
        integrate(body, shaking.changed(size=1.0 + delta)),
        integrate(body, shaking.changed(pace=1.0 + delta)),
    ]
    others += [
        integrate(body, shaking, kick=delta),
        integrate(other("p"), shaking),
        integrate(other("alpha"), shaking),
    ]
    if any(answer.outcome != here.outcome for answer in others):
        return math.inf
    return max(abs(answer.rotation - here.rotation) for answer in others) / delta

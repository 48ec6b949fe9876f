"""Sliding of a body that its friction keeps from rocking.

With a static friction mu_s below lambda of the edge that would lift, a body never
rocks: in every state of contact |F| <= mu_s N and N >= 0. To leave on an edge at the
distance d from its mass centre, whose height is h, all of N acts there, so that

    I_G theta'' = |F| h - N d <= N h (mu_s - d/h) <= 0.

A vertical motion scales F and N alike. The body sticks or slides as a whole, with the
displacement u over the ground, positive with +x_g, and the weight N/m = g + z_g'':

    it sticks while |x_g''| <= mu_s N/m
    it slides by u'' = -x_g'' - s mu_k N/m,  s = sgn u'
    where u' = 0 it sticks if |x_g''| <= mu_s N/m, else it leaves with s = -sgn x_g''
    it loses contact at the first N <= 0

In the direction s, with y = s u' >= 0, phases as time, x_g'' and z_g'' over a_g and
rho = g/a_g, this is y' = q(mu_k) - mu_k rho with q(mu) = -s x_g'' - mu z_g'', and a
slide begins at the first q(mu_s) > mu_s rho. The segments of q are monotone, so that y
is convex or concave on each, and its first root is known: of a quadratic under straight
lines, else bracketed. Stops never accumulate: after a stop the body sticks, or it
leaves with an acceleration |x_g''| - mu_k N/m > 0.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..motions.biaxial import combined
from ..motions.motion import Motion
from ..structures.friction import Friction
from .outcome import Outcome

_BLOCK = 64  # segments of a slide that are summed at a time, at first


@dataclass(frozen=True)
class SlideDrive:
    """q = -s x_g'' - mu z_g'' on its K monotone segments, over a_g."""

    start: Array  # phase at the start [rad], (K,)
    length: Array  # [rad], (K,)
    q_start: Array  # q at the start, inside the segment [-], (K,)
    q_end: Array  # q at the end, inside the segment [-], (K,)
    slope: Array  # of the linear term [1/rad], (K,)
    sin: Array  # sine of each sinusoid at the start, times its size [-], (H, K)
    cos: Array  # cosine of each sinusoid at the start, times its size [-], (H, K)
    frequency: Array  # of each sinusoid over omega_g [-], (H, K)

    @classmethod
    def of(cls, motion: Motion, side: float, mu: float) -> SlideDrive:
        """Return q of a motion for slides of the sign `side` and a friction mu."""
        lines = motion if motion.vertical is None else combined(motion, side * mu)
        found = lines.segments
        return cls(
            found.start,
            found.length,
            -side * found.s_start,
            -side * found.s_end,
            -side * found.slope,
            -side * found.sin,
            -side * found.cos,
            found.frequency,
        )

    @property
    def end(self) -> float:
        """The phase at the end of the motion [rad]."""
        return float(self.start[-1] + self.length[-1])

    @cached_property
    def highest(self) -> Array:
        """The largest q of each segment, (K,)."""
        return np.maximum(self.q_start, self.q_end)

    @property
    def straight(self) -> bool:
        """True if q has straight lines only."""
        return not len(self.sin)

    @cached_property
    def speeds(self) -> Array:
        """The integral of q up to each end of a segment, from 0, (K + 1,)."""
        k = np.arange(len(self.start))
        return np.append(0.0, np.cumsum(self.speed(k, self.length)))

    @cached_property
    def paths(self) -> Array:
        """The integral of `speeds` up to each end of a segment, from 0, (K + 1,)."""
        k = np.arange(len(self.start))
        own = self.speeds[:-1] * self.length + self.path(k, self.length)
        return np.append(0.0, np.cumsum(own))

    @cached_property
    def _floats(self) -> tuple[list[float], ...]:
        """start, length, q_start, q_end and slope, whose items are read fast."""
        arrays = self.start, self.length, self.q_start, self.q_end, self.slope
        return tuple(one.tolist() for one in arrays)

    def at(self, phase: float) -> tuple[int, float]:
        """Return (the segment that holds a phase, the phase from its start [rad]); at
        a jump the later one; K after the end.
        """
        start, length, *_ = self._floats
        k = bisect_right(start, phase) - 1
        u = phase - start[k]
        return (k + 1, 0.0) if u >= length[k] else (k, u)

    def value_at(self, k: int, u: float) -> float:
        """Return `value` of one phase."""
        if not self.straight:
            return float(self.value(k, u))
        _, _, q_start, _, slope = self._floats
        return q_start[k] + slope[k] * u

    def value(self, k: Any, u: Any) -> Any:
        """Return q at a phase u from the start of segment k."""
        total = self.q_start[k] + self.slope[k] * u
        for sin, cos, w in self._waves(k):
            total = total + sin * (np.cos(w * u) - 1.0) + cos * np.sin(w * u)
        return total

    def speed(self, k: Any, u: Any) -> Any:
        """Return the integral of q from the start of segment k to u."""
        total = self.q_start[k] * u + 0.5 * self.slope[k] * u * u
        for sin, cos, w in self._waves(k):
            x = w * u
            total = total + sin * (np.sin(x) - x) / w + cos * _versine(x) / w
        return total

    def path(self, k: Any, u: Any) -> Any:
        """Return the integral of `speed` from the start of segment k to u."""
        total = u * u * (0.5 * self.q_start[k] + self.slope[k] * u / 6.0)
        for sin, cos, w in self._waves(k):
            x, square = w * u, w * w
            total = total + sin * (_versine(x) - 0.5 * x * x) / square
            total = total + cos * (x - np.sin(x)) / square
        return total

    def _waves(self, k: Any) -> Iterator[tuple[Any, Any, Any]]:
        for sin, cos, w in zip(self.sin, self.cos, self.frequency, strict=True):
            yield sin[k], cos[k], w[k]

    def crossing(self, k: int, level: float, low: float) -> float:
        """Return the phase from the start of segment k, from `low` on, at which q is at
        a level that it crosses there.
        """
        if self.straight:
            _, _, q_start, _, slope = self._floats
            return max(low, (level - q_start[k]) / slope[k])
        high = float(self.length[k])
        ends = (self.value_at(k, low) - level, self.value_at(k, high) - level)
        if ends[0] * ends[1] > 0.0:  # rounding at an end
            return low if abs(ends[0]) < abs(ends[1]) else high
        return _root(lambda u: self.value_at(k, u) - level, low, high)

    def loud(self, level: float) -> list[int]:
        """Return the segments in which q exceeds a level."""
        found: list[int] = np.flatnonzero(self.highest > level).tolist()
        return found

    def next_above(self, level: float, phase: float, loud: list[int]) -> float:
        """Return the first phase from `phase` on after which q > level, infinite
        without one; loud: the result of `loud`.
        """
        start, _, q_start, q_end, _ = self._floats
        k, u = self.at(phase)
        i = bisect_left(loud, k)
        if i == len(loud):
            return math.inf
        if loud[i] == k:
            if self.value_at(k, u) > level:
                return phase
            if q_end[k] > level:
                return start[k] + self.crossing(k, level, u)
            i += 1  # it falls
            if i == len(loud):
                return math.inf
        k = loud[i]
        return start[k] + (0.0 if q_start[k] > level else self.crossing(k, level, 0.0))


def _versine(x: Any) -> Any:
    """Return 1 - cos x without cancellation."""
    return 2.0 * np.sin(0.5 * x) ** 2


def _root(function: Any, low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=1e-300, rtol=1e-15))


@dataclass(frozen=True)
class Slip:
    """One slide from rest to rest; lengths in a_g/omega_g^2, speeds in a_g/omega_g."""

    start: float  # phase [rad]
    stop: float  # phase [rad]
    side: float  # sign of u'
    begins: float  # u at its start
    ends: float  # u at its stop


@dataclass(frozen=True, eq=False)
class Sliding:
    """The slides of a body under a motion of one amplitude, in phases; lengths in
    a_g/omega_g^2, speeds in a_g/omega_g.
    """

    base: Base  # motion and friction
    ratio: float  # g/a_g [-]
    slides: tuple[Slip, ...]  # in their order
    # phase at which the ground falls away, where the slides end [rad]; infinite: never
    lost: float

    @property
    def outcome(self) -> Outcome:
        """Lost contact, slid, or no uplift for a body that sticks."""
        if self.lost < math.inf:
            return Outcome.LOST_CONTACT
        return Outcome.SLID if self.slides else Outcome.NO_UPLIFT

    @property
    def largest(self) -> float:
        """max |u|, which stands at a stop."""
        return max((abs(one.ends) for one in self.slides), default=0.0)

    @property
    def residual(self) -> float:
        """u at the end."""
        return self.slides[-1].ends if self.slides else 0.0

    @property
    def speed(self) -> float:
        """max |u'|."""
        return max(map(self.speed_of, self.slides), default=0.0)

    def speed_of(self, one: Slip) -> float:
        """Return max |u'| of a slide."""
        return self.base.course_of(one, self.ratio).fastest(one.stop)

    @property
    def least_weight(self) -> float:
        """min N/(m g) during the motion [-]."""
        return self.base.least_weight(self.ratio)

    def course(self, phase: Array) -> tuple[Array, Array]:
        """Return (u, u') at rising phases [rad], (n,) each."""
        u, v = np.zeros(phase.shape), np.zeros(phase.shape)
        for one in self.slides:
            first, last = np.searchsorted(phase, (one.start, one.stop))
            u[last:] = one.ends
            if last > first:
                course = self.base.course_of(one, self.ratio)
                path, speed = course.at(phase[first:last])
                u[first:last] = one.begins + one.side * path
                v[first:last] = one.side * speed
        return u, v


@dataclass(frozen=True, eq=False)
class Base:
    """The base of a body under a motion; its slides depend on g/a_g alone."""

    motion: Motion  # with its vertical motion
    friction: Friction  # of the base

    @cached_property
    def _drives(
        self,
    ) -> tuple[tuple[SlideDrive, SlideDrive], tuple[SlideDrive, SlideDrive]]:
        """q to the right and to the left, with the static and with the kinetic
        coefficient.
        """
        mu, same = self.friction, self.motion.vertical is None
        static = self._both_ways(mu.static)
        if same or mu.static == mu.kinetic:
            return static, static
        return static, self._both_ways(mu.kinetic)

    def _both_ways(self, mu: float) -> tuple[SlideDrive, SlideDrive]:
        """Return q to the right and to the left with one coefficient."""
        right, left = (SlideDrive.of(self.motion, side, mu) for side in (1.0, -1.0))
        return right, left

    @cached_property
    def _weight(self) -> SlideDrive | None:
        """-z_g'' over a_g; None without a vertical motion."""
        up = self.motion.vertical
        return None if up is None else SlideDrive.of(up, 1.0, 0.0)

    def under(self, ratio: float) -> Sliding:
        """Return the slides for g/a_g = ratio (infinite for ground at rest)."""
        if not ratio < math.inf:
            return Sliding(self, ratio, (), math.inf)
        lost = self._loss(ratio)
        static, kinetic = self._drives
        least, level = self.friction.static * ratio, self.friction.kinetic * ratio
        loud = [drive.loud(least) for drive in static]
        found: list[Slip] = []
        phase, u = 0.0, 0.0
        while True:
            right, left = (
                drive.next_above(least, phase, some)
                for drive, some in zip(static, loud, strict=True)
            )
            start = min(right, left)
            if not start < lost:
                break
            side = -1.0 if left < right else 1.0
            course = _Course.of(kinetic[side < 0.0], level, start)
            stop = min(course.stop(), lost)
            if stop > start:
                ends = u + side * float(course.at(np.array(stop))[0])
                found.append(Slip(start, stop, side, u, ends))
                u = ends
            phase = stop if stop > start else math.nextafter(start, math.inf)
        return Sliding(self, ratio, tuple(found), lost)

    def _loss(self, ratio: float) -> float:
        """Return the first phase at which g + z_g'' is not positive, infinite without
        one.
        """
        weight = self._weight
        if weight is None:
            return math.inf
        light = np.flatnonzero(weight.highest >= ratio)
        if not light.size:
            return math.inf
        k = int(light[0])
        if weight.q_start[k] >= ratio:
            return float(weight.start[k])
        return float(weight.start[k]) + weight.crossing(k, ratio, 0.0)

    def least_weight(self, ratio: float) -> float:
        """Return min (g + z_g'')/g for g/a_g = ratio."""
        weight = self._weight
        highest = 0.0 if weight is None else max(0.0, float(weight.highest.max()))
        return 1.0 - highest / ratio

    def course_of(self, one: Slip, ratio: float) -> _Course:
        """Return the course of a slide."""
        drive = self._drives[1][one.side < 0.0]
        return _Course.of(drive, self.friction.kinetic * ratio, one.start)


class _Course(NamedTuple):
    """The speed y and the path of a slide that begins at a phase."""

    drive: SlideDrive  # q
    level: float  # mu_k g/a_g [-]
    start: float  # phase at which it begins [rad]
    k: int  # the segment in which it begins
    u: float  # its phase there from the start of the segment [rad]
    speed: float  # integral of q up to there
    path: float  # integral of the integral of q up to there

    @classmethod
    def of(cls, drive: SlideDrive, level: float, start: float) -> _Course:
        """Return the course from a phase [rad] on."""
        k, u = drive.at(start)
        speed = drive.speeds[k] + drive.speed(k, u)
        path = drive.paths[k] + drive.speeds[k] * u + drive.path(k, u)
        return cls(drive, level, start, k, u, float(speed), float(path))

    def at(self, phase: Array) -> tuple[Array, Array]:
        """Return (path, y) at phases [rad] before the stop."""
        drive, count = self.drive, len(self.drive.start)
        inside = np.minimum(phase, drive.end)
        k = np.searchsorted(drive.start, inside, side="right") - 1
        k = np.clip(k, self.k, count - 1)
        u, since = inside - drive.start[k], inside - self.start
        speed = drive.speeds[k] + drive.speed(k, u)
        y = speed - self.speed - self.level * since
        path = drive.paths[k] + drive.speeds[k] * u + drive.path(k, u) - self.path
        path = path - since * (self.speed + 0.5 * self.level * since)
        after = phase - inside  # on still ground
        path = path + after * (y - 0.5 * self.level * after)
        return path, np.maximum(y - self.level * after, 0.0)

    def ends(self, first: int, last: int) -> Array:
        """Return y at the ends of the segments from `first` to before `last`."""
        drive = self.drive
        since = drive.start[first:last] + drive.length[first:last] - self.start
        return drive.speeds[first + 1 : last + 1] - self.speed - self.level * since

    def stop(self) -> float:
        """Return the phase at which the body stops [rad]."""
        drive, level, count = self.drive, self.level, len(self.drive.start)
        k, u, y, size = self.k, self.u, 0.0, _BLOCK
        while k < count:
            ends = self.ends(k, min(count, k + size))
            some = slice(k, k + ends.size)
            # y may reach 0 at the end of a segment, or in a dip between positive ends
            dips = (drive.q_start[some] < level) & (drive.q_end[some] > level)
            for i in np.flatnonzero((ends <= 0.0) | dips).tolist():
                begins = (float(ends[i - 1]), 0.0) if i else (y, u)
                root = _first_root(drive, level, k + i, begins[1], begins[0])
                if root is None and ends[i] <= 0.0:
                    root = float(drive.length[k + i])  # within rounding
                if root is not None:
                    return float(drive.start[k + i]) + root
            y, k, u, size = float(ends[-1]), k + ends.size, 0.0, 2 * size
        return drive.end + y / level  # on still ground

    def fastest(self, end: float) -> float:
        """Return the largest y up to a phase [rad]."""
        drive, level = self.drive, self.level
        last = min(drive.at(end)[0] + 1, len(drive.start))
        some = slice(self.k, last)
        falls = (drive.q_start[some] > level) & (drive.q_end[some] < level)
        tops = [
            drive.start[k] + drive.crossing(k, level, self.u if k == self.k else 0.0)
            for k in (np.flatnonzero(falls) + self.k).tolist()
        ]
        places = np.concatenate([drive.start[some], tops, [end, drive.end]])
        places = np.clip(places, self.start, end)
        return float(self.at(places)[1].max())


def _first_root(
    drive: SlideDrive, level: float, k: int, low: float, y: float
) -> float | None:
    """Return the first phase after `low` in segment k at which a speed of y at `low` is
    down to 0, None if it stays positive.
    """
    a, high = drive.value_at(k, low) - level, float(drive.length[k])
    if y == 0.0:
        a = max(a, 0.0)  # the root at the start is deflated
    if drive.straight:
        u = _first_root_of_quadratic(0.5 * float(drive.slope[k]), a, y)
        return low + u if u <= high - low else None
    base = float(drive.speed(k, low))

    def speed(u: float) -> float:
        return y + float(drive.speed(k, u)) - base - level * (u - low)

    begin, end = low, high
    falls, rises = float(drive.q_end[k]) < level, a < 0.0
    if rises and not falls:  # y is convex: its least value is inside
        end = drive.crossing(k, level, low)
    elif a >= 0.0 and falls:  # y is concave: it rises first
        begin = drive.crossing(k, level, low)
    elif not rises:
        return None
    if speed(end) > 0.0:
        return None
    return begin if speed(begin) <= 0.0 else _root(speed, begin, end)


def _first_root_of_quadratic(b: float, a: float, y: float) -> float:
    """Return the least positive root of y + a u + b u^2, y >= 0; of y = 0 the other one
    than 0; infinite without one.
    """
    if y == 0.0:
        return -a / b if b < 0.0 else math.inf
    square = a * a - 4.0 * b * y
    if square < 0.0:
        return math.inf
    q = -0.5 * (a + math.copysign(math.sqrt(square), a))
    roots = [y / q] if q else []
    roots += [q / b] if b else []
    return min((u for u in roots if u > 0.0), default=math.inf)

"""Amplitudes at which one impact falls into the second push of a motion: stretches of them in which the outcome cannot change.

For the undamped linear oscillator on equal edges, under a motion that pushes one way and then the other, each push swelling and fading
once, and that lifts the body at once at any amplitude. From uplift at psi on the first arc is y = A J - K (Lemma 10), so that the time t
of its first impact grows with A, while psi and the onset of the second ridge (A |s| = 1) fall. With c where s changes its sign, T the end
of the shaking, p = |s| and times in tau, the speed at the impact and what the second arc has left of its unstable mode there are

    V = 1 - exp(psi - t) + A (N - exp(c - t) M),     M = int exp(u - c) s du from psi to c,     N = int exp(u - t) p du from c to t
    f = eta V - 1 + A G,                             G = int exp(t - u) p du from t to T

An impact on the second ridge or after it is the last before T where y(T) > 0, and so where f > 0 (Lemmas 1 and 2). With f > 0 the body
overturns; with f < 0 and y(T) > 0 it does not, for then its energy at T is below 1, nor with eta V + A int p du < 1 (Lemma 9), whatever
comes. Over a stretch of amplitudes t, psi and all these integrals lie between bounds that follow from their values at both ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from ..dynamics.contacts.contact import first_uplift
from ..dynamics.drive import crossing
from ..dynamics.impulse import ImpulseAhead
from ..motions.segments import Segments
from .one_arc import bounded_response

Array = np.ndarray

_NEAR = 1e-7  # rad within which an impact is known
_SLACK = 1e-6  # of bounds, for that and for rounding
_ROUNDING = 1e-13  # of the terms that modes are summed from
_ROUNDS = 40  # in which halves alone come to less than that
_MOST = 16  # segments, each of which is gone through for every lane


class Strike(NamedTuple):
    """The first impact at an amplitude: tau of uplift and impact, M, N, G, int exp(u - T) p du and int p du from the impact to T, whether
    the second push has a ridge, and whether the impact lies on it or after it and before T; arrays of one shape."""

    lift: Array
    time: Array
    first: Array
    second: Array
    ahead: Array
    faded: Array
    impulse: Array
    ridge: Array
    clear: Array


class Bounds(NamedTuple):
    """Of eta V, of f, and the least y(T), over a stretch of amplitudes."""

    slowest: Array
    fastest: Array
    least: Array
    most: Array
    height: Array


@dataclass(frozen=True)
class TwoPushes:
    """A motion that pushes one way and then the other; k, u: where s changes its sign."""

    segments: Segments
    k: int
    u: float

    @classmethod
    def of(cls, segments: Segments) -> Self | None:
        """None for a motion of another kind."""
        if segments.straight or len(segments) > _MOST or segments.pushes != 2:
            return None
        sizes = np.column_stack([segments.s_start, segments.s_end]).ravel()
        for push in (sizes[sizes > 0.0], -sizes[sizes < 0.0]):
            turns = np.sign(np.diff(push))
            if np.any(np.diff(turns[turns != 0.0]) > 0.0):  # fades, and swells again
                return None
        begins = np.sign(sizes[np.flatnonzero(sizes)[0]])
        k = int(np.flatnonzero(begins * segments.s_end < 0.0)[0])
        inside = begins * segments.s_start[k] > 0.0
        return cls(segments, k, float(crossing(segments, np.array([k]), np.zeros(1))[0]) if inside else 0.0)

    @cached_property
    def impulse(self) -> ImpulseAhead:
        """int |s| dphi to come."""
        return ImpulseAhead.of(self.segments)

    @property
    def end(self) -> float:
        """Phase of T [rad]."""
        return float(self.segments.start[-1] + self.segments.length[-1])

    @property
    def turn(self) -> float:
        """Phase of c [rad]."""
        return float(self.segments.start[self.k] + self.u)

    def segment_of(self, phase: Array) -> Array:
        """The segments that hold these phases, or the nearest."""
        return np.clip(np.searchsorted(self.segments.start, phase, side="right") - 1, 0, len(self.segments) - 1)

    def late(self, amplitude: Array, omega: Array) -> Array:
        """Whether the first impact of bodies that this motion lifts comes on the second ridge or after it and before T; (lanes,)."""
        with np.errstate(all="ignore"):
            return _Arc.of(self, amplitude, omega).late()[2]

    def strikes(self, amplitude: Array, omega: Array) -> Strike:
        """The first impacts of these bodies; amplitude, omega: (lanes,)."""
        with np.errstate(all="ignore"):
            return _Arc.of(self, amplitude, omega).strikes()

    def between(self, one: Strike, other: Strike, low: Array, high: Array, omega: Array, eta: float) -> Bounds:
        """Bounds over all amplitudes from `low` to `high`, of which these are the impacts; (lanes,)."""
        end, turn = self.end / omega, self.turn / omega
        slack = _SLACK * (1.0 + high) * (1.0 + 1.0 / omega)
        with np.errstate(over="ignore", invalid="ignore"):
            later, pushed = np.exp(other.time - one.time), one.impulse - other.impulse
            fastest = 1.0 - np.exp(other.lift - other.time) + high * (one.second + pushed) - low * np.exp(turn - other.time) * one.first
            slowest = 1.0 - np.exp(one.lift - one.time) + low * one.second / later - high * np.exp(turn - one.time) * other.first
            fastest, slowest = eta * (fastest + slack), eta * np.maximum(slowest - slack, 0.0)
            most = fastest - 1.0 + high * np.minimum(later * one.ahead, other.ahead + pushed)
            least = slowest - 1.0 + low * np.maximum(other.ahead / later, one.ahead - pushed)
            left = end - one.time, end - other.time
            height = np.minimum.reduce([slowest * np.sinh(h) - 2.0 * np.sinh(0.5 * h) ** 2 for h in left])  # it rises, and then falls
            height += low * 0.5 * (np.exp(left[1]) * other.ahead - other.faded)  # int sinh(T - u) p du from the later impact on
            return Bounds(slowest, fastest, least - slack, most + slack, height - slack * np.exp(left[0]))

    def may_change(self, one: Strike, other: Strike, low: Array, high: Array, omega: Array, eta: float) -> Array:
        """Whether the outcome may differ anywhere between; (lanes,)."""
        bounds = self.between(one, other, low, high, omega, eta)
        stays = (bounds.most < 0.0) & (bounds.height > 0.0)
        stays |= bounds.fastest + high * one.impulse < 1.0
        return ~(one.clear & other.clear & (one.ridge | ~other.ridge) & (stays | (bounds.least > 0.0)))


class _Arc(NamedTuple):
    """The first arc of each lane, as if nothing struck it: phase of its uplift; where each segment begins (the first: at uplift), and at T,
    its modes z = y - 1 + v and x = v + 1 - y, and the bounded responses to s; (segments + 1, lanes)."""

    pushes: TwoPushes
    amplitude: Array
    omega: Array
    outwards: Array
    lift: Array
    z: Array
    x: Array
    z_response: Array
    x_response: Array

    @classmethod
    def of(cls, pushes: TwoPushes, amplitude: Array, omega: Array) -> _Arc:
        segments, lanes = pushes.segments, amplitude.size
        first = first_uplift(segments, np.zeros(lanes, dtype=np.int64), np.zeros(lanes), amplitude, amplitude)
        shape = len(segments) + 1, lanes
        z, x, z_response, x_response = (np.empty(shape) for _ in range(4))
        z[0], x[0], begin = -1.0, 1.0, first.u
        for k in range(len(segments)):
            at = np.full(lanes, k)
            grows, push = np.exp((segments.length[k] - begin) / omega), -first.side * amplitude
            for modes, responses, sense, growth in ((z, z_response, 1.0, grows), (x, x_response, -1.0, 1.0 / grows)):
                responses[k] = bounded_response(segments, at, begin, omega, sense)
                there = bounded_response(segments, at, segments.length[at], omega, sense)
                modes[k + 1] = growth * modes[k] + push * (there - growth * responses[k])
            begin = np.zeros(lanes)
        return cls(pushes, amplitude, omega, -first.side, first.u, z, x, z_response, x_response)

    def at(self, phase: Array) -> tuple[Array, Array]:
        """z and x there."""
        segments, lanes = self.pushes.segments, np.arange(phase.size)
        k = self.pushes.segment_of(phase)
        u = phase - segments.start[k]
        growth, push = np.exp((u - np.where(k == 0, self.lift, 0.0)) / self.omega), self.outwards * self.amplitude
        kinds = ((self.z, self.z_response, 1.0, growth), (self.x, self.x_response, -1.0, 1.0 / growth))
        z, x = (
            g * modes[k, lanes] + push * (bounded_response(segments, k, u, self.omega, sense) - g * responses[k, lanes])
            for modes, responses, sense, g in kinds
        )
        return z, x

    def height(self, phase: Array) -> Array:
        """y there."""
        z, x = self.at(phase)
        return 1.0 + 0.5 * (z - x)

    def strikes(self) -> Strike:
        """Of each lane; where there is none it is not clear."""
        pushes, omega, amplitude, lift = self.pushes, self.omega, self.amplitude, self.lift
        low, ridge, clear, noise = self.late()
        high = np.full(low.size, pushes.end)
        at = np.flatnonzero(clear)
        phase = high.copy()
        phase[at] = self.take(at)._impact(low[at], high[at])
        clear &= (self.height(phase - _NEAR) > noise) & (self.height(phase + _NEAR) < -noise)
        z, x = self.at(phase)
        turn = np.full(low.size, pushes.turn)
        faded, first, whole = (  # int exp(u - there) s du from uplift to the impact, to c and to T
            (mode - np.exp((lift - there) / omega)) / amplitude
            for mode, there in ((x, phase), (self.at(turn)[1], turn), (self.x[-1], high))
        )
        left = np.exp((phase - high) / omega)
        k = pushes.segment_of(phase)
        return Strike(
            lift / omega, phase / omega, first, np.exp((turn - phase) / omega) * first - faded,
            (z - left * self.z[-1]) / amplitude, left * faded - whole,
            pushes.impulse.after(k, phase - pushes.segments.start[k]) / omega, ridge, clear,
        )  # fmt: skip

    def take(self, at: Array) -> _Arc:
        """Some of the lanes."""
        return _Arc(self.pushes, *(x.take(at, axis=-1) for x in self[1:]))

    def late(self) -> tuple[Array, Array, Array, Array]:
        """(phase from which the second push could lift the body, or at which it begins where it never could; whether it could; whether the
        first impact lies between that and T; bounds of what rounding does to y)."""
        pushes, segments, lanes = self.pushes, self.pushes.segments, self.omega.size
        onset = first_uplift(segments, np.full(lanes, pushes.k), np.full(lanes, pushes.u), self.amplitude, self.amplitude)
        ridge = onset.k < len(segments)
        low = np.where(ridge, segments.start[np.minimum(onset.k, len(segments) - 1)] + onset.u, pushes.turn)
        noise = _ROUNDING * (1.0 + self.amplitude) * np.exp((pushes.end - self.lift) / self.omega)
        clear = (noise < _NEAR) & (self.height(low) > noise) & (1.0 + 0.5 * (self.z[-1] - self.x[-1]) < -noise)
        return low, ridge, clear, noise

    def _impact(self, low: Array, high: Array) -> Array:
        """The phase between these at which y falls through 0, by Newton's method in a bracket that only shrinks."""
        phase, low, high = 0.5 * (low + high), low.copy(), high.copy()
        for _ in range(_ROUNDS):
            z, x = self.at(phase)
            y, v = 1.0 + 0.5 * (z - x), 0.5 * (z + x)
            low, high = np.where(y > 0.0, phase, low), np.where(y > 0.0, high, phase)
            target = phase - y / v * self.omega
            target = np.where((target >= low) & (target <= high), target, 0.5 * (low + high))
            moved, phase = np.abs(target - phase), target
            if np.all(moved < 0.1 * _NEAR):
                break
        return phase

"""A second, slower way to the same answer, for checking: Taylor series in small steps.

It shares nothing with the exact flow: no closed form, no windows, no mode analysis during the shaking. Each step sums the
series of the drive and of y'' = y - 1 + a by its recurrence, looks for impacts and peaks by sign changes on eighths of
the step, for dips by those of the speed, and polishes them on the polynomial. Steps are a quarter radian of the fastest motion, or
four bounces, 18 terms: the truncation error is below rounding. Two turns within an eighth of a step would be missed; the engine's own
proofs are what excludes that, and a disagreement shows in the check. The nonlinear equations, whose engine is a Taylor series itself,
and bodies with damping or unlike sides are checked by a Runge-Kutta method instead (`general_solver`).
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ...motions.motion import Motion
from ...motions.piece import Piece
from ..outcome import Outcome
from .contact_check import Arm, lets_go
from .uplift import lies_still, next_uplift

Series = list[float]  # coefficients of the powers from 0

TERMS = 18
_MARKS = tuple(i / 8.0 for i in range(9))
_SAMPLES = _MARKS[1:]
_MAX_STEPS, _A_SEGMENT = 10_000, 100  # a cell that takes more, and these for each segment of the motion, is not checked: about a second
_AT_REST = 1e-11


def reference_cell(motion: Motion, amplitude: float, omega: float, eta: float, arm: Arm | None = None) -> tuple[Outcome, float]:
    """(outcome, max |theta|/alpha, NaN where overturned) of one linear cell by Taylor series; FAILED if it takes too long. arm: of a rigid
    body, which loses contact where its Fz is not positive."""
    with np.errstate(all="ignore"):
        try:
            return _Body(motion, float(amplitude), float(omega), float(eta), arm).run()
        except (OverflowError, ValueError):  # numbers beyond what a power series of doubles can hold
            return Outcome.FAILED, math.nan


class _Body:
    def __init__(self, motion: Motion, amplitude: float, omega: float, eta: float, arm: Arm | None) -> None:
        self.arm, self.let_go = arm, False
        self.pieces, self.amplitude, self.omega, self.eta = motion.pieces, amplitude, omega, eta
        self.most_steps = _MAX_STEPS + _A_SEGMENT * len(motion.segments)
        fastest = 0.0 if motion.segments.straight else max(h.frequency for p in motion.pieces for h in p.harmonics)
        self.stride = 0.25 / max(1.0, omega * fastest)
        self.y = self.v = self.peak = 0.0
        self.side = 0
        self.bounced = False

    def run(self) -> tuple[Outcome, float]:
        steps = 0
        for piece in self.pieces:
            if self.side == 0 and lies_still(piece, self.amplitude, self.amplitude):
                continue
            phase, y_end = piece.start, (piece.stop - piece.start) / self.omega
            time = 0.0
            while y_end - time > 1e-14 * y_end:
                steps += 1
                if steps > self.most_steps:
                    return Outcome.FAILED, math.nan
                if self.side == 0:
                    lift = next_uplift(piece, phase + self.omega * time, self.amplitude, self.amplitude)
                    if lift is None:
                        break
                    time, self.side = max(time, (lift[0] - phase) / self.omega), lift[1]
                    self.y = self.v = 0.0
                time += self.step(piece, phase + self.omega * time, min(self.stride, y_end - time))
                if self.side and self.y - 1.0 + self.v > 1e3 * (1.0 + self.amplitude):
                    return self.overturned(), math.nan
        return self.still()

    def step(self, piece: Piece, phase: float, length: float) -> float:
        """Go on by `length` or to the first event; returns the time that passed."""
        force = -1.0 - self.side * self.amplitude * float(piece.value(phase))
        if self.y == 0.0 < self.v and force < 0.0:  # a bounce of 2 v / |force| must not hide between two samples
            length = min(length, 8.0 * self.v / -force)
        series = self.series(piece, phase, length)
        speed = _derivative(series)
        reach = _first_below(series, speed)
        stop = 1.0 if reach is None else _polish(series, *reach)
        self.look_for_peaks(series, speed, stop)
        self.press(series, speed, stop, length)
        self.y, self.v = _value(series, stop), _value(speed, stop) / length
        if reach is not None:
            self.bounced = True
            self.side, self.y, self.v = -self.side, 0.0, -self.eta * self.v
            outward = -self.side * self.amplitude * float(piece.value(phase + self.omega * stop * length))
            if self.v <= 0.0 or (self.v < _AT_REST and abs(outward) < 1.0 and self.eta < 1.0):
                self.side, self.v = 0, 0.0
        return stop * length

    def series(self, piece: Piece, phase: float, length: float) -> Series:
        """Coefficients of y in powers of (time / length)."""
        drive = [0.0] * TERMS
        drive[0] = piece.constant + piece.slope * (phase - piece.start)
        drive[1] = piece.slope * self.omega * length
        for h in piece.harmonics:
            argument, x = h.frequency * phase + h.phase, h.frequency * self.omega * length
            turn = (math.sin(argument), math.cos(argument), -math.sin(argument), -math.cos(argument))
            factor = h.amplitude
            for n in range(TERMS):
                drive[n] += factor * turn[n % 4]
                factor *= x / (n + 1)
        outward = -self.side * self.amplitude
        drive = [outward * x for x in drive]
        drive[0] -= 1.0
        y = [self.y, self.v * length]
        for n in range(TERMS):
            y.append((y[n] + drive[n]) * length * length / ((n + 1) * (n + 2)))
        return y

    def look_for_peaks(self, series: Series, speed: Series, stop: float) -> None:
        marks = [0.0, *(x for x in _SAMPLES if x < stop), stop]
        rates = [_value(speed, x) for x in marks]
        if self.y == self.v == 0.0:  # just lifted off: rising, though its speed is still nothing
            rates[0] = 1.0
        for i in range(len(marks) - 1):
            if rates[i] > 0.0 >= rates[i + 1]:
                self.peak = max(self.peak, _value(series, _polish(speed, marks[i], marks[i + 1])))

    def press(self, series: Series, speed: Series, stop: float, length: float) -> None:
        """Look along a step for whether the body lets go of the ground, where that is known."""
        if self.arm is None or self.let_go:
            return
        arm, bend = self.arm, _derivative(speed)

        def fz(part: float) -> float:
            values = (_value(coefficients, part * stop) for coefficients in (series, speed, bend))
            y, rate, force = (arm.alpha * x / length**n for n, x in enumerate(values))
            return arm.fz(y, rate, force, 1.0)

        self.let_go = lets_go((fz(0.0), fz(0.5), fz(1.0)), fz)

    def overturned(self) -> Outcome:
        return Outcome.OVERTURNED_AFTER_IMPACT if self.bounced else Outcome.OVERTURNED_NO_IMPACT

    def still(self) -> tuple[Outcome, float]:
        """After the shaking: march on over still ground, by the same series, until the fate shows."""
        ground = Piece(0.0, math.inf)
        impacts = 0
        for _ in range(_MAX_STEPS):
            if self.side == 0 or impacts > 1:
                if self.let_go:
                    return Outcome.LOST_CONTACT, math.nan
                return (Outcome.ROCKED if self.peak > 0.0 else Outcome.NO_UPLIFT), self.peak
            if self.y > 1.0 and self.v > 0.0:
                return self.overturned(), math.nan
            side = self.side
            self.step(ground, 0.0, 0.25)
            impacts += self.side != side
        return Outcome.FAILED, math.nan


def _first_below(series: Series, speed: Series) -> tuple[float, float] | None:
    """The part of a step in which y first comes to the ground, at one of the samples or at a dip between two; None where it does not."""
    at, rates = ([_value(coefficients, x) for x in _MARKS] for coefficients in (series, speed))
    for i, (low, high) in enumerate(pairwise(_MARKS)):
        if rates[i] < 0.0 < rates[i + 1] and at[i + 1] > 0.0:
            high = _polish([-x for x in speed], low, high)
        if _value(series, high) <= 0.0:
            return low, high
    return None


def _value(coefficients: Series, x: float) -> float:
    total = 0.0
    for c in reversed(coefficients):
        total = total * x + c
    return total


def _derivative(coefficients: Series) -> Series:
    return [n * c for n, c in enumerate(coefficients) if n]


def _polish(coefficients: Series, low: float, high: float) -> float:
    """The root of a polynomial that falls through zero between `low` and `high`."""
    slope = _derivative(coefficients)
    x = 0.5 * (low + high)
    for _ in range(100):
        value = _value(coefficients, x)
        low, high = (x, high) if value > 0.0 else (low, x)
        rate = _value(slope, x)
        following = x - value / rate if rate < 0.0 else low
        following = following if low < following < high else 0.5 * (low + high)
        if abs(following - x) <= 1e-16 or following in (low, high):
            return following
        x = following
    return x

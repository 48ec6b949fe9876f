"""The linear oscillator in multiple precision: closed-form arcs, every event found by steps that cannot pass over one.

Nothing is shared with the package but the motion's pieces. On an arc y = P(h) + c e^h + d e^-h with the particular solution P of
constants, ramps and sinusoids; what cancels costs digits, of which there are plenty. From any instant a Taylor polynomial less the
bound of its remainder stays below the function, so a step to where that bound ends passes over no root.
"""

from __future__ import annotations

import math

from mpmath import mp, mpf

_LONGEST = 4  # tau, of one arc's closed form
_TERMS = 4  # of the Taylor polynomials that bound the steps
_REST = mpf(10) ** -16  # a slower bounce under a drive that holds the body down is rest: it would rise by 1e-32


class Wave:
    """constant + ramp h + sum_j C_j sin(w_j h + f_j): a drive, or with the two exponentials the motion that it causes."""

    def __init__(self, constant, ramp, sines, grow=0, fall=0):
        self.constant, self.ramp, self.sines, self.grow, self.fall = constant, ramp, sines, grow, fall

    def at(self, h, first, count):
        """`count` derivatives from the `first` on."""
        up, down = (self.grow * mp.exp(h), self.fall * mp.exp(-h)) if self.grow or self.fall else (mpf(0), mpf(0))
        found = [up + (-down if n % 2 else down) for n in range(first, first + count)]
        for n, part in ((0, self.constant + self.ramp * h), (1, self.ramp)):
            if first <= n < first + count:
                found[n - first] += part
        for c, w, f in self.sines:
            cos, sin = mp.cos_sin(w * h + f)
            for n in range(first, first + count):
                found[n - first] += c * w**n * (sin, cos, -sin, -cos)[n % 4]
        return found

    def bound(self, h, ahead, order):
        """A bound of |derivative of that order| (two at the least) on [h, h + ahead]."""
        total = abs(self.grow) * mp.exp(h + ahead) + abs(self.fall) * mp.exp(-h) if self.grow or self.fall else mpf(0)
        return total + sum(abs(c) * w**order for c, w, _ in self.sines)

    def motion(self, y, v):
        """The y with y'' = y - 1 + (this drive), and its state at 0."""
        path = Wave(1 - self.constant, -self.ramp, [(-c / (1 + w * w), w, f) for c, w, f in self.sines])
        rest, rate = path.at(mpf(0), 0, 2)
        path.grow, path.fall = ((y - rest) + (v - rate)) / 2, ((y - rest) - (v - rate)) / 2
        return path

    def first_root(self, start, stop, order, sign, zeros=0):
        """First h in (start, stop] where sign * (derivative of that order) is no longer positive, or None.

        zeros: derivatives that vanish at the start, where the function is about to become positive.
        """
        h = start
        while True:
            terms = [sign * t for t in self.at(h, order, _TERMS)]
            value, rate = terms[:2]
            if zeros == 0 and value <= 0:
                return h
            # One root within twice Newton's step, and Newton's method certain to meet it (Kantorovich)?
            if zeros == 0 and rate < 0 and value * self.bound(h, -2 * value / rate, order + 2) < mpf(10) ** -2 * rate * rate:
                root = h
                for _ in range(7):  # 2^7 > digits
                    value, rate = self.at(root, order, 2)
                    root -= value / rate
                return root if root <= stop else None
            ahead = stop - h
            if ahead <= 0:
                return None
            terms = [t / math.factorial(n) for n, t in enumerate(terms)][zeros:]
            terms.append(-self.bound(h, ahead, order + _TERMS) / math.factorial(_TERMS))
            falls = [(n, -t) for n, t in enumerate(terms) if n and t < 0]
            steps = [(terms[0] / (len(falls) * t)) ** (mpf(1) / n) for n, t in falls]
            h = min([stop, *(h + s for s in steps)])
            zeros = 0


def march(motion, amplitude, omega, eta, digits=50):
    """(outcome flag, max |theta|/alpha, NaN where overturned, impacts during the shaking) of one cell of doubles, exact inputs."""
    with mp.workdps(digits):
        return _march(motion, mpf(amplitude), mpf(omega), mpf(eta))


def _march(motion, amplitude, omega, eta):
    body = _Body(amplitude, omega, eta)
    for piece in motion.pieces:
        begin, end = _turns(piece.start), _turns(piece.stop)
        phase = begin
        while phase < end:
            constant = amplitude * (mpf(piece.constant) + mpf(piece.slope) * (phase - begin))
            sines = [
                (amplitude * mpf(x.amplitude), mpf(x.frequency) * omega, mpf(x.frequency) * phase + _turns(x.phase))
                for x in piece.harmonics
            ]
            ground = Wave(constant, amplitude * mpf(piece.slope) * omega, sines)
            left = (end - phase) / omega
            passed = body.move(ground, left) if body.side else body.wait(ground, left)
            phase = end if passed >= left else phase + omega * passed
            if body.side and body.y - 1 + body.v > amplitude * mpf(motion.peak):
                return body.overturned()
    return body.still()


def _turns(phase):
    """A phase of doubles, at quarter turns the exact multiple of pi that it stands for."""
    quarter = round(phase / (math.pi / 2))
    return quarter * mp.pi / 2 if abs(phase - quarter * math.pi / 2) <= 4e-16 * max(1.0, abs(phase)) else mpf(phase)


class _Body:
    """The state; `zeros` derivatives of y vanish exactly at this instant."""

    def __init__(self, amplitude, omega, eta):
        self.amplitude, self.omega, self.eta = amplitude, omega, eta
        self.y = self.v = self.peak = mpf(0)
        self.side = self.zeros = self.impacts = 0

    def wait(self, ground, left):
        """On to the uplift, or to the end; returns the time that passes."""
        (now,) = ground.at(mpf(0), 0, 1)
        if abs(now) > 1:
            self.side, self.zeros = (-1 if now > 0 else 1), 2
            return mpf(0)
        lifts = []
        for side in (1, -1):  # |a| = 1 at once, where it is rising, counts as the first instant of uplift
            below = Wave(1 - side * ground.constant, -side * ground.ramp, [(-side * c, w, f) for c, w, f in ground.sines])
            lifts.append((below.first_root(mpf(0), left, 0, 1) or left, -side))
        time, self.side = min(lifts)
        self.zeros = 3
        if time >= left:
            self.side = 0
        return time

    def move(self, ground, left):
        """On over one arc, at the longest to the impact; returns the time that passes."""
        drive = Wave(-self.side * ground.constant, -self.side * ground.ramp, [(-self.side * c, w, f) for c, w, f in ground.sines])
        path, stop = drive.motion(self.y, self.v), min(left, mpf(_LONGEST))
        hit = path.first_root(mpf(0), stop, 0, 1, self.zeros)
        reach, at, zeros = stop if hit is None else hit, mpf(0), max(0, self.zeros - 1)
        sign = 1 if zeros or self.v > 0 else -1
        while at is not None and at < reach:
            at = path.first_root(at, reach, 1, sign, zeros)
            if at is not None and sign > 0:
                self.peak = max(self.peak, path.at(at, 0, 1)[0])
            sign, zeros = -sign, 1
        self.y, self.v = path.at(reach, 0, 2)
        self.zeros = 0
        if hit is not None:
            self.impacts += 1
            self.side, self.y, self.v, self.zeros = -self.side, mpf(0), -self.eta * self.v, 1
            push = -self.side * ground.at(reach, 0, 1)[0]
            if self.v == 0 or (self.v < _REST and abs(push) < 1 and self.eta < 1):
                self.side, self.v = 0, mpf(0)
        return reach

    def overturned(self):
        return ("overturned_after_impact" if self.impacts else "overturned_no_impact"), math.nan, self.impacts

    def still(self):
        """After the shaking E = v^2 - (1 - y)^2 is constant (Eq. 2.7)."""
        y, v, impacts = self.y, self.v, self.impacts
        if self.side == 0:
            return ("rocked" if self.peak > 0 else "no_uplift"), float(self.peak), impacts
        if y - 1 + v > 0:
            return self.overturned()
        energy = v * v - (1 - y) ** 2
        if v > 0:
            self.peak = max(self.peak, 1 - mp.sqrt(-energy))
        rebound = self.eta**2 * (1 + energy)
        if rebound > 1:
            return "overturned_after_impact", math.nan, impacts
        return "rocked", float(max(self.peak, 1 - mp.sqrt(1 - rebound))), impacts

"""An independent answer for many cells under a record: plain steps in lockstep, no code shared with the engine.

Every interval between samples is cut where the outward drive rises through 1. On each part the state follows from cosh, sinh and the
ramp as they stand in a textbook, or by collocation; an impact is a sign change of y between the ends of a part or at a minimum in it, a
crest one of v, both found by Newton's method in a bracket. Nothing is jumped, closed or proved: a bounce goes on until its speed is 1e-11.
"""

from itertools import pairwise

import numpy as np

NO_UPLIFT, ROCKED, NO_IMPACT, AFTER_IMPACT = 1, 2, 3, 4
AT_REST = 1e-11


class Linear:
    """y'' = y - 1 + a; y is |theta|/alpha."""

    def force(self, y, a):
        """y'' under the outward drive a."""
        return y - 1.0 + a

    def flow(self, y, v, a, rate, h):
        """y and v after h under the outward drive a + rate h."""
        pull, sinh, cosh1 = y - 1.0 + a, np.sinh(h), 2.0 * np.sinh(0.5 * h) ** 2
        return y + (v * sinh + pull * cosh1 + rate * (sinh - h)), v + ((v + rate) * cosh1 + pull * sinh)

    def lost(self, y, v, strongest):
        """Whether no drive up to this one brings the body back."""
        return y - 1.0 + v > strongest

    def fate(self, y, v, eta):
        """On still ground: whether the body falls, before an impact or after it, and its next largest y."""
        energy = v**2 - (1.0 - y) ** 2
        rebound = eta**2 * (1.0 + energy)
        outward = np.where(v > 0.0, 1.0 - np.sqrt(-energy), y)
        return y - 1.0 + v > 0.0, rebound > 1.0, np.maximum(outward, 1.0 - np.sqrt(1.0 - rebound))


_x, _w = np.polynomial.legendre.leggauss(8)
_NODES = 0.5 * (_x + 1.0)
_POWERS = np.arange(8)
_TWICE = (_NODES[:, None] ** (_POWERS + 2) / ((_POWERS + 1) * (_POWERS + 2))) @ np.linalg.inv(_NODES[:, None] ** _POWERS)


class Rigid:
    """Eq. 2.3 by Gauss collocation with eight nodes (order 16), solved by Picard iteration; y is |theta|/alpha, time p t.

    y'' = [-sin(alpha - alpha y) + a tan(alpha) cos(alpha - alpha y)]/alpha, a over tan(alpha), which lifts.
    """

    def __init__(self, alpha):
        self.alpha = alpha

    def force(self, y, a):
        """y'' under the outward drive a."""
        z = self.alpha * (1.0 - y)
        return (a * np.tan(self.alpha) * np.cos(z) - np.sin(z)) / self.alpha

    def flow(self, y, v, a, rate, h):
        """y and v after h under the outward drive a + rate h."""
        drive, straight = a + rate * h * _NODES[:, None], y + v * h * _NODES[:, None]
        at, before = straight, np.inf
        for _ in range(40):
            force = self.force(at, drive)
            at = straight + h * h * (_TWICE @ force)
            if np.all(np.abs(at - before) <= 4e-16 * np.abs(at)):
                break
            before = at
        weights = 0.5 * _w
        return y + h * (v + h * ((weights * (1.0 - _NODES)) @ force)), v + h * (weights @ force)

    def lost(self, y, v, strongest):
        """It lies on its side."""
        return self.alpha * y > 0.5 * np.pi

    def fate(self, y, v, eta):
        """On still ground: whether the body falls, before an impact or after it, and its next largest y."""
        alpha = self.alpha
        energy = 0.5 * (alpha * v) ** 2 + np.cos(alpha * (1.0 - y)) - np.cos(alpha)
        barrier, rebound = 1.0 - np.cos(alpha), eta**2 * energy
        out, after = (1.0 - np.arccos(np.cos(alpha) + e) / alpha for e in (energy, rebound))
        falls = np.where(y > 1.0, (v >= 0.0) | (energy < barrier), (v > 0.0) & (energy > barrier))
        return falls, rebound > barrier, np.maximum(np.where(v > 0.0, out, y), after)


def _first(body, y, v, a, rate, h, which):
    """The h at which y (which = 0) or v (which = 1) becomes negative: Newton's method in a bracket that only shrinks."""
    fall = 1.0 - np.minimum(a, a + rate * h)
    low, high, at = np.where((y == 0.0) & (fall > 0.0), 0.5 * v / fall, 0.0), h.copy(), h.copy()  # the start is a root of y too
    for _ in range(100 if h.size else 0):
        there = body.flow(y, v, a, rate, at)
        slope = there[1] if which == 0 else body.force(there[0], a + rate * at)
        after = there[which] < 0.0
        low, high = np.where(after, low, at), np.where(after, at, high)
        newton = at - there[which] / slope
        following = np.where((newton > low) & (newton < high) & (slope < 0.0), newton, 0.5 * (low + high))
        settled = np.abs(following - at) <= 1e-15 * at
        at = following
        if settled.all():
            break
    return at


LINEAR = Linear()


def lockstep(samples, step, amplitude, omega, eta, body=LINEAR):
    """(outcome codes, max |theta|/alpha or NaN) of symmetric bodies, amplitude, omega and eta of shape (cells,)."""
    cells = amplitude.size
    side, y, v, peak = np.zeros(cells), np.zeros(cells), np.zeros(cells), np.zeros(cells)
    bounced, outcome = np.zeros(cells, dtype=bool), np.full(cells, NO_UPLIFT)
    strongest = np.abs(samples).max()
    with np.errstate(all="ignore"):
        for s0, s1 in pairwise(samples):
            left = np.full(cells, step) / omega
            slope = amplitude * (s1 - s0) * omega / step
            drive = amplitude * s0  # of the ground; outwards it is -side drive
            lanes = np.flatnonzero(outcome < NO_IMPACT)
            while lanes.size:
                resting = lanes[side[lanes] == 0.0]
                lifts = resting[np.abs(drive[resting]) > 1.0 + 1e-13]
                later = resting[np.abs(drive[resting]) <= 1.0 + 1e-13]
                ends = drive[later] + slope[later] * left[later]
                wait = (np.sign(ends) - drive[later]) / slope[later]
                rises = (np.abs(ends) > 1.0 + 1e-13) & (wait >= 0.0)
                up = later[rises]
                drive[up], left[up] = np.sign(ends[rises]), left[up] - wait[rises]
                lifted = np.zeros(cells, dtype=bool)
                lifted[up] = True  # and rising: no impact, whatever the last digit of y says
                up = np.concatenate([lifts, up])
                side[up], y[up], v[up], outcome[up] = -np.sign(drive[up]), 0.0, 0.0, ROCKED
                lanes = lanes[side[lanes] != 0.0]
                now = (y[lanes], v[lanes], -side[lanes] * drive[lanes], -side[lanes] * slope[lanes])
                one = (1.0 - now[2]) / now[3]  # where the drive rises through 1 a body may fall and lift between the ends
                span = np.where((now[2] < 1.0) & (one > 0.0) & (one < left[lanes]), one, left[lanes])
                end_y, end_v = body.flow(*now, span)
                down = (end_y < 0.0) & ~lifted[lanes]
                reach = span.copy()
                dips = np.flatnonzero((now[1] < 0.0) & (end_v > 0.0) & ~down)  # a minimum within the part may touch the ground
                there = [x[dips] for x in now]
                low, high = np.zeros(dips.size), reach[dips]
                for _ in range(30 if dips.size else 0):
                    middle = 0.5 * (low + high)
                    sinks = body.flow(*there, middle)[1] < 0.0
                    low, high = np.where(sinks, middle, low), np.where(sinks, high, middle)
                touches = body.flow(*there, low)[0] < 0.0
                reach[dips[touches]], down[dips[touches]] = low[touches], True
                reach[down] = _first(body, *(x[down] for x in now), reach[down], 0)
                falls = np.flatnonzero((now[1] >= 0.0) & (body.flow(*now, reach)[1] < 0.0))
                there = [x[falls] for x in now]
                top = body.flow(*there, _first(body, *there, reach[falls], 1))[0]
                peak[lanes[falls]] = np.maximum(peak[lanes[falls]], top)
                peak[lanes] = np.maximum(peak[lanes], np.where(down, 0.0, end_y))
                hit, free = lanes[down], lanes[~down]
                y[free], v[free] = end_y[~down], end_v[~down]
                v[hit] = -eta[hit] * body.flow(*(x[down] for x in now), reach[down])[1]
                left[lanes] -= reach
                drive[lanes] += slope[lanes] * reach
                y[hit], side[hit], bounced[hit] = 0.0, -side[hit], True
                still = hit[v[hit] < AT_REST]
                side[still] = 0.0
                over = free[body.lost(y[free], v[free], amplitude[free] * strongest)]
                outcome[over] = np.where(bounced[over], AFTER_IMPACT, NO_IMPACT)
                lanes = np.concatenate([hit, free[left[free] > 1e-14]])
    air = np.flatnonzero((outcome == ROCKED) & (side != 0.0))
    with np.errstate(invalid="ignore"):
        over, after, top = body.fate(y[air], v[air], eta[air])
    outcome[air[over]] = np.where(bounced[air[over]], AFTER_IMPACT, NO_IMPACT)
    outcome[air[~over & after]] = AFTER_IMPACT
    peak[air] = np.maximum(peak[air], top)
    return outcome, np.where(outcome >= NO_IMPACT, np.nan, peak)

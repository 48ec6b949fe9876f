"""Undamped bodies with equal edges that keep nearly all speed at impacts: they bounce to the end of a record at one action (Lemma 14)."""

from __future__ import annotations

import math

import numpy as np

from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..equations.equation import Equation
from ..lanes import Lanes

Array = np.ndarray

_KEEPS = 0.99  # eta above which bodies are tested: others come to rest soon
_FIRST = 16  # steps of a lane before the first test
_ROOM = (0.05, 0.1, 0.2, 0.4, 0.8)  # for G
_SMALL = 0.095  # of D^2/g
_PEAK = 1.17  # over W/D: 1.053 during the shaking, and after it, where a goes to 0 with M <= 1.05 y, 1.053 (1 + 1.106 e/D) D
_JOINED = 1e-15  # of the largest s: a larger change between lines is a jump
_SURELY = 1.0 - 1e-6  # part of a bound that is used: the rest is room for rounding


def bounces_on(segments: Segments, lanes: Lanes, equation: Equation) -> Array:
    """True for lanes just after an impact that bounce below their peak until the shaking is over. Lanes are tested after `_FIRST` steps,
    then each time that the number has doubled."""
    found = np.zeros(lanes.v.shape, dtype=bool)
    looks = (lanes.steps >= _FIRST) & (lanes.steps & (lanes.steps - 1) == 0) & (lanes.eta > _KEEPS) & (lanes.v > 0.0)
    at = np.flatnonzero(looks & (lanes.b < 0.0) & (lanes.b > -2.0))
    if not at.size:
        return found
    k = lanes.k[at]
    later = np.minimum(k + 1, len(segments) - 1)
    loudest = np.maximum(np.maximum(segments.later_max[later], -segments.later_min[later]), np.abs(segments.s_end[k]))
    at = at[lanes.amplitude[at] * loudest < 1.0]
    gains = np.broadcast_to(equation.on(lanes.side[at], lanes.cell[at]).gain, at.shape)
    for lane, gain in zip(at.tolist(), gains.tolist(), strict=True):  # one by one: no sum depends on a lane's neighbours
        highest = ceiling(segments, lanes.take(slice(lane, lane + 1)), gain)
        found[lane] = math.isfinite(highest) and highest <= lanes.peak[lane]  # the peak is infinite where none is wanted
    return found


def ceiling(segments: Segments, lane: Lanes, gain: float) -> float:
    """A bound of all later peaks [y] of one body just after an impact if nothing lifts it again; infinite if none is proved."""
    (k,), (u,), (amplitude,), (omega,), (v,), (b,) = (x.tolist() for x in (lane.k, lane.u, lane.amplitude, lane.omega, lane.v, lane.b))
    torn = _JOINED * amplitude * max(float(segments.later_max[0]), -float(segments.later_min[0]))
    now, sums, most, steepest, tall = abs(1.0 + b), 0.0, 0.0, 0.0, 0.0
    if now == 1.0:  # the force is below rounding
        return np.inf
    end, before, phase_before = now, 0.0, 0.0  # of the line before: c at its end, c', the factor of phi
    for part in blocks(len(segments) - k):
        at = slice(k + part.start, k + part.stop)
        ends = np.append(end, amplitude * segments.s_end[at])
        if np.abs(amplitude * segments.s_start[at] - ends[:-1])[0 if part.start else 1 :].max(initial=0.0) > torn:
            return np.inf
        e = np.maximum(np.abs(ends[:-1]), np.abs(ends[1:]))
        force, square = 1.0 - e, 1.0 - e * e  # D, 1 - e^2
        slope = amplitude * omega * segments.slope[at]  # c'
        rate, lasts = np.abs(slope), segments.length[at] / omega
        if not part.start:
            lasts[0] -= u / omega
            before = slope[0]
        phase = 2.0 / 3.0 / square + 0.36 / (force * force)
        turns = np.abs(np.diff(slope, prepend=before)) * np.maximum(np.append(phase_before, phase[:-1]), phase)
        lines = rate * rate * lasts * (4.0 / 3.0 * e / (square * square) + 0.74 / force**3)
        sums += float(lines.sum()) + float(turns.sum())
        tall += 2.0 * gain * float((rate * lasts / force**3).sum())
        most, steepest = max(most, float(e.max())), max(steepest, float((rate * phase).max()))
        end, before, phase_before = float(ends[-1]), float(slope[-1]), float(phase[-1])
    for room in _ROOM:
        still = 0.5 * v * v * math.exp(room) / (1.0 - now * now) ** (2.0 / 3.0)  # the most that W could be where c = 0
        if math.sqrt(2.0 * still) * (sums + 2.0 * steepest) + still * tall <= _SURELY * room:
            highest = still * (1.0 - most * most) ** (2.0 / 3.0) / (1.0 - most)  # W/D, which grows with |c|
            return _PEAK * highest / _SURELY if highest <= _SMALL * (1.0 - most) / gain else np.inf
    return np.inf

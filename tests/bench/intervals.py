"""Envelopes of several cycles against rasters: which intervals wider than 1e-4 in A does the scan miss?

    python tests/bench/intervals.py 300

Random sines and cosines of 1.5 to 6 cycles, eta 0.3 to 1, Omega 0.5 to 10. The raster computes every cell 2.5e-5 apart; an
interval of five or more equal outcomes in it is wider than 1e-4, and missed where the envelope has another outcome all over it and
a raster of 1e-6 shows that nothing narrower cuts it in two.
"""

import sys
import time
from itertools import pairwise

import numpy as np

from rocking_cli import Motion, Outcome, cosine, dimensionless_oscillator, linear_response, sine, trace_envelope

STEP, ENOUGH = 2.5e-5, 5


def case(number: int) -> tuple[Motion, float, float]:
    """(motion, eta, Omega)."""
    random = np.random.default_rng(1000 + number)
    cycles, eta, omega = float(random.integers(3, 13)) / 2, float(random.uniform(0.3, 1.0)), float(random.uniform(0.5, 10.0))
    return (sine, cosine)[int(random.integers(2))](cycles), eta, omega


def misjudged(motion: Motion, eta: float, omega: float, a_max: float = 12.0) -> tuple[int, list[tuple[float, float]], tuple[float, float]]:
    """(intervals wider than 1e-4 in the raster, those that the envelope misses, processor time of raster and envelope)."""
    began = time.process_time()
    amplitude = np.arange(1.0, a_max, STEP)
    raster = linear_response(motion, amplitude, omega, eta, peaks=False).outcome
    raster[raster == Outcome.NO_UPLIFT] = Outcome.ROCKED
    between = time.process_time()
    traced = np.full(amplitude.size, Outcome.ROCKED, dtype=np.uint8)
    for i in trace_envelope(dimensionless_oscillator(eta), motion, [omega], a_max=a_max, workers=1):
        inside = slice(*np.searchsorted(amplitude, [i.a_from, a_max if i.a_to is None else i.a_to]))
        traced[inside] = next(o for o in Outcome if o.mode == i.mode)
    ended = time.process_time()
    ends = np.concatenate([[0], np.flatnonzero(np.diff(raster)) + 1, [raster.size]])
    wide = [(a, b) for a, b in pairwise(ends) if b - a >= ENOUGH]
    strange = [(float(amplitude[a]), float(amplitude[b - 1])) for a, b in wide if not np.any(traced[a:b] == raster[a])]
    missed = [(low, high) for low, high in strange if np.ptp(linear_response(motion, np.arange(low, high, 1e-6), omega, eta).outcome) == 0]
    return len(wide), missed, (between - began, ended - between)


if __name__ == "__main__":
    total, lost, cases, spent = 0, 0, 0, np.zeros(2)
    for number in range(int(sys.argv[2]) if len(sys.argv) > 2 else 0, int(sys.argv[1])):
        motion, eta, omega = case(number)
        wide, missed, cost = misjudged(motion, eta, omega)
        total, lost, cases, spent = total + wide, lost + len(missed), cases + bool(missed), spent + cost
        for low, high in missed:
            print(f"case {number}: {motion.name}, eta {eta:.4f}, Omega {omega:.4f}: missed {low:.6f} to {high:.6f}", flush=True)
    print(f"{total} intervals wider than 1e-4, {lost} missed in {cases} cases; raster {spent[0]:.0f} s, envelope {spent[1]:.0f} s")

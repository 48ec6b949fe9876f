"""The worst frequency of a range: the one at which the least amplitude overturns a structure."""

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import safe
from ..dynamics.response import response
from ..motions import Motion
from ..motions.grid import Axis, Grid
from ..processes import available_cpus
from ..structures.parameters import RockingParameters
from .amplitudes import Limit, limit_of
from .capacity import CapacitySearch
from .intervals import A_MAX, in_turn, trace_envelope

_RATIO = 1.04  # ratio of neighbouring frequencies of the scan; narrower minima may be missed
_WITHIN = 1.2  # upper end of the scan over the least amplitude so far; minima above it are not searched
_INSIDE = 1e-4  # relative distance from an end of the range at which a lower amplitude shows that the end is no minimum
_FINE = 1e-6  # relative width to which the frequency of a minimum is found


def at_worst_frequency(
    structure: RockingParameters, motion: Motion, low: Grid, high: Grid, a_max: float | Limit | None = A_MAX
) -> tuple[Grid, float]:
    """(the demand at the worst frequency between those of two demands of one amplitude, that frequency in Hz).

    At the worst frequency the first overturning amplitude is least. A scan of the range and a search around each minimum of the scan find
    it; minima narrower than 4 % of the frequency may be missed. If the demand is above this amplitude, and the body stands under it there
    but falls at other frequencies of the scan, the result is the worst of those. If no amplitude up to `a_max` overturns the body, and it
    stands under the demand, the result is the frequency of the largest rotation. Raises UsageError.
    """
    method = governing_method(structure, dimensionless=low.dimensionless)
    (amplitude, begin), (_, end) = (grid.cell(structure) for grid in (low, high))
    most = A_MAX if a_max is None else limit_of(a_max, structure)
    omega = _worst(structure, motion, amplitude, (min(begin, end), max(begin, end)), method, most)
    axis = Axis("Omega", np.array([omega])) if low.dimensionless else Axis("omega_g", np.array([omega * structure.p]))
    return Grid(low.amplitude, axis), omega * structure.p / math.tau


def at_worst_frequencies(
    structures: Sequence[RockingParameters], motion: Motion, low: Grid, high: Grid, a_max: float | Limit | None = A_MAX, *,
    workers: int | None = None, progress: Callable[[int, int], None] | None = None,
) -> list[tuple[Grid, float]]:  # fmt: skip
    """`at_worst_frequency` of each structure. workers: number of processes, which share the structures, None for all cores; progress:
    called with the number of structures that are done and the number of all. Raises UsageError, OutputError when a worker process dies."""
    search = partial(at_worst_frequency, motion=motion, low=low, high=high, a_max=a_max)
    found = []
    for one in in_turn(search, structures, min(workers or available_cpus(), len(structures))):
        found.append(one)
        if progress:
            progress(len(found), len(structures))
    return found


def _worst(
    structure: RockingParameters, motion: Motion, amplitude: float, ends: tuple[float, float], method: Method, a_max: float
) -> float:
    """Finds the worst Omega between two ends for a demand of A = `amplitude`."""
    from scipy.optimize import minimize_scalar

    system, (low, high) = method.system_of(structure), ends
    scan = np.geomspace(low, high, 2 + math.ceil(math.log(high / low) / math.log(_RATIO)))
    least = system.least_uplift(motion)

    def first(omega: float, most: float) -> float:
        found = CapacitySearch(structure, motion, least, omega, method, most).capacity().first if least < most else None
        return math.inf if found is None else found

    worst = (math.inf, low)
    for omega in (low, float(scan[scan.size // 2]), high):
        worst = min(worst, (first(omega, min(a_max, _WITHIN * worst[0])), omega))
    firsts = dict.fromkeys(scan.tolist(), math.inf)
    most = min(a_max, _WITHIN * worst[0])
    if least < most:
        for interval in trace_envelope(structure, motion, scan, method=method, a_max=most, sign="+", workers=1):
            firsts[interval.omega] = min(firsts[interval.omega], interval.a_from)
    around = [low, *scan.tolist(), high]
    for before, omega, after in zip(around, scan.tolist(), around[2:], strict=False):
        if not firsts[omega] <= min(firsts[before], firsts[after], most):
            continue
        worst = min(worst, (firsts[omega], omega))
        inside = omega * (1.0 + _INSIDE) if omega == low else omega * (1.0 - _INSIDE)
        if omega in (low, high) and first(inside, most) >= firsts[omega]:
            continue
        found = minimize_scalar(
            lambda x: first(math.exp(x), most), bounds=(math.log(before), math.log(after)), method="bounded", options={"xatol": _FINE}
        )
        worst = min(worst, (float(found.fun), math.exp(found.x)))
    if worst[0] > amplitude and math.isfinite(worst[0]):
        return worst[1]
    omegas = np.append(scan, worst[1])
    under = response(system, motion, np.full(omegas.size, amplitude), omegas, structure.eta)
    falls = ~safe(under.outcome)
    if not math.isfinite(worst[0]) and not falls.any():
        return float(omegas[np.argmax(under.theta_ratio)])
    if not falls[-1] and falls.any():
        return float(min(omegas[falls], key=lambda omega: firsts.get(omega, math.inf)))
    return worst[1]

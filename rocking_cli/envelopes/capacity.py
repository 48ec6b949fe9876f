"""How strong a motion must be to overturn one body: the lowest amplitude that does, and how far the stretch reaches that holds a demand.

The boundaries are those of an envelope, traced likewise; but the search goes no further than the two questions need, and the demand
itself is one of the amplitudes that it looks at, so that what it says and the response at the demand cannot contradict each other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..dynamics.method import Method
from ..dynamics.outcome import Outcome
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .boundaries import Search
from .changes import Brackets
from .envelope import HIGHEST

LONGEST_FINE = 200  # segments of a motion up to which the scan is as fine as an envelope's
RATIO = 5e-3  # of neighbouring amplitudes, less 1, beyond that: a cell costs a thousand times one of a pulse
_FIRST_WINDOW = 1.5  # in A, looked at together: that many cells cost about as much as one batch
_PARTS = 256  # that a change is cut into at once: few changes, so that a batch costs the same whatever its size


@dataclass(frozen=True)
class Capacity:
    """first: the lowest amplitude A that overturns, None where none does; safe_to: where the stretch around the demand that stands
    ends, None where the body falls under it or nothing above overturns. uplift: the A that lifts the body, None where none does."""

    first: float | None
    safe_to: float | None
    uplift: float | None


def capacity(structure: RockingParameters, motion: Motion, amplitude: float, omega: float, *, method: Method, a_max: float) -> Capacity:
    """The capacity of a structure at Omega [-] against a demand of A = `amplitude` [-], searched up to `a_max` and twice the demand.

    Narrower intervals than `narrowest` says can be missed, but not around the demand. Changes are traced to the last digits of an
    exact method, to its tolerance otherwise. Raises UsageError where the search would go beyond what a scan reaches.
    """
    system = method.system_of(structure)
    lowest = system.least_uplift(motion)
    top = max(a_max, 2.0 * amplitude)
    if not top <= HIGHEST:
        raise UsageError(f"{structure.name}: a search up to A = {top:.6g}, accepted is up to {HIGHEST:g}")
    if not lowest < top:
        return Capacity(None, None, lowest if np.isfinite(lowest) else None)
    search = Search(system, motion, structure.eta, top, ratio=_ratio(motion), digits=method.stated_tolerance or 4e-16, parts=_PARTS)
    falls: list[Brackets] = []  # of each window that holds one, until it is clear what becomes of the demand
    above = False  # whether the last of them is above a demand that stands
    for begin, end in _windows(lowest, amplitude, top, at_once=system.equation.bounded):
        fall, last = replace(search, a_min=begin, a_max=end).fall(omega)
        falls += [fall] if fall.row.size else []
        above = begin >= amplitude and fall.row.size > 0
        if above or (end <= amplitude and not Outcome(last).safe):
            break
    found = search.first_falls_in(omega, Brackets.join(falls)) if falls else []
    return Capacity(min(found, default=None), found[-1] if above else None, lowest)


def narrowest(motion: Motion) -> str:
    """The intervals of which nothing is claimed, in words."""
    return f"{100.0 * RATIO:g} % of the amplitude" if _ratio(motion) else "0.001 in A"


def _ratio(motion: Motion) -> float:
    return RATIO if len(motion.segments) > LONGEST_FINE else 0.0


def _windows(lowest: float, demand: float, top: float, at_once: bool) -> Iterator[tuple[float, float]]:
    """Stretches to look at in turn: up to the demand, and from it on, wider and wider where a scan has no bounds of its own."""
    begin, width = lowest, _FIRST_WINDOW
    if demand > lowest * (1.0 + 1e-12):
        yield lowest, demand
        begin = demand
    while begin < top:
        end = top if at_once or top - begin < 2.0 * width else begin + width
        yield begin, end
        begin, width = end, 2.0 * width

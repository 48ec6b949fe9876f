"""The effect of worn or rounded edges on a capacity: pivots that lie
inside the edges.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from ..envelopes.amplitudes import Limit, limit_of
from ..motions import Motion
from ..motions.grid import Grid
from ..structures.mechanics.worn_edges import worn
from ..structures.parameters import RockingParameters
from .check import Demand, first_overturning
from .verdict import Verdict

INSET = 0.05  # of the width


class InsetEffect(NamedTuple):
    """What pivots inside the edges change of the least capacity of a structure."""

    structure: str  # its name
    inset: float  # of the pivots [m]
    change: float  # of the capacity, over that on the edges as they are [-]
    # True if the strength gives the inset, and the edges are taken to be sharp
    crushes: bool


def may_be_worn(verdicts: Sequence[Verdict], demands: Sequence[Demand]) -> bool:
    """True if a body stands whose capacity worn edges would lower, and its document
    states no inset and no strength.
    """
    stands = {v.structure for v in verdicts if v.outcome.safe and v.first_overturning_a}
    return any(
        s.name in stands and not _crushes(s) and _inset_of(s) is not None
        for s, _, _ in demands
    )


def effects(
    verdicts: Sequence[Verdict],
    demands: Sequence[Demand],
    a_max: float | Limit,
    *,
    progress: Callable[[float, int], None] | None = None,
) -> Iterator[InsetEffect]:
    """Yield for each structure how much of its least capacity pivots 5 % of the width
    inside the edges would take.

    a_max: the largest amplitude of the search; progress: called with the number of
    structures that are done and of all. A structure with an `inset` of its own, with
    ties, without a capacity or without edges is left out. Raises UsageError as `check`
    does.
    """
    asked = {
        (structure.name, motion.name): (structure, motion, grid)
        for structure, motion, grid in demands
    }
    least: dict[str, Verdict] = {}
    for verdict in sorted(verdicts, key=lambda v: v.capacity_demand or 0.0):
        if verdict.first_overturning_a:
            least.setdefault(verdict.structure, verdict)
    for done, verdict in enumerate(least.values(), 1):
        found = _effect(verdict, *asked[verdict.structure, verdict.motion], a_max)
        if progress is not None:
            progress(done, len(least))
        if found is not None:
            yield found


def _effect(
    verdict: Verdict,
    structure: RockingParameters,
    motion: Motion,
    grid: Grid,
    a_max: float | Limit,
) -> InsetEffect | None:
    """Return the effect on one structure."""
    known, found = verdict.first_overturning_a, _inset_of(structure)
    if found is None or known is None:
        return None
    inset, body = found
    other = first_overturning(body, motion, grid, limit_of(a_max, body), known)
    if other is None:
        return None
    crushes = _crushes(structure)  # the other body is the one with sharp edges
    change = (known / other if crushes else other / known) - 1.0
    return InsetEffect(structure.name, inset, change, crushes)


def _inset_of(structure: RockingParameters) -> tuple[float, RockingParameters] | None:
    """Return (inset [m], the body with it), None if the body has an inset or no edges;
    of a body whose strength gives its inset (that, the body on its sharp edges).
    """
    if _crushes(structure):
        inset = float(structure.details["inset"])
        return _on_sharp_edges(structure, inset)
    return None if "inset" in structure.details else worn(structure, INSET)


def _crushes(structure: RockingParameters) -> bool:
    """True if the strength of a body gives its inset."""
    return "base_stress" in structure.details


def _on_sharp_edges(
    structure: RockingParameters, inset: float
) -> tuple[float, RockingParameters] | None:
    """Return (inset [m], the body with its pivots moved back to its edges)."""
    sides = structure.left_and_right
    width = sum(math.sin(side.alpha) * (side.arm or 0.0) for side in sides)
    found = worn(structure, -inset / width) if width else None
    return None if found is None else (inset, found[1])

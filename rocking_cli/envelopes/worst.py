"""The worst frequency of a range: the one at which the least amplitude overturns a
structure, or, if only outcomes are wanted, one at which the demand overturns it."""

import math
from collections.abc import Callable, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from functools import partial
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.outcome import safe
from ..motions import Motion
from ..motions.grid import Grid
from ..processes import available_cpus, part_reporter
from ..structures.parameters import RockingParameters
from .amplitudes import Limit
from .frequency_search import FrequencyRange, FrequencySearch, Tell, WorstFrequency
from .intervals import A_MAX, in_turn

# share of a search that counts when its result has come from its process
_LAST = 0.01
# ratio of an end of the range and the last frequency that is tried beyond it
_BEYOND = 10.0
_TRIED = 48  # frequencies beyond an end: powers of one ratio, whatever the range is
_CLOSER, _ROUNDS = 8, 5  # parts of a step in which a fall begins, cut so many times
_TOGETHER = 12  # structures whose cells are marched together, at most


class BeyondTheEnd(NamedTuple):
    """The answers of a body to the demand at frequencies beyond an end of the range."""

    # the frequency nearest to the end that overturns it [Hz], three digits on the side
    # of the fall; the same for each range that ends before it
    overturns: float | None
    # if none does: the frequency of the largest rotation, if it is larger [Hz]
    larger: float | None
    last: float  # the last frequency that was tried [Hz]


def at_worst_frequency(
    structure: RockingParameters,
    motion: Motion,
    low: Grid,
    high: Grid,
    a_max: float | Limit | None = A_MAX,
    *,
    tell: Tell = lambda _: None,
) -> WorstFrequency:
    """Return the worst frequency between those of two demands of one amplitude.

    At the worst frequency the first overturning amplitude is least. A scan of the range
    and a search around each minimum of the scan find it; minima narrower than 4 % of
    the frequency may be missed. If the demand is above this amplitude, and the body
    stands under it there but falls at other frequencies of the scan, the result is the
    worst of those. If no amplitude up to `a_max` overturns the body, and it stands
    under the demand, the result is the frequency of the largest rotation, which
    `largest` holds for each body that the demand lifts and does not overturn. If it
    does not even lift, no frequency is worse than another: `frequency` is None, and the
    grid is `low`.

    a_max: None if only outcomes are wanted. Then the result is a frequency of the scan
    at which the demand overturns the body. If there is none, the minima up to 1.5 times
    the demand are searched: a fall between two frequencies of the scan is missed only
    if at both of them no amplitude from the demand to 1.5 times the demand overturns
    the body, or only intervals narrower than 0.2 % do. If no frequency is found, the
    result is that of the largest rotation. tell: called with the share that is done.
    Raises UsageError.
    """
    (found,) = _of_a_group([structure], motion, low, high, a_max, tell=tell)
    return found


def at_worst_frequencies(
    structures: Sequence[RockingParameters],
    motion: Motion,
    low: Grid,
    high: Grid,
    a_max: float | Limit | None = A_MAX,
    *,
    workers: int | None = None,
    progress: Callable[[float, int], None] | None = None,
) -> list[WorstFrequency]:
    """`at_worst_frequency` of each structure.

    workers: number of processes, which share the structures, None for all cores;
    progress: called with the number of structures that are done, of which a part counts
    as a fraction, and the number of all. Raises UsageError, OutputError when a worker
    process dies.
    """
    known = 0.0

    def tell(done: float) -> None:
        nonlocal known
        known = max(known, done)
        if progress:
            progress(known, len(structures))

    def parts(reported: float) -> None:
        tell(min(reported, len(structures) - _LAST))

    def alone(group: Sequence[RockingParameters]) -> list[WorstFrequency]:
        before = len(found)
        return search(group, tell=lambda share: tell(before + share * len(group)))

    search = partial(_of_a_group, motion=motion, low=low, high=high, a_max=a_max)
    if not structures:
        return []
    several = min(workers or available_cpus(), len(structures))
    # Groups of about equal size, at least one for each process. A structure on a floor
    # has its own motions.
    floors = [s for s in structures if s.building]
    ground = [s for s in structures if not s.building]
    rounds = math.ceil(len(ground) / (several * _TOGETHER))
    size = math.ceil(len(ground) / (several * max(rounds, 1)))
    groups = [
        *([one] for one in floors),
        *(ground[i : i + size] for i in range(0, len(ground), max(size, 1))),
    ]
    several = min(several, len(groups))
    found: list[WorstFrequency] = []
    for some in in_turn(
        alone if several == 1 else partial(_reported, search), groups, several, parts
    ):
        found += some
        tell(len(found))
    of_floors, of_ground = iter(found[: len(floors)]), iter(found[len(floors) :])
    return [next(of_floors if s.building else of_ground) for s in structures]


def _reported(
    search: Callable[..., list[WorstFrequency]], group: Sequence[RockingParameters]
) -> list[WorstFrequency]:
    """Search in a worker process, which reports its progress to the one that started
    it.
    """
    report = part_reporter()
    return search(group, tell=lambda share: report(share * len(group)))


def _of_a_group(
    structures: Sequence[RockingParameters],
    motion: Motion,
    low: Grid,
    high: Grid,
    a_max: float | Limit | None,
    tell: Tell,
) -> list[WorstFrequency]:
    """`at_worst_frequency` of several structures, whose cells are marched together, or
    of one on a floor.
    """
    ranges = [FrequencyRange.of(s, motion, low, high, a_max) for s in structures]
    found = search_of(ranges, motion, tell)
    omegas = found.outcomes_alone() if a_max is None else found.least()
    return [
        one.worst(*both, low, high)
        for one, both in zip(ranges, found.largest(omegas), strict=True)
    ]


def search_of(
    ranges: Sequence[FrequencyRange], motion: Motion, tell: Tell = lambda _: None
) -> FrequencySearch:
    """Return the search of several structures on the ground, or of one on a floor."""
    if ranges[0].modes:
        from .floor_search import FloorSearch

        return FloorSearch(ranges, motion, tell)
    return FrequencySearch(ranges, motion, tell)


def beyond_the_end(
    structure: RockingParameters, motion: Motion, worst: WorstFrequency
) -> BeyondTheEnd:
    """Compute the answers of a body beyond the end of a range at which its worst
    frequency lies, up to ten times slower or faster.
    """
    one = FrequencyRange.of(structure, motion, worst.grid, worst.grid, None)
    omega, slower = one.begin, worst.end == "lower"
    search = search_of([one], motion)

    def under(omegas: Array) -> tuple[Array, Array]:
        return search.under(np.zeros(omegas.size, dtype=np.int64), omegas)

    ratio = _BEYOND ** ((-1.0 if slower else 1.0) / _TRIED)
    begin = math.floor(math.log(omega, ratio)) + 1
    omegas = np.append(omega, ratio ** np.arange(begin, begin + _TRIED))
    turned, outcome = under(omegas)
    hertz = omegas * structure.p / math.tau
    falls = np.flatnonzero(~safe(outcome[1:]))
    if falls.size:
        stands, there = omegas[falls[0]], omegas[falls[0] + 1]
        for _ in range(_ROUNDS):
            closer = np.linspace(stands, there, _CLOSER + 1)
            first = int(np.argmax(~safe(under(closer[1:])[1])))
            stands, there = closer[first], closer[first + 1]
        nearest = Decimal(float(there * structure.p / math.tau))
        side = ROUND_FLOOR if slower else ROUND_CEILING
        return BeyondTheEnd(
            float(Context(3, side).create_decimal(nearest)), None, float(hertz[-1])
        )
    largest = int(np.argmax(np.nan_to_num(turned)))
    return BeyondTheEnd(
        None, float(hertz[largest]) if largest else None, float(hertz[-1])
    )

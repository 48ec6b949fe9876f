"""The demands of `rocking check`: each structure under each motion, at the worst
azimuth or frequency where the call states a range of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import click

from ..packed import Packed, Streamed
from . import options
from .command import refuse
from .demand import Directed
from .ground import Ground, ends_abruptly, no_shaking
from .printing import detail, note
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..dynamics.outcome import Outcome
    from ..envelopes.amplitudes import Limit
    from ..envelopes.frequency_search import WorstFrequency
    from ..motions import Motion
    from ..motions.grid import Grid
    from ..responses.check import Demand, OfRange
    from ..structures import RockingParameters
    from .code_rows import CodeRows

# structures, and the columns of the varied values of each
Members = tuple[Sequence["RockingParameters"], dict[str, dict[str, float]]]
# rows from which on friction_needed and fz_min are computed only if they are asked for
LONG_TABLE = 1000
_LONG = 50_000  # samples of a record whose search is called long
_SEARCH = 5e-4  # s that the search for a capacity takes for each sample, about


class Rows(Streamed["Demand"]):
    """Each structure under each motion, one motion after the other."""

    def __init__(
        self,
        *parts: tuple[Sequence[tuple[Motion, Grid]], Sequence[RockingParameters]],
    ) -> None:
        self.parts = parts

    def __len__(self) -> int:
        return sum(len(shakes) * len(bodies) for shakes, bodies in self.parts)

    def __iter__(self) -> Iterator[Demand]:
        for shakes, bodies in self.parts:
            for shake in shakes:
                yield from ((body, *shake) for body in bodies)


@dataclass
class Demands:
    """What a call checks."""

    asked: Directed  # the options of the motion
    sign: str  # "+", "-" or "both"
    shaken: Ground  # the motions, in the direction of --sign
    structures: Sequence[RockingParameters]  # in the order of the document
    # columns of the varied values of each structure
    varied: dict[str, dict[str, float]]
    azimuths: Any  # [rad], an array; None without --azimuth
    up_to: Grid | None  # the demand at the other end of a range of frequencies
    shakes: list[tuple[Motion, Grid]]  # motions and demands, as they are told
    rows: Sequence[Demand] = ()  # the demand of each row
    # of each structure, with a range
    ranges: dict[str, OfRange] = field(default_factory=dict)
    worst: dict[str, WorstFrequency] = field(default_factory=dict)

    @property
    def ranged(self) -> str:
        """What the call states a range of: azimuth, frequency, or nothing."""
        if self.azimuths is not None and self.azimuths.size > 1:
            return "azimuth"
        return "frequency" if self.up_to is not None else ""

    def are_shaken(self, by_code: CodeRows | None = None) -> bool:
        """True if a motion shakes the structures, False if the spectrum of a code
        stands alone. Raises click.UsageError if there is neither.
        """
        if self.shakes:
            return True
        if by_code is None or not by_code.files:
            also = ["--spectrum FILE"] * (by_code is not None)
            raise no_shaking("--motion FILE", *also)
        why = "needs a motion: under --spectrum alone nothing is shaken"
        refuse(why, "draws", "fail_on", "sort", "inset_effect")
        return False


def stated_demands(
    files: tuple[str, ...], asked: Directed, vary: tuple[str, ...], sign: str
) -> Demands:
    """Read the structures and motions of a call. Raises UsageError."""
    files, motions = asked.several(files)
    return demands_on(
        lambda: options.members_of(files, vary, each=True), asked, motions, sign
    )


def demands_on(
    members: Callable[[], Members], asked: Directed, motions: Ground, sign: str
) -> Demands:
    """Return the demands of these motions; members: builds the structures, when the
    options of the motion are known to be right. Raises UsageError.
    """
    from ..dynamics.method import has_direction
    from ..motions.floors import on_floors

    # over a range the motion of a floor is another one at each frequency
    carrier = motions.building if asked.ends() else None
    motions = motions if carrier is None else replace(motions, building=None)
    ends = [end.of(motions) for end in asked.ends()]
    shaken = ends[0] if ends else asked.of(motions)
    if sign != "+" and asked.azimuth:
        raise click.UsageError(f"--sign {sign} does not go with --azimuth")
    if sign == "-" and ends:
        raise click.UsageError(
            "--sign - does not go with a range of frequencies, in which the worse"
            " direction counts"
        )
    shaken = shaken.reversed if sign == "-" else shaken
    structures, varied = members()
    if carrier is not None:
        structures = [replace(s, building=carrier.modes) for s in structures]
    up_to = ends[1].shakes[0][1] if ends else None
    found = Demands(
        asked, sign, shaken, structures, varied, asked.azimuths(), up_to, shaken.shakes
    )
    parts = [(shaken.shakes, structures)]
    if sign == "both" and not ends:
        sided = Packed(filter(has_direction, structures))
        parts.append((shaken.reversed.shakes, sided))
    found.rows = Rows(*parts)
    if any(s.building for s in structures):
        for r in shaken.recordings:
            note(*ends_abruptly(r.label, r.record.acceleration))
    if not ends and found.azimuths is None:
        found.rows = on_floors(found.rows)
    return found


def at_worst(demands: Demands, limit: Limit | None, workers: int | None) -> Demands:
    """Return the demands at the worst azimuth or frequency, if the call states a range.

    limit: the largest amplitude of the search, None if only outcomes are wanted.
    """
    if demands.azimuths is not None:
        demands = _at_worst_azimuth(demands, demands.azimuths, limit, workers)
    if demands.up_to is not None:
        demands = _at_worst_frequency(demands, limit, workers)
    from ..motions.floors import on_floors

    demands.rows = on_floors(demands.rows)
    _note_long(demands, limit)
    return demands


def _at_worst_azimuth(
    demands: Demands, azimuths: Any, limit: Limit | None, workers: int | None
) -> Demands:
    from ..dynamics.method import has_direction
    from ..responses.azimuth import worst_azimuths

    line = ProgressLine("azimuths", "checks")
    directed = worst_azimuths(
        demands.structures,
        demands.shaken.recordings,
        azimuths,
        limit,
        workers=workers,
        progress=line,
    )
    if both := [s.name for s in demands.structures if has_direction(s)]:
        detail(
            f"both signs of each azimuth, because the sides differ: {', '.join(both)}"
        )
    ranges = {structure.name: one for (structure, _, _), one in directed}
    worst = {name: one.columns["azimuth"] for name, one in ranges.items()}
    _note_end_of_span(azimuths, worst)
    rows = [demand for demand, _ in directed]
    return replace(
        demands,
        rows=rows,
        shakes=[(motion, grid) for _, motion, grid in rows],
        ranges=ranges,
    )


def _note_end_of_span(azimuths: Any, worst: Mapping[str, Any]) -> None:
    """Say which structures are worst at an end of a span of azimuths that leaves
    directions out; with equal steps half a turn is whole without its last azimuth.
    """
    first, last = float(azimuths[0]), float(azimuths[-1])
    step = (last - first) / max(azimuths.size - 1, 1)
    if azimuths.size < 2 or last - first + step >= math.pi * (1.0 - 1e-9):
        return
    for end in (first, last):
        names = [name for name, angle in worst.items() if math.isclose(angle, end)]
        if names:
            at = f"worst at an end of the azimuths, {math.degrees(end):.4g} deg"
            note(f"{at}: {', '.join(names)}; directions beyond it were not tried")


def _at_worst_frequency(
    demands: Demands, limit: Limit | None, workers: int | None
) -> Demands:
    from ..responses.check import OfRange

    motion, low = demands.shakes[0]
    assert demands.up_to is not None  # a range is stated
    structures, ends = demands.structures, (low, demands.up_to)
    worst = _worst(structures, motion, *ends, limit, workers)
    rows = {s.name: (s, motion, worst[s.name].grid) for s in structures}
    largest = {name: [(motion, one)] for name, one in worst.items()}
    for (s, opposite, _), one, is_worse in _reversed(demands, rows, limit, workers):
        largest[s.name].append((opposite, one))
        if is_worse:
            worst[s.name], rows[s.name] = one, (s, opposite, one.grid)
    ranges = {}
    for s in structures:
        one, further = worst[s.name], _largest(s, largest[s.name])
        if one.largest is None:  # the row falls, or nothing lifts
            further = None
        ranges[s.name] = OfRange(
            {
                "worst_f_g": one.frequency,
                "worst_f_g_end": one.end,
                "largest_f_g": None if further is None else further[0],
            },
            None if further is None else further[1],
        )
    return replace(
        demands,
        rows=list(rows.values()),
        shakes=[(motion, end) for end in ends],
        ranges=ranges,
        worst=worst,
    )


def _largest(
    structure: RockingParameters, found: Iterable[tuple[Motion, WorstFrequency]]
) -> tuple[float, Demand] | None:
    """Return (frequency [Hz], demand) of the largest rotation of a body, which may be
    that of the opposite direction; None without one.
    """
    from ..responses.check import standings

    some = [
        (one.largest[1], (structure, motion, one.largest[0]))
        for motion, one in found
        if one.largest is not None
    ]
    if len(some) < 2:
        return some[0] if some else None
    answers = standings([demand for _, demand in some], a_max=None)
    turned = [one.moved or 0.0 for one in answers]
    return some[turned.index(max(turned))]


def _reversed(
    demands: Demands,
    rows: Mapping[str, Demand],
    limit: Limit | None,
    workers: int | None,
) -> Iterator[tuple[Demand, WorstFrequency, bool]]:
    """Yield the demand at the worst frequency of the opposite direction, of each body
    whose sides differ, and True if this direction is worse than that of its row.
    """
    from ..dynamics.method import has_direction
    from ..responses.opposite import opposite_is_worse

    sided = [row for row in rows.values() if has_direction(row[0])]
    if not sided:
        return
    names = ", ".join(structure.name for structure, _, _ in sided)
    detail(f"the worse of both directions, because the sides differ: {names}")
    bodies, opposite = [s for s, _, _ in sided], sided[0][1].scaled(-1.0)
    assert demands.up_to is not None  # a range is stated
    low = demands.shakes[0][1]
    found = _worst(bodies, opposite, low, demands.up_to, limit, workers)
    others = [(s, opposite, found[s.name].grid) for s in bodies]
    worse = opposite_is_worse(sided, others, limit, workers)
    for row, is_worse in zip(others, worse, strict=True):
        yield row, found[row[0].name], is_worse


def _worst(
    structures: Sequence[RockingParameters],
    motion: Motion,
    low: Grid,
    high: Grid,
    limit: Limit | None,
    workers: int | None,
) -> dict[str, WorstFrequency]:
    """Return the worst frequency of each structure by its name. A body that slides and
    never rocks slides furthest at the lowest one: the slide grows with 1/f2.
    """
    from ..envelopes.frequency_search import FrequencyRange
    from ..envelopes.worst import at_worst_frequencies
    from ..structures.friction import friction_that_slides

    rocking = [s for s in structures if friction_that_slides(s) is None]
    line = ProgressLine("frequencies", "structures")
    searched = at_worst_frequencies(
        rocking, motion, low, high, limit, workers=workers, progress=line
    )
    found = {s.name: one for s, one in zip(rocking, searched, strict=True)}
    for s in structures:
        if s.name not in found:
            one = FrequencyRange.of(s, motion, low, high, None)
            found[s.name] = one.worst(one.ends[0], one.ends[0], low, high)
    return found


def opposite_outcomes(demands: Demands) -> list[tuple[str, Outcome]]:
    """Return the outcome of each body whose sides differ in the opposite direction,
    where the rows do not hold it.
    """
    from ..responses import opposite

    if demands.ranged or demands.asked.azimuth is not None or demands.sign == "both":
        return []
    return opposite.opposite_outcomes(demands.rows)


def _note_long(demands: Demands, limit: Limit | None) -> None:
    """Say before the search that a long record takes minutes, and how to do without."""
    longest = max((len(motion.segments) for motion, _ in demands.shakes), default=0)
    if limit is None or longest < _LONG:
        return
    minutes = _SEARCH * longest / 60.0
    note(
        f"a record of {longest} samples: the search takes {minutes:.1g} min or more for"
        " each structure and record; --verdict-only does without it"
    )

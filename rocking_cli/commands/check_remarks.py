"""The lines of `rocking check` below its rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from .progress import ProgressLine

if TYPE_CHECKING:
    from ..envelopes.amplitudes import Limit
    from ..envelopes.worst import BeyondTheEnd
    from ..motions import Motion
    from ..motions.grid import Grid
    from ..responses.verdict import Verdict
    from ..structures import RockingParameters
    from .check_demands import Demands

_NAMED = 3  # structures that a line names
_LISTED = 10  # that a line on all of them names, at most
_SENTENCES = 8  # bodies that slide with a line each, at most


def listed(names: list[str], most: int = _LISTED) -> str:
    """Return names with commas between them; of many the first few."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(names[:most])}{more}"


def remarks(verdicts: Sequence[Verdict], *, of_means: bool = False) -> list[str]:
    """Return the lines on which structures overturn, and what to note on the others;
    of_means: True if lines on draws stand before them.
    """
    from ..dynamics.outcome import Outcome
    from ..reports.device_words import devices_in_words

    several = len({v.motion for v in verdicts}) > 1

    def named(found: Iterable[Verdict]) -> list[str]:
        return [
            f"{v.structure} under {v.motion}" if several else v.structure for v in found
        ]

    lines = []
    if verdicts:
        overturned = named(v for v in verdicts if v.outcome.overturned)
        names = f": {listed(overturned)}" if overturned else ""
        means = "of the means, " if of_means else ""
        lost = sum(v.outcome == Outcome.LOST_CONTACT for v in verdicts)
        lose = f", {lost} lose{'s' * (lost == 1)} contact" * bool(lost)
        lines.append(
            f"{means}{len(overturned)} of {len(verdicts)} overturn{names}{lose}"
        )
    conditions = _conditions()
    told: dict[str, list[str]] = {words: [] for words, _ in conditions}
    for v in verdicts:
        for words, holds in conditions:
            if holds(v):
                told[words] += named([v])
    lines += [f"{words}: {listed(names)}" for words, names in told.items() if names]
    lines += sliding_remarks(verdicts, named)
    for v in verdicts:
        if any(device["state"] != "elastic" for device in v.devices):
            lines += [f"{named([v])[0]}: {line}" for line in devices_in_words(v)]
    if any(v.share_of_falls for v in verdicts):
        lines.append(
            "falls_nearby: this share of the amplitudes up to 5 % above"
            " first_overturning_a overturns, in many narrow intervals; narrower ones"
            " may begin below it"
        )
    return lines


def _conditions() -> list[tuple[str, Callable[[Verdict], Any]]]:
    """Return (words, condition): what is said of the verdicts for which it holds."""
    from ..dynamics.outcome import Outcome

    return [
        (
            "lose contact with the ground, and their later motion is not known",
            lambda v: v.outcome == Outcome.LOST_CONTACT,
        ),
        (
            "come to rest leaning, held by their ties, which counts as a fall",
            lambda v: v.outcome == Outcome.LEANING,
        ),
        (
            "stand in a safe window, and overturn at a lower amplitude",
            lambda v: (
                v.outcome.safe
                and v.capacity_demand is not None
                and v.capacity_demand < 1.0
            ),
        ),
        (
            (
                "depend on the last digits of the demand, as the outcome changes within"
                " 1e-6 of it"
            ),
            lambda v: v.unsettled,
        ),
        (
            (
                "lose contact with the ground during their fall, which is therefore not"
                " proved"
            ),
            lambda v: v.lost_in_fall,
        ),
        (
            (
                "open a further hinge (see response --forces), so that another"
                " mechanism follows"
            ),
            lambda v: v.opens,
        ),
        (
            "would slide, because their friction is below friction_needed",
            lambda v: v.slides and not v.coupling,
        ),
        (
            "stand by the linear equation, which is wrong",
            lambda v: v.falls and v.outcome_linear.safe,
        ),
    ]


def sliding_remarks(
    verdicts: Sequence[Verdict], named: Callable[[Iterable[Verdict]], list[str]]
) -> list[str]:
    """Return a line for each of a few bodies that slide and never rock, one for many,
    and one for each way in which bodies slide while they rock.
    """
    slid = [v for v in verdicts if v.slide is not None]
    lines = [
        f"{name}: {v.slide.words}"
        for name, v in zip(named(slid), slid, strict=True)
        if v.slide is not None
    ]
    if len(slid) > _SENTENCES:
        lines = [
            "slide before they could rock, and cannot overturn while their friction"
            f" stays below lambda: {listed(named(slid))}"
        ]
    ways = dict.fromkeys(v.coupling for v in verdicts if v.coupling)
    for way in ways:
        names = ", ".join(named(v for v in verdicts if v.coupling == way))
        lines.append(f"{names}: {way}")
    return lines


def worst_at_an_end(demands: Demands, verdicts: Sequence[Verdict]) -> Iterator[str]:
    """Yield a line for each end of the range of frequencies at which structures are
    worst.
    """
    if not demands.worst:
        return
    from ..envelopes.worst import beyond_the_end

    if slid := [v.structure for v in verdicts if v.slide is not None]:
        yield (
            "slide furthest at the lowest frequency of the range, and further under"
            f" slower motions (by 1/f2): {listed(slid)}"
        )
    of = {v.structure: v for v in verdicts if v.slide is None}
    for end, other in (("lower", "slower"), ("upper", "faster")):
        found = [
            (
                structure,
                of[structure.name],
                beyond_the_end(structure, motion, demands.worst[structure.name]),
            )
            for structure, motion, _ in demands.rows
            if structure.name in of
            and structure.name in demands.worst
            and demands.worst[structure.name].end == end
        ]
        if not found:
            continue
        frequency = demands.worst[found[0][0].name].frequency
        where = f"worst at the {end} end of the range, {frequency:.4g} Hz"
        if len(found) == 1:
            yield _at_the_end(where, other, *found[0])
        else:
            yield _several_at_the_end(where, other, found, len(verdicts))


def without_worst(demands: Demands, verdicts: Sequence[Verdict]) -> Iterator[str]:
    """Yield a line on the structures that have no worst frequency."""
    unmoved = [
        v.structure
        for v in verdicts
        if demands.worst and demands.worst[v.structure].frequency is None
    ]
    if unmoved:
        yield (
            "no worst frequency, because the demand lifts them at none:"
            f" {listed(unmoved)}"
        )


def _at_the_end(
    where: str,
    other: str,
    structure: RockingParameters,
    verdict: Verdict,
    beyond: BeyondTheEnd,
) -> str:
    """Return the line on one structure that is worst at an end; other: slower or
    faster.
    """
    from ..dynamics.outcome import Outcome

    if verdict.outcome == Outcome.NO_UPLIFT:
        said = (
            f"the demand lifts it at no frequency, and {other} motions may overturn it"
            " at lower amplitudes"
        )
    elif verdict.outcome.falls:
        said = f"it falls there; {other} motions may overturn it at lower amplitudes"
    elif beyond.overturns is not None:
        said = f"{other} motions are worse ({beyond.overturns:.3g} Hz overturns it)"
    elif beyond.larger is not None:
        said = (
            f"{other} motions rock it further (most at {beyond.larger:.3g} Hz), none"
            f" tried up to {beyond.last:.3g} Hz overturns it"
        )
    else:
        said = (
            f"no {other} motion that was tried, to {beyond.last:.3g} Hz, overturns it"
            " or rocks it further"
        )
    return f"{structure.name}: {where}; {said}"


def _several_at_the_end(
    where: str,
    other: str,
    found: Sequence[tuple[RockingParameters, Verdict, BeyondTheEnd]],
    rows: int,
) -> str:
    """Return the line on several structures that are worst at an end."""

    standing = [(s, beyond) for s, v, beyond in found if not v.outcome.falls]
    falling = [
        f"{s.name} at {b.overturns:.3g} Hz"
        for s, b in standing
        if b.overturns is not None
    ]
    said = f"{other} motions may overturn at lower amplitudes"
    if falling:
        stand = "stands" if len(falling) == 1 else "stand"
        said = (
            f"{other} motions are worse: they overturn {listed(falling, _NAMED)}, which"
            f" {stand} in this range"
        )
    elif standing:
        last = standing[0][1].last
        said = (
            f"no {other} motion that was tried, to {last:.3g} Hz, overturns those that"
            " stand here"
        )
    return f"{where}: {len(found)} of {rows} structures; {said}"


def narrow_intervals(shakes: Iterable[tuple[Motion, Grid]]) -> str:
    """Return the line on the intervals that a search for capacities may miss."""
    from ..envelopes.capacity import narrowest

    width = " or ".join(dict.fromkeys(narrowest(motion) for motion, _ in shakes))
    return (
        f"intervals narrower than {width} may be missed, also far below the capacity,"
        " but not around the demand"
    )


def inset_effects(
    verdicts: Sequence[Verdict], demands: Demands, limit: Limit
) -> Iterator[str]:
    """Yield a line for each structure on what worn edges would take of its capacity."""
    from ..reports.remarks import inset_in_words
    from ..responses.inset import effects

    line = ProgressLine("inset", "structures")
    found = list(effects(verdicts, demands.rows, limit, progress=line))
    yield from map(inset_in_words, found)
    if not found:
        yield (
            "--inset-effect: no body has a capacity that worn edges lower; those with"
            " ties or an inset of their own are left out"
        )

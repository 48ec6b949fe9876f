"""Overturning envelopes: for each frequency, every interval of amplitudes that
overturns, traced by root finding (`boundaries`).

A safe window may separate the interval that overturns after an impact from the one that
overturns without impact. Intervals narrower than 1e-3 in A, safe or overturning, may be
missed. Slow pulses (Omega below 1) have them just above uplift, motions of several
cycles wherever a body has many impacts; so the scan is finer there, which is no proof.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.method import LINEAR, Method
from ..dynamics.outcome import Outcome
from ..errors import UsageError
from ..motions import Motion, pulse
from ..motions.given import AnyMotion, motion_from
from ..motions.grid import Axis, parse_axes, scaled_frequency, written_axes
from ..processes import available_cpus, processes, refuse_endless
from ..showing import html_table
from ..structures.given import Structure, structure_from
from ..structures.parameters import RockingParameters
from .amplitudes import SCAN_STEP
from .boundaries import OutcomeSteps, Search

A_MAX = 20.0
NARROWEST = 1e-3  # no interval of this width in A is missed
HIGHEST = 100_000.0  # largest a_max; a larger scan takes too long
# signs of the ground acceleration that are tried, for bodies with unequal sides
SIGNS = {"+": (1.0,), "-": (-1.0,), "worse": (1.0, -1.0)}
NONE = "none"  # the mode of a body that no amplitude overturns
BOTH = "both"  # each sign by itself
# columns for programs; a printed table has them only if their values differ
NAMED = ("motion", "model")
INTERVAL_COLUMNS = ("structure", "Omega", "A_from", "A_to", "mode", *NAMED)
CURVE_COLUMNS = ("structure", "curve", "Omega", "A", *NAMED)
# number of amplitudes of an exact equation that take as long as one amplitude of
# another equation, and as one of those between which Lemma 15 proves the outcome
_IN_STEPS, _IN_STRETCHES = 20, 4
_SMALL = 2_000_000  # with fewer amplitudes of an exact equation one process is faster
# amplitudes of an exact equation between two reports of a process, some seconds
_SHARE = 8_000_000


class Interval(NamedTuple):
    """An interval of amplitudes that overturns a structure at one Omega.

    `trace_envelope` returns a list of them.

    Attributes
    ----------
    omega: Omega [-]
    a_from: lowest A of the interval [-]
    a_to: largest A [-], None beyond the limit of the search
    mode: "no_impact" or "after_impact", or another word of `Outcome.mode`

    Examples
    --------
    >>> first = trace_envelope(dimensionless_oscillator(eta=0.9), sine(), [3.0])[0]
    >>> f"{first.a_from:.4f} to {first.a_to:.4f}", first.mode
    ('1.4036 to 3.4847', 'after_impact')
    """

    omega: float  # Omega [-]
    a_from: float  # lowest A of the interval [-]
    a_to: float | None  # largest A [-], None beyond the limit of the search
    mode: str  # word of the outcome, as `Outcome.mode` has it

    def _repr_html_(self) -> str:
        return html_table("Interval", self._asdict())


def trace_envelope(
    structure: Structure,
    motion: AnyMotion,
    omegas: Sequence[float] | np.ndarray,
    *,
    method: Method | str = LINEAR,
    a_max: float = A_MAX,
    sign: str = "worse",
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[Interval]:
    """Return every interval of amplitudes that overturns a structure, for each Omega.

    For one sine cycle and the linear equation it is Fig. 2 (left) of the paper.
    Intervals wider than 1e-3 are found. Boundaries are traced to the last digits of the
    model's outcome. Intervals that touch but differ in mode are listed apart.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"; of
        `dimensionless_oscillator(eta=...)` only the restitution is known
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    omegas
        Omega [-], (frequencies,); under a record only 1/p, since a record has its own
        time
    method
        model and tolerance, or the name of the model
    a_max
        largest A of the search [-]
    sign
        sign of the ground acceleration, for a body with unequal sides: "+", "-", or
        "worse", which lists the intervals of either sign
    workers
        number of processes, None for all cores if that saves time
    progress
        called now and then with two counts: how much is done, and how much in all

    Returns
    -------
    list of Interval
        in the order of `omegas`, then of the amplitude

    Raises
    ------
    UsageError
        when a_max is not above the amplitude of the first uplift, or the model does
        not hold for the structure
    OutputError
        when a worker process dies

    Examples
    --------
    >>> oscillator = dimensionless_oscillator(eta=0.9)
    >>> for interval in trace_envelope(oscillator, sine(), [3.0]):
    ...     print(round(interval.a_from, 5), interval.a_to and round(interval.a_to, 5))
    1.40357 3.48466
    3.63115 None
    """
    structure = structure_from(structure)
    motion, method = motion_from(motion), Method.of(method)
    omegas = np.ravel(np.asarray(omegas, dtype=float))
    if not omegas.size:
        raise UsageError("`omegas`: found no numbers; expected one or more")
    if (
        motion.acceleration is not None
        and not structure.dimensionless
        and np.any(np.abs(omegas * structure.p - 1.0) > 1e-9)
    ):
        raise UsageError(
            f"{motion.name}: a record runs in its own time; expected Omega = 1/p ="
            f" {1.0 / structure.p:.6g} alone"
        )
    searches, amplitudes = _scan_of(motion, omegas.size, structure, method, a_max, sign)
    if workers is not None and workers < 1:
        raise UsageError(f"`workers`: found {workers}; expected a whole number from 1")
    work = amplitudes * _effort(method, searches)
    if workers is None:
        workers = 1 if work < _SMALL else available_cpus()
    # Neighbouring frequencies cost about the same, so each share takes frequencies from
    # the whole range.
    shares = int(min(omegas.size, max(workers, np.ceil(work / _SHARE))))
    found: list[list[Interval]] = [[] for _ in omegas]
    parts = [omegas[i::shares] for i in range(shares)]
    for i, rows in enumerate(
        in_turn(partial(merged, searches), parts, min(workers, shares))
    ):
        for at, steps in zip(range(i, omegas.size, shares), rows, strict=True):
            found[at] = list(intervals_of(float(omegas[at]), steps))
        if progress:
            progress((i + 1) * omegas.size // shares, omegas.size)
    return [interval for row in found for interval in row]


def _effort(method: Method, searches: Sequence[Search]) -> int:
    """The time of an amplitude over that of one of an exact equation."""
    if method.exact:
        return 1
    from .stretches import AmplitudeStretches

    supports = AmplitudeStretches.supports
    stretches = all(supports(one.system, one.motion) for one in searches)
    return _IN_STRETCHES if stretches else _IN_STEPS


def merged(searches: Sequence[Search], omegas: np.ndarray) -> list[OutcomeSteps]:
    """The outcomes of several searches at each Omega; each amplitude has the worst of
    their outcomes. Empty without searches.
    """
    rows: list[OutcomeSteps] = [[] for _ in omegas]
    for search in searches:
        rows = [
            worse(one, other)
            for one, other in zip(rows, search.rows(omegas), strict=True)
        ]
    return rows


def worse(one: OutcomeSteps, other: OutcomeSteps) -> OutcomeSteps:
    """The worse of two outcomes at each amplitude: safe if both are safe, failed if one
    has failed and the other is safe.
    """
    if not one:
        return other
    order = [
        o.value for o in sorted(Outcome, key=lambda o: (not o.safe, o.overturned, o))
    ]
    merged: OutcomeSteps = []
    for amplitude in sorted({a for a, _ in (*one, *other)}):
        labels = [
            next(
                (label for a, label in reversed(steps) if a <= amplitude),
                int(Outcome.NO_UPLIFT),
            )
            for steps in (one, other)
        ]
        label = max(labels, key=order.index)
        if not merged or merged[-1][1] != label:
            merged.append((amplitude, label))
    return merged


def _scan_of(
    motion: Motion,
    frequencies: int,
    structure: RockingParameters,
    method: Method,
    a_max: float,
    sign: str,
) -> tuple[list[Search], float]:
    """(a search for each sign of the motion, a bound of the number of amplitudes that
    they compute together). Raises UsageError.
    """
    if sign not in SIGNS:
        raise UsageError(f"`sign`: found {sign!r}; expected {', '.join(SIGNS)}")
    if motion.vertical is not None and structure.dimensionless:
        raise UsageError(
            "a restitution alone has no weight that a vertical motion could change:"
            " give a structure document"
        )
    system = method.system_of(structure)
    factors = (1.0,) if system.alike else SIGNS[sign]
    searches = [
        Search(system, motion.scaled(f) if f < 0.0 else motion, a_max) for f in factors
    ]
    lowest = min(search.uplift for search in searches)
    if not np.isfinite(a_max) or a_max <= lowest < np.inf:
        raise UsageError(
            f"a-max: found {a_max:g}; expected a finite amplitude above the uplift at A"
            f" = {lowest:g}"
        )
    if a_max > HIGHEST:
        raise UsageError(f"a-max: found {a_max:g}; expected up to {HIGHEST:g}")
    # A sign that lifts no body below a_max needs no search.
    searches = [search for search in searches if search.uplift < a_max]
    amplitudes = frequencies * sum(
        (a_max - search.uplift) / SCAN_STEP for search in searches
    )
    refuse_endless(amplitudes, len(motion.segments))
    return searches, amplitudes


def check_intervals(
    structure: RockingParameters,
    motion: Motion,
    axis: Axis,
    *,
    method: Method = LINEAR,
    a_max: float = A_MAX,
    sign: str = "worse",
) -> None:
    """Raises those errors of `structure_intervals` that are known before the search
    begins.
    """
    _scan_of(
        motion,
        _scaled(structure, axis).size,
        structure,
        method,
        a_max,
        "worse" if sign == BOTH else sign,
    )


def in_turn(
    search: Callable[[Any], Any],
    shares: Sequence[Any],
    workers: int,
    parts: Callable[[float], None] | None = None,
) -> Iterator[Any]:
    """Runs a search on each share of the work in `workers` processes; yields the
    results in the order of the shares; parts: as of `processes`.
    """
    if workers == 1:
        yield from map(search, shares)
        return
    with processes(workers, search, "fewer `workers` need less", parts) as run:
        yield from run(shares)


def intervals_of(omega: float, steps: OutcomeSteps) -> Iterator[Interval]:
    """Yield the intervals that overturn."""
    for n, (begin, label) in enumerate(steps):
        end = steps[n + 1][0] if n + 1 < len(steps) else None
        if not Outcome(label).safe:
            yield Interval(omega, begin, end, Outcome(label).mode)


def frequency_axis(text: str | None) -> Axis:
    """Parses the single frequency axis of `--grid`: Omega, omega_g, f_g or T_g. Raises
    UsageError.
    """
    if text is None:
        raise UsageError("no `grid`; expected one axis, Omega, omega_g, f_g or T_g")
    axes = parse_axes(text)
    if len(axes) != 1 or next(iter(axes)) not in ("Omega", "omega_g"):
        raise UsageError(
            f"`grid`: found {written_axes(text)}; expected one axis, Omega, omega_g,"
            " f_g or T_g"
        )
    return next(iter(axes.values()))


def _scaled(structure: RockingParameters, axis: Axis) -> np.ndarray:
    if structure.dimensionless and axis.name != "Omega":
        raise UsageError(
            "a restitution alone has no units: give a structure document, or the axis"
            " Omega"
        )
    return scaled_frequency(axis, structure)


def structure_intervals(
    structure: RockingParameters,
    motion: Motion,
    axis: Axis,
    *,
    method: Method = LINEAR,
    sign: str = "worse",
    lowest: bool = False,
    **more: Any,
) -> Iterator[dict[str, Any]]:
    """Yield the rows of a structure's overturning intervals, with units if it has any;
    mode is `NONE` where nothing overturns. Raises as `trace_envelope`.

    Parameters:
        sign: as of `trace_envelope`, or "both", which adds the sign, 1 or -1, to each
            row, None if its sides are equal
        lowest: True for the lowest interval of each frequency only
        more: arguments of `trace_envelope`
    """
    omegas = _scaled(structure, axis)
    apart = sign == BOTH and not method.system_of(structure).alike
    for one in ("+", "-") if apart else ("worse" if sign == BOTH else sign,):
        rows: dict[float, list[tuple[float | None, float | None, str]]] = {
            float(omega): [] for omega in omegas
        }
        for found in trace_envelope(
            structure, motion, omegas, method=method, sign=one, **more
        ):
            rows[found.omega].append(found[1:])
        for omega, intervals in rows.items():
            for low, high, mode in (intervals[:1] if lowest else intervals) or [
                (None, None, NONE)
            ]:
                record: dict[str, Any] = {
                    "structure": structure.name,
                    "Omega": omega,
                    "A_from": low,
                    "A_to": high,
                    "mode": mode,
                }
                if sign == BOTH:
                    record["sign"] = int(SIGNS[one][0]) if apart else None
                if not structure.dimensionless:
                    record["omega_g"] = omega * structure.p
                    for key, amplitude in (("a_from", low), ("a_to", high)):
                        record[key] = (
                            None
                            if amplitude is None
                            else structure.ground_acceleration(amplitude)
                        )
                yield record | {"motion": motion.name, "model": method.model}


def misjudged(
    linear: Sequence[Mapping[str, Any]],
    nonlinear: Sequence[Mapping[str, Any]],
    *,
    a_max: float,
) -> tuple[float, float, float]:
    """Return the lengths in A, summed over the frequencies, over which the linear
    equation stands and the nonlinear one falls, the nonlinear one falls, and the linear
    one falls and the other one stands. linear, nonlinear: the rows of
    `structure_intervals` up to a_max.
    """

    def intervals(
        records: Sequence[Mapping[str, Any]], key: Any
    ) -> list[tuple[float, float]]:
        mine = [
            r
            for r in records
            if (r["Omega"], r.get("sign")) == key and r["mode"] != NONE
        ]
        return [(r["A_from"], a_max if r["A_to"] is None else r["A_to"]) for r in mine]

    unsafe = falls = alarms = 0.0
    for key in {(r["Omega"], r.get("sign")) for r in (*linear, *nonlinear)}:
        both = intervals(linear, key), intervals(nonlinear, key)
        # Between two neighbouring ends of intervals neither outcome changes.
        edges = np.unique(
            [edge for one in both for interval in one for edge in interval]
        )
        middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        by_linear, by_nonlinear = (
            sum(
                ((low < middle) & (middle < high) for low, high in one),
                np.zeros(middle.shape, dtype=bool),
            )
            for one in both
        )
        unsafe += float(width[~by_linear & by_nonlinear].sum())
        falls += float(width[by_nonlinear].sum())
        alarms += float(width[by_linear & ~by_nonlinear].sum())
    return unsafe, falls, alarms


def check_curves(structure: RockingParameters, motion: Motion, axis: Axis) -> None:
    """Raises those errors of `structure_curves` that are known before it begins."""
    _scaled(structure, axis)
    _closed_form_of(motion)
    if not structure.plain:
        raise UsageError(
            f"{structure.name}: `closed_form`: found damping, one side, unequal sides,"
            " ties or a tendon; expected a body without them"
        )


def _closed_form_of(motion: Motion) -> str:
    """Return the name of the pulse of `closed_form` that a motion is. Raises UsageError
    for another motion.
    """
    from .closed_form import PULSES

    forms = {pulse(name).pieces: name for name in PULSES}
    if motion.vertical is not None or motion.pieces not in forms:
        raise UsageError(
            f"`closed_form`: found {motion.name}; expected a sine of 1 cycle, a half"
            " sine or a rectangular pulse"
        )
    return forms[motion.pieces]


def structure_curves(
    structure: RockingParameters, motion: Motion, axis: Axis
) -> Iterator[dict[str, Any]]:
    """Yields rows of the closed-form curves for a structure. Raises UsageError if there
    is no closed form.
    """
    from .closed_form import closed_form_curves

    for point in closed_form_curves(
        _scaled(structure, axis), structure.eta, _closed_form_of(motion)
    ):
        row = {
            "structure": structure.name,
            "curve": point.curve,
            "Omega": point.omega,
            "A": point.amplitude,
        }
        yield row | {"motion": motion.name, "model": LINEAR.model}

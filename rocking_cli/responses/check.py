"""The verdict on a structure under one motion: its outcome, the capacity it has left,
and the outcome by the linear equation.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from ..dynamics.method import Method
from ..dynamics.outcome import Outcome
from ..envelopes.amplitudes import LONGEST_FINE, Limit, limit_of
from ..envelopes.capacity import Capacity, CapacitySearch, capacities
from ..envelopes.intervals import A_MAX
from ..errors import UsageError
from ..motions import Motion
from ..motions.floors import on_floors
from ..motions.given import AnyMotion, demand_of
from ..motions.grid import Grid
from ..processes import available_cpus, part_reporter, processes
from ..structures.friction import friction_that_slides
from ..structures.given import Structure, structure_from
from ..structures.parameters import RockingParameters
from .contact_forces import ContactForces
from .known_shares import KnownShares
from .shaken import (
    Shaken,
    answer_of,
    answers_together,
    capacity_search,
    least_acceleration,
    respond,
)
from .time_history import time_history
from .verdict import FLOOR_COLUMNS, Verdict

if TYPE_CHECKING:
    from .sliding import SlideHistory

Demand = tuple[RockingParameters, Motion, Grid]
# Called with the number of finished stages, of which a part counts as a fraction, and
# of all.
Progress = Callable[[float, int], None]
Judged = TypeVar("Judged")  # what is found of a demand


class OfRange(NamedTuple):
    """What a range of frequencies or azimuths adds to the verdict on a demand."""

    columns: Mapping[str, float | str | None]  # as `ranged` of `Verdict`
    # the demand of the range under which the rotation is largest, None if the body
    # falls or does not lift
    largest: Demand | None


_STAGES = 3  # of a verdict: responses, search, history
_SEARCHED = 0.95  # of a verdict whose search is long: about its share
_LAST = 0.01  # of a verdict, which counts when it has come from its process
_TOGETHER = 12  # demands that share a scan, at most
_MANY = 20  # demands from which on they are marched together, not one by one
_BLOCK = 2048  # of many demands, that are marched together
_WORTH = 3  # demands under pulses for each process that is started, at least


def check(
    structure: Structure,
    motion: AnyMotion,
    shaking: Grid | str | None = None,
    *,
    a_max: float | None = A_MAX,
    progress: Progress | None = None,
) -> Verdict:
    """Return whether a structure stands under a motion, and by which margin.

    The governing equation decides: the nonlinear one (Eqs. 2.3, 3.4) if the geometry is
    known and the motion has units, else the linear one (Eqs. 2.4, 3.6).

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    shaking
        the demand: amplitude and frequency, a grid of one cell or its text; a record
        does not need it
    a_max
        A up to which overturning amplitudes are searched [-], or twice the demand if
        that is larger; None: no search
    progress
        called with the number of finished stages, of which a part counts as a fraction,
        and of all (responses, search, forces)

    Returns
    -------
    Verdict

    Raises
    ------
    UsageError
        for a demand of zero, for one above the limit of the search, and for a structure
        without units

    Notes
    -----
    The amplitudes that overturn a body are intervals: above the first one it may stand
    again. `capacity_demand` below 1 with the outcome "rocked" says so.

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> verdict = check(column, sine(), parse_grid("a_g=0.35g,f_g=1.5"))
    >>> verdict.outcome.flag, round(verdict.capacity_demand, 4)
    ('rocked', 1.1149)
    """
    demand = structure_from(structure), *demand_of(motion, shaking)
    (verdict,) = _each(
        _judged,
        a_max,
        False,
        [demand],
        lambda done: progress(_STAGES * done, _STAGES) if progress else None,
    )
    return verdict


def outcome_alone(
    structure: RockingParameters, motion: Motion, shaking: Grid
) -> Outcome:
    """Return only the outcome of the verdict of `check`."""
    if friction_that_slides(structure) is not None:
        return _slide(structure, motion, shaking).outcome
    _, _, amplitude, omega, method, _ = capacity_search(structure, motion, shaking, 0.0)
    return Outcome(
        int(respond(method, structure, motion, np.array([amplitude]), omega).outcome[0])
    )


def _slide(
    structure: RockingParameters, motion: Motion, shaking: Grid
) -> "SlideHistory":
    """Return the sliding of a structure that slides."""
    from .sliding import slide_history

    slide = slide_history(structure, motion, shaking)
    assert slide is not None  # it slides
    return slide


def first_overturning(
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
    a_max: float,
    near: float,
) -> float | None:
    """Return the lowest amplitude that overturns a body [m/s2], None without one; near:
    a guess of it [m/s2], which saves time.
    """
    asked = capacity_search(structure, motion, shaking, a_max)
    near = min(
        float(structure.dimensionless_amplitude(near)),
        max(asked.amplitude, 0.5 * a_max),
    )
    found = (
        asked._replace(amplitude=near, a_max=max(a_max, 2.0 * asked.amplitude))
        .capacity()
        .first
    )
    return None if found is None else float(structure.ground_acceleration(found))


class Standing(NamedTuple):
    """Whether a body stands under a demand, and how much more it bears."""

    outcome: Outcome  # by the governing equation
    capacity_demand: float | None  # as of `Verdict`
    # theta_ratio [-], of a body that slides its slide [m]; None if it falls
    moved: float | None
    narrow: bool = False  # True if many narrow intervals overturn the body

    @property
    def falls(self) -> bool:
        """True if the body overturned, lost contact or rests leaning."""
        return self.outcome.falls

    @property
    def severity(self) -> tuple[bool, float, float]:
        """Of two demands the worse one has the larger one: it falls, or has the lesser
        capacity, or else moves further.
        """
        needs = 1.0 / self.capacity_demand if self.capacity_demand else 0.0
        return not self.outcome.safe, needs, self.moved or 0.0


def _standing(
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
    a_max: float | None,
    found: Capacity | None,
    answer: Shaken | None,
    done: Callable[[float], None],
) -> Standing:
    """Return the outcome, the capacity over the demand and the rotation of `check`,
    without the other fields of its verdict; parameters as of `_judged`.
    """
    if friction_that_slides(structure) is not None:
        slide = _slide(structure, motion, shaking)
        return Standing(slide.outcome, None, slide.slide_max)
    if answer is None:
        answer = answer_of(capacity_search(structure, motion, shaking, a_max or 0.0))
    rotation = float(answer.theta_ratio[0])
    moved = rotation if math.isfinite(rotation) else None
    if a_max is None:
        return Standing(answer.outcome, None, moved)
    assert found is not None  # a search is asked for
    first, _ = answer.lowest(found)
    demand = float(structure.ground_acceleration(answer.search.amplitude))
    capacity = None if first is None else first / demand
    return Standing(answer.outcome, capacity, moved, found.share_of_falls > 0.0)


def _judged(
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
    a_max: float | None,
    found: Capacity | None,
    answer: Shaken | None,
    done: Callable[[float], None],
    forces: bool = True,
) -> Verdict:
    """Return the verdict of `check`; found: the capacity, None without a search;
    answer: of `answers_together`, None if it is not known; done: called with the share
    of the verdict that is known; forces: as of `verdicts`.
    """
    if answer is None:
        answer = answer_of(capacity_search(structure, motion, shaking, a_max or 0.0))
    search, method = answer.search, answer.search.method
    done(1 / _STAGES)

    searched, free = None, None
    if a_max is None:
        least = answer.uplift if math.isfinite(answer.uplift) else None
        found = Capacity(None, None, least)
    else:
        assert found is not None
        searched = least_acceleration(structure, search.ends()[1])
        if structure.restraints:
            bare = search._replace(structure=replace(structure, restraints=None))
            free = bare.capacity().first
    first, safe_to = (None, None) if a_max is None else answer.lowest(found)
    done(2 / _STAGES)
    if forces or not _turns_as_a_block(structure):
        asked = _of_history(method, structure, motion, shaking)
    else:
        asked = _of_rotation(structure, answer)
    if first is not None and asked.get("devices"):
        asked["devices"] = _to_capacity(asked["devices"], search, first)
    done(1.0)

    rotation, needed = (
        float(answer.theta_ratio[0]),
        asked.get("friction_needed"),
    )
    verdict = Verdict(
        structure=structure.name,
        motion=motion.name,
        model=method.model,
        outcome=answer.outcome,
        theta_ratio=rotation if np.isfinite(rotation) else None,
        demand_a=float(structure.ground_acceleration(search.amplitude)),
        uplift_a=least_acceleration(structure, found.uplift),
        first_overturning_a=first,
        safe_to=safe_to,
        outcome_linear=answer.linear,
        unsettled=answer.unsettled,
        share_of_falls=found.share_of_falls,
        searched_to=searched,
        first_overturning_a_free=least_acceleration(structure, free),
        slides=structure.friction is not None and (needed or 0.0) > structure.friction,
        omega_g=None if motion.acceleration is not None else search.omega * structure.p,
        **asked,
        **_of_floor(motion, float(structure.ground_acceleration(search.amplitude))),
    )
    if structure.friction is None:
        return verdict
    from .sliding import with_sliding

    return with_sliding(verdict, structure, motion, shaking)


def _to_capacity(
    devices: tuple[dict[str, Any], ...], search: CapacitySearch, first: float
) -> tuple[dict[str, Any], ...]:
    """Return the rows of ties and a tendon with what the first overturning amplitude
    [m/s2] adds to them.
    """
    from .tied_history import with_capacity

    return with_capacity(
        devices,
        search.method.system_of(search.structure),
        search.motion,
        float(search.structure.dimensionless_amplitude(first)),
        search.omega,
    )


def _of_floor(motion: Motion, a_g: float) -> dict[str, Any]:
    """Return FLOOR_COLUMNS of the motion of a floor at an amplitude [m/s2]; empty on
    the ground.
    """
    if motion.floor is None:
        return {}
    values = a_g * motion.largest, motion.floor.chord
    return dict(zip(FLOOR_COLUMNS, values, strict=True))


def verdicts(
    demands: Sequence[Demand],
    *,
    ranges: Mapping[str, OfRange] | None = None,
    a_max: float | Limit | None = A_MAX,
    workers: int | None = None,
    progress: Progress | None = None,
    forces: bool = True,
) -> Iterator[Verdict]:
    """Yield the verdict on each demand (structure, motion, shaking), in their order, as
    soon as it is found.

    ranges: what a range adds, by the name of the structure, which has one demand;
    a_max: an A, or an acceleration for every structure, None for no search; workers:
    number of processes, None for all cores if that saves time; progress: called with
    the number of finished checks, of which a part counts as a fraction, and of all;
    forces: False to leave out friction_needed, fz_min and lost_in_fall of blocks with
    two equal edges, for which the body is marched once more. Raises as `check` does,
    and OutputError when a worker process dies.
    """
    judge = partial(_judged, forces=forces)
    if not ranges:
        yield from _dealt(judge, demands, a_max, workers, progress)
        return
    of_ranges = [ranges.get(structure.name) for structure, _, _ in demands]
    further = [one.largest for one in of_ranges if one and one.largest]
    largest = iter(list(_dealt(judge, further, None, workers, None)))
    found = _dealt(judge, demands, a_max, workers, progress)
    for verdict, one in zip(found, of_ranges, strict=True):
        yield verdict if one is None else _with_range(verdict, one, largest)


def _with_range(verdict: Verdict, one: OfRange, largest: Iterator[Verdict]) -> Verdict:
    """Return the verdict with the largest rotation of the range; largest: the verdicts
    on the demands `largest`, in the order of the rows.
    """
    found = replace(verdict, ranged=one.columns)
    if one.largest is None:
        return found
    there = next(largest)
    return replace(
        found,
        theta_ratio=there.theta_ratio,
        top_displacement=there.top_displacement,
        unsettled=verdict.unsettled or there.unsettled,
        outcome=there.outcome if there.falls else verdict.outcome,
    )


def standings(
    demands: Sequence[Demand],
    *,
    a_max: float | Limit | None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Iterator[Standing]:
    """Yield outcome, capacity and rotation of the verdict on each demand, as `verdicts`
    does, in less time: nothing else is computed.
    """
    yield from _dealt(_standing, demands, a_max, workers, progress)


def _dealt(
    judge: Callable[..., Judged],
    demands: Sequence[Demand],
    a_max: float | Limit | None,
    workers: int | None,
    progress: Progress | None,
) -> Iterator[Judged]:
    """Yield what `judge` says of each demand, in their order; processes share them."""
    done = progress or _no_progress
    several, groups = _groups(demands, a_max is not None, workers)
    many = len(demands) >= _MANY
    if several == 1:
        before = 0
        for group in groups:
            told = partial(_after, done, before, len(demands))
            yield from _each(judge, a_max, many, group, told)
            before += len(group)
        return
    known = 0.0  # verdicts, of those under way the parts that are known

    def tell(reported: float) -> None:
        nonlocal known
        known = max(known, reported)
        done(known, len(demands))

    def parts(reported: float) -> None:
        tell(min(reported, len(demands) - _LAST))

    task, advice = partial(_all, judge, a_max, many), "fewer `workers` need less"
    with processes(several, task, advice, parts) as run:
        for i, verdict in enumerate(chain.from_iterable(run(groups)), 1):
            tell(i)
            yield verdict


def _groups(
    demands: Sequence[Demand], searched: bool, workers: int | None
) -> tuple[int, Iterator[Sequence[Demand]]]:
    """Return (the number of processes, the demands that each judges at a time): the
    searches of a group share their scans, and all groups have one size.
    """
    under_records = searched and any(
        len(motion.segments) > LONGEST_FINE for _, motion, _ in demands
    )
    worth = 1 if workers or under_records else _WORTH
    several = max(1, min(workers or available_cpus(), len(demands) // worth))
    most = _BLOCK if len(demands) >= _MANY else _TOGETHER if searched else 1
    rounds = math.ceil(len(demands) / (several * most))
    size = max(1, math.ceil(len(demands) / (several * max(1, rounds))))
    size = min(size, most)
    each = iter(demands)
    return several, iter(lambda: list(islice(each, size)), [])


def _no_progress(done: float, total: int) -> None:
    """Show no progress."""


def _after(progress: Progress, before: int, checks: int, done: float) -> None:
    """Call `progress` with the number of finished checks and of all; before: those
    before the present group, done: those in it.
    """
    progress(before + done, checks)


def _each(
    judge: Callable[..., Judged],
    a_max: float | Limit | None,
    many: bool,
    demands: Sequence[Demand],
    tell: Callable[[float], None],
) -> Iterator[Judged]:
    """Yield what `judge` says of several demands; their searches share their scans,
    and, if they are of many, their answers one march. tell: called with the number of
    those that are known.
    """
    shares, demands = KnownShares(len(demands), tell), on_floors(demands)
    most = [
        None if a_max is None else limit_of(a_max, structure)
        for structure, _, _ in demands
    ]
    searches = [
        capacity_search(*demand, a or 0.0)
        for demand, a in zip(demands, most, strict=True)
    ]
    found: Iterable[Capacity | None] = [None] * len(demands)
    if a_max is not None:
        found = capacities(searches, lambda i, share: shares.grow(i, _SEARCHED * share))
    answers: Sequence[Shaken | None] = [None] * len(demands)
    if many:
        answers = answers_together(searches)
    rows = zip(demands, most, found, answers, strict=True)
    for i, (demand, *known) in enumerate(rows):
        yield judge(*demand, *known, shares.of(i))


def _all(
    judge: Callable[..., Judged],
    a_max: float | Limit | None,
    many: bool,
    demands: Sequence[Demand],
) -> list[Judged]:
    """Return what `judge` says of several demands in a worker process."""
    return list(_each(judge, a_max, many, demands, part_reporter()))


def _turns_as_a_block(structure: RockingParameters) -> bool:
    """True for a rigid body on two equal edges without ties, whose top is as far from
    both, and whose sliding is not asked for.
    """
    return (
        structure.plain
        and structure.mechanism is None
        and structure.friction is None
        and len(set(structure.top)) == 1
    )


def _of_rotation(structure: RockingParameters, answer: Shaken) -> dict[str, Any]:
    """Return top_displacement of a body that turns as a block."""
    if not answer.outcome.safe:
        return {"top_displacement": None}
    turned = structure.alpha * float(answer.theta_ratio[0])
    return {"top_displacement": 2.0 * structure.top[0] * math.sin(0.5 * turned)}


def _of_history(
    method: Method, structure: RockingParameters, motion: Motion, shaking: Grid
) -> dict[str, Any]:
    """Return friction_needed, fz_min, top_displacement, devices and lost_in_fall, or
    opens and friction_needed (of a mechanism, unless forces are not known), from the
    history, which goes on to `FALLEN`.
    """
    linked = (
        structure.mechanism is not None
        and method.model == "nonlinear"
        and not structure.damping
    )
    if (
        structure.arm is None
        and not structure.top
        and not structure.restraints
        and not linked
    ):
        return {}
    found = time_history(structure, motion, shaking, [method])
    if linked:
        try:
            forces = found.forces[method.model]
        except UsageError:  # they are not unique
            return {}
        if isinstance(forces, ContactForces):
            return {}
        opens: dict[str, Any] = {"opens": forces.opens()}
        if structure.friction is not None:
            row = forces.summary("tau", 1.0)
            opens["friction_needed"] = row["friction_needed"]
        return opens
    own = found.histories[method.model]
    devices = own.devices
    top: dict[str, Any] = {
        "top_displacement": found.top_displacement(method.model),
        **({"devices": devices} if devices else {}),
    }
    if own.outcome.overturned and own.lost is not None:
        top["lost_in_fall"] = True
    if structure.arm is None:
        return top
    asked = found.forces[method.model].summary("tau", 1.0)
    of_forces = {key: asked[key] for key in ("friction_needed", "fz_min")}
    if own.outcome.overturned and asked["fz_min"] <= 0.0:
        top["lost_in_fall"] = True
    return top | of_forces

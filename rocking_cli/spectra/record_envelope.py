"""Overturning scales of records: the intervals of each structure, or of each (alpha, 2
pi/p), and their quantiles over the records.

Under a record a body overturns after many impacts. Its intervals have no least width,
and a cell costs as much as a thousand cells of a pulse. The ratio of neighbouring
amplitudes of the scan is therefore 1 + `RATIO`; narrower intervals may be missed.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Outcome
from ..envelopes.amplitudes import Limit, limit_of
from ..envelopes.boundaries import OutcomeSteps, Search
from ..envelopes.capacity import RATIO, tracing_width
from ..envelopes.first_falls import Climb, lowest_falls
from ..envelopes.intervals import (
    A_MAX,
    BOTH,
    HIGHEST,
    NONE,
    SIGNS,
    frequency_axis,
    in_turn,
    intervals_of,
    structure_intervals,
    worse,
)
from ..envelopes.record_changes import RecordSearch, steps_under_records
from ..errors import UsageError
from ..motions import Motion
from ..motions.given import AnyMotion, read_if_named, recordings_from
from ..motions.grid import Axis
from ..processes import available_cpus
from ..structures.given import Structure, structure_from
from .record_scene import RecordScene, structures_scene

# parts of a bracket in one cut: there are few brackets, and a batch costs the same for
# any size
_PARTS = 128
_STRETCH = 80  # amplitudes computed together in a search for the first fall
_SMALL = 20_000  # cells below which starting processes takes longer than they save


@dataclass(frozen=True)
class Task:
    """One piece of the work."""

    record: int  # index of the record
    structure: int  # index of the structure
    omegas: tuple[int, ...]  # indices of some of its Omegas
    sign: str  # sign of the ground acceleration


@dataclass(frozen=True)
class Tracing:
    """A scene of records whose overturning intervals are searched. Raises UsageError
    for a limit or columns that the search cannot take.
    """

    scene: RecordScene  # its columns are T, or are not used
    a_max: float | Limit = A_MAX  # upper end of the search
    first: bool = False  # True: search only the lowest overturning amplitude

    def __post_init__(self) -> None:
        columns = self.scene.columns
        for most in map(self.limit, range(len(self.scene.structures))):
            if not (math.isfinite(most) and 0.0 < most <= HIGHEST):
                raise UsageError(
                    f"a-max: found {most:g}; expected a positive amplitude up to"
                    f" {HIGHEST:g}"
                )
        if columns.name != "T" and columns.values.tolist() != [1.0]:
            raise UsageError(
                f"`grid`: found {columns.name}; expected no axis, since the search"
                " varies the scale"
            )

    def limit(self, structure: int) -> float:
        """Return the largest A of the search for a structure."""
        return limit_of(self.a_max, self.scene.structures[structure])

    @property
    def most(self) -> str:
        """The limit of the search in words."""
        return (
            f"{self.a_max.value:g} m/s2"
            if isinstance(self.a_max, Limit) and self.a_max.acceleration
            else f"A = {self.limit(0):g}"
        )

    def omegas(self, structure: int) -> Array:
        """Omega = 1/p [s/rad] of the structure, or of each size of the grid."""
        if self.scene.over_angles:
            return self.scene.columns.values / (2.0 * np.pi)
        return np.array([1.0 / self.scene.structures[structure].p])

    def __call__(self, task: Task) -> list[OutcomeSteps]:
        """Return for each Omega of a task the changes (amplitude, outcome from there
        on), rising; none if no amplitude lifts the body.
        """
        structure = self.scene.structures[task.structure]
        motion = self.scene.recordings[task.record].motion
        system = self.scene.method.system_of(structure)
        digits = tracing_width(self.scene.method, motion)
        omegas = self.omegas(task.structure)[list(task.omegas)]
        most = self.limit(task.structure)
        found: list[OutcomeSteps] = [[] for _ in omegas]
        # A body with unequal sides has other outcomes under the reversed record; of two
        # signs the worse outcome counts.
        for factor in (1.0,) if system.alike else SIGNS[task.sign]:
            under = motion if factor > 0.0 else motion.scaled(factor)
            search = Search(
                system,
                under,
                most,
                ratio=RATIO,
                digits=digits,
                parts=_PARTS,
            )
            if search.uplift < most:
                rows = (
                    _first_falls(search, omegas)
                    if self.first
                    else steps_under_records(
                        [RecordSearch(search, omega) for omega in omegas.tolist()]
                    )
                )
                found = [
                    worse(known, steps)
                    for known, steps in zip(found, rows, strict=True)
                ]
        return found


def _first_falls(search: Search, omegas: Array) -> list[OutcomeSteps]:
    """The outcome at the lowest amplitude and at the first fall at each Omega."""
    uplift, most = (np.full(omegas.size, x) for x in (search.uplift, search.a_max))
    found = lowest_falls(
        lambda row, amplitude: search.respond(amplitude, omegas[row]),
        Climb(uplift, most, uplift, search.ratio),
        search.digits,
        stretch=_STRETCH,
    )
    rows = zip(found.amplitude.tolist(), found.outcome.tolist(), strict=True)
    begin = search.uplift, int(Outcome.ROCKED)
    return [[begin, fall] if math.isfinite(fall[0]) else [begin] for fall in rows]


def tracing_rows(
    tracing: Tracing,
    *,
    sign: str = "worse",
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Rows of the overturning intervals, in the order of records and structures. A row
    has record; structure, or alpha [rad] and T = 2 pi/p [s]; the ends as dimensionless
    amplitudes A_from and A_to, as peaks of the ground a_from and a_to [m/s2], and as
    factors of the original record scale_from and scale_to (A_to, a_to and scale_to None
    if the interval continues beyond a_max); mode. With `first` only the first interval,
    without its end; A_from None and mode "none" if no amplitude overturns. sign "both"
    adds `sign`, None if the sides are equal. Raises OutputError when a worker process
    dies.
    """
    scene = tracing.scene
    tasks = list(_tasks(tracing, sign, 1))
    cells = sum(
        len(task.omegas) * math.log(max(2.0, tracing.limit(task.structure)))
        for task in tasks
    ) / math.log1p(RATIO)
    # Few tasks are cut into shares of their frequencies, so that all processes work.
    workers = workers or (1 if cells < _SMALL else available_cpus())
    if len(tasks) < 4 * workers:
        tasks = list(_tasks(tracing, sign, workers))
    for n, (task, found) in enumerate(
        zip(tasks, in_turn(tracing, tasks, min(workers, len(tasks))), strict=True), 1
    ):
        for column, steps in zip(task.omegas, found, strict=True):
            yield from _rows(scene, task, column, steps, tracing.first, sign == BOTH)
        if progress:
            progress(n, len(tasks))


def envelope(
    structure: Structure,
    motion: AnyMotion,
    axis: Axis | str | None = None,
    *,
    method: Method | str | None = None,
    a_max: float = A_MAX,
    sign: str = "worse",
    workers: int | None = None,
) -> list[dict[str, Any]]:
    """Return every interval of amplitudes that overturns a structure, as rows with
    units.

    For one sine cycle and the linear equation it is Fig. 2 (left) of the paper.
    `trace_envelope` returns the same intervals over A and Omega.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"
    motion
        a pulse, or a record, whose scale is varied: an object, the name of a pulse, or
        a path
    axis
        of frequencies, or its text such as "f_g=0.5:5:10"; None for a record
    method
        model and tolerance, or the name of the model; None for the nonlinear model if
        the geometry is known and the axis has units, else the linear one
    a_max
        largest A of the search [-]
    sign
        sign of the ground acceleration, for a body with unequal sides: "+", "-", or
        "worse", which lists the intervals of either sign
    workers
        number of processes, None for all cores if that saves time

    Returns
    -------
    list of dict
        rows of `rocking envelope`: structure, A_from, A_to [-], mode, a_from, a_to
        [m/s2] and, of a pulse, Omega [-] and omega_g [rad/s]

    Raises
    ------
    UsageError
        for a pulse without an axis and a record with one, when a_max is not above the
        amplitude of the first uplift, or the model does not hold for the structure
    OutputError
        when a worker process dies

    Examples
    --------
    >>> (structure,) = load_structures("configs/parameters.yaml")
    >>> rows = envelope(structure, sine(), "f_g=1.5")
    >>> [(round(row["a_from"], 3), row["mode"]) for row in rows]
    [(11.734, 'after_impact'), (26.953, 'no_impact')]
    """
    structure = structure_from(structure)
    axis = frequency_axis(axis) if isinstance(axis, str) else axis
    motion = read_if_named(motion)
    bare = axis is not None and axis.name == "Omega"
    method = Method.of(method or governing_method(structure, dimensionless=bare))
    if isinstance(motion, Motion):
        if axis is None:
            raise UsageError(
                f"{motion.name}: no axis of frequencies; expected one, such as"
                " 'f_g=0.5:5:10', or a record of load_records"
            )
        return list(
            structure_intervals(
                structure,
                motion,
                axis,
                method=method,
                sign=sign,
                a_max=a_max,
                workers=workers,
            )
        )
    if axis is not None:
        raise UsageError(
            "a record runs in its own time; expected no axis of frequencies"
        )
    (recording,) = recordings_from([motion])
    return list(
        tracing_rows(
            Tracing(structures_scene([structure], [recording], method=method), a_max),
            sign=sign,
            workers=workers,
        )
    )


def _tasks(tracing: Tracing, sign: str, shares: int) -> Iterator[Task]:
    """Yield the tasks of a tracing: for each record, structure and sign, the
    frequencies in so many shares.
    """
    for record in range(len(tracing.scene.recordings)):
        for i, structure in enumerate(tracing.scene.structures):
            apart = sign == BOTH and not tracing.scene.method.system_of(structure).alike
            count = tracing.omegas(i).size
            for one in ("+", "-") if apart else ("worse" if sign == BOTH else sign,):
                for part in np.array_split(np.arange(count), min(shares, count)):
                    yield Task(record, i, tuple(part.tolist()), one)


def _rows(
    scene: RecordScene,
    task: Task,
    column: int,
    steps: OutcomeSteps,
    first: bool,
    signed: bool,
) -> Iterator[dict[str, Any]]:
    """Yield the intervals of one search as rows."""
    recording = scene.recordings[task.record]
    structure = scene.structures[task.structure]
    if scene.over_angles:
        of: dict[str, Any] = {
            "record": recording.label,
            "alpha": structure.alpha,
            "T": float(scene.columns.values[column]),
        }
    else:
        of = {"record": recording.label, "structure": structure.name}
    if signed:
        of["sign"] = (
            None
            if scene.method.system_of(structure).alike
            else int(SIGNS[task.sign][0])
        )
    # A of the record as it is: the scale is A over it.
    own = float(structure.dimensionless_amplitude(recording.acceleration))
    found: list[tuple[float | None, float | None, str]] = [
        interval[1:] for interval in intervals_of(math.nan, steps)
    ]
    for begin, end, mode in (found[:1] or [(None, None, NONE)]) if first else found:
        bounds = {"from": begin} if first else {"from": begin, "to": end}
        row: dict[str, Any] = {
            **of,
            **{f"A_{key}": a for key, a in bounds.items()},
            "mode": mode,
        }
        row |= {
            f"a_{key}": None if a is None else float(structure.ground_acceleration(a))
            for key, a in bounds.items()
        }
        yield (
            row
            | {
                f"scale_{key}": None if a is None else a / own
                for key, a in bounds.items()
            }
            | {"model": scene.method.model}
        )


def overturning_spectrum(
    scene: RecordScene, records: Iterable[Mapping[str, Any]]
) -> Iterator[dict[str, Any]]:
    """Yield the rows of an overturning spectrum, one for each size or structure, from
    the rows of `tracing_rows` with `first`. structure, or alpha [rad] and T [s]; p
    [rad/s]; pga_ratio_16, _50, _84: quantiles of the first overturning PGA/(lambda g)
    over the records [%], None if too few of them overturn the body; overturned,
    records: their numbers.
    """
    found: dict[tuple[Any, ...], list[float]] = {}
    keys = ("alpha", "T") if scene.over_angles else ("structure",)
    for record in records:
        a = record["A_from"]
        found.setdefault(tuple(record[key] for key in keys), []).append(
            math.inf if a is None else a
        )
    bodies = {s.alpha if scene.over_angles else s.name: s for s in scene.structures}
    for place, amplitudes in found.items():
        body = bodies[place[0]]
        uplift = math.tan(body.alpha) if scene.over_angles else body.uplift
        ratio = (
            np.sort(amplitudes)
            * body.ground_acceleration(1.0)
            / (uplift * body.gravity)
        )
        yield {
            **dict(zip(keys, place, strict=True)),
            "p": 2.0 * math.pi / place[1] if scene.over_angles else body.p,
            **{f"pga_ratio_{q}": _quantile(ratio, q / 100.0) for q in (16, 50, 84)},
            "overturned": int(np.isfinite(ratio).sum()),
            "records": ratio.size,
        }


def _quantile(rising: np.ndarray, share: float) -> float | None:
    """Return the quantile of rising values, linear between the order statistics; None
    if it is infinite.
    """
    place = share * (rising.size - 1)
    low, high = float(rising[math.floor(place)]), float(rising[math.ceil(place)])
    return (
        low + (place - math.floor(place)) * (high - low)
        if math.isfinite(high)
        else None
    )

"""The responses of a structure to a set of motions: at levels of an intensity measure,
or at every intensity up to the highest level.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, pairwise
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..dynamics.method import Method
from ..dynamics.outcome import Outcome, falls
from ..dynamics.response import response
from ..dynamics.system import System
from ..envelopes.amplitudes import LONGEST_FINE
from ..envelopes.boundaries import OutcomeSteps, Search
from ..envelopes.capacity import RATIO, tracing_width
from ..envelopes.intervals import in_turn
from ..envelopes.record_changes import RecordSearch, steps_under_records
from ..errors import UsageError
from ..motions.grid import Axis
from ..motions.intensity_measures import Measure
from ..processes import available_cpus, part_reporter
from ..spectra.sweep import spectrum_of, write_scene
from ..spectra.sweep_options import SweepOptions
from ..structures.friction import friction_that_slides
from ..structures.parameters import RockingParameters
from .fitted_curve import SlideLimit
from .measures import MotionMember

Range = tuple[float, float]
Pair = tuple[int, int]  # indices of a structure and a motion
StudyProgress = Callable[[float, int], None]

_TOGETHER = 24  # searches that share a scan, at most
_LAST = 0.01  # of a search, which counts when it has come from its process


@dataclass(frozen=True, eq=False)
class Exposure:
    """Responses of one structure to each motion of a set (members), scaled to each
    level of the intensity measure.
    """

    theta_ratio: Array  # max |theta|/alpha, NaN where it falls [-], (members, levels)
    outcome: Array  # codes of `Outcome`, (members, levels)
    # largest displacement of a body that slides [m], (members, levels); None for a body
    # that rocks
    slide_max: Array | None = None

    def beyond(self, limit: float | None) -> tuple[Array, Array]:
        """Return (beyond, known), both (members, levels). beyond: True if |theta|/alpha
        exceeds `limit` (None: if the body falls), or if contact is lost; known: True if
        the cell has an outcome.
        """
        fallen = falls(self.outcome)
        failed = self.outcome == Outcome.FAILED
        known = ~failed & (self.outcome != Outcome.NOT_COMPUTED)
        if limit is None:
            return fallen, known
        if isinstance(limit, SlideLimit):
            if self.slide_max is None:
                raise UsageError(
                    f"limit state {limit}: a body that rocks; expected one whose"
                    " friction is below lambda, which slides and never rocks"
                )
            return fallen | (np.nan_to_num(self.slide_max) > limit), known
        with np.errstate(invalid="ignore"):
            return fallen | (self.theta_ratio > limit), known

    def counts(self, limit: float | None) -> tuple[Array, Array]:
        """Return (known, beyond & known) of `beyond` as numbers, (members, levels)."""
        beyond, known = self.beyond(limit)
        return known.astype(float), (beyond & known).astype(float)


@dataclass(frozen=True, eq=False)
class MotionSet:
    """The motions of a study."""

    members: Sequence[MotionMember]  # pulses or records
    measure: Measure  # the intensity measure that scales them
    levels: Array  # levels of the measure [SI], (n,)
    method: Method  # equation of motion and its tolerance

    @property
    def weight(self) -> Array:
        """The weight of each motion, (members,)."""
        return np.array([m.weight for m in self.members])

    @property
    def scales(self) -> Array:
        """The factors that bring a motion of measure 1 to the levels, (n,)."""
        return self.levels ** (1.0 / self.measure.power)

    @property
    def of_records(self) -> bool:
        return all(m.recording is not None for m in self.members)

    def factor(self, structure: RockingParameters, member: MotionMember) -> float:
        """Return the factor of a motion with which its intensity measure is 1."""
        return member.measured(self.measure, structure) ** (-1.0 / self.measure.power)

    def unit(self, structure: RockingParameters, member: MotionMember) -> float:
        """Return the dimensionless amplitude A of a motion at which its intensity
        measure is 1.
        """
        own = (
            float(structure.dimensionless_amplitude(member.acceleration))
            / member.motion.ground_peak
        )
        return own * self.factor(structure, member)


def exposures(
    structures: Sequence[RockingParameters],
    motions: MotionSet,
    path: Path | None = None,
    sweep: SweepOptions | None = None,
) -> list[Exposure]:
    """Return the exposure of each structure: every motion scaled to each level.

    path: the spectra file to write for records; with `resume` a complete file of the
    same scene is read; for a shard the result is empty. Raises UsageError for a path
    with pulses, or with several structures under a measure that depends on the
    structure.
    """
    if not motions.of_records:
        if path is not None:
            raise UsageError("a spectra file goes with records, not with site pulses")
        return [
            _under_each(
                s,
                motions,
                [motions.unit(s, m) * motions.scales for m in motions.members],
            )
            for s in structures
        ]
    groups = (
        [[s] for s in structures]
        if motions.measure.of_structure is not None
        else [list(structures)]
    )
    if path is not None and len(groups) > 1:
        raise UsageError(
            f"{motions.measure.name} depends on the structure; a spectra file then"
            " holds one structure only"
        )
    return [
        exposure
        for group in groups
        for exposure in _under_records(group, motions, path, sweep)
    ]


def _under_records(
    structures: Sequence[RockingParameters],
    motions: MotionSet,
    path: Path | None,
    sweep: SweepOptions | None,
) -> list[Exposure]:
    """Return the exposures of structures to scaled records, from a sweep; its file is
    `path`, or it stays in memory.
    """
    from ..spectra.file.reader import SpectraFile
    from ..spectra.record_scene import structures_scene

    recordings = [
        m.recording.times(motions.factor(structures[0], m))
        for m in motions.members
        if m.recording
    ]
    scene = structures_scene(
        structures, recordings, Axis("scale", motions.scales), motions.method
    )
    options = replace(sweep or SweepOptions(), check=0)
    if path is None:
        found = spectrum_of(scene, options)
        theta, outcome = found.theta_ratio, found.outcome
        slide_max = found.quantities.get("slide_max")
    else:
        if not (options.resume and path.is_file()):
            write_scene(scene, path, options)
        if options.shard is not None:
            return []
        with SpectraFile(path) as file:
            here = scene.identity()
            if {key: file.scene.get(key) for key in here} != here:
                raise UsageError(
                    f"{path}: belongs to another scene; give another output, or"
                    " `overwrite`"
                )
            theta, outcome = file.array("theta_ratio"), file.array("outcome")
            slide_max = file.array("slide_max") if "slide_max" in file.names else None
    slides = [friction_that_slides(s) is not None for s in structures]
    return [
        Exposure(
            theta[:, i],
            outcome[:, i],
            None if slide_max is None or not slides[i] else slide_max[:, i],
        )
        for i in range(len(structures))
    ]


def _under_each(
    structure: RockingParameters, motions: MotionSet, amplitudes: Sequence[Array]
) -> Exposure:
    """Return the exposure of a structure to each motion at its amplitudes A."""
    if friction_that_slides(structure) is not None:
        return _sliding_under_each(structure, motions, amplitudes)
    system = motions.method.system_of(structure)
    pairs = zip(motions.members, amplitudes, strict=True)
    found = [
        response(system, m.motion, a, np.array([m.omega / structure.p]))
        for m, a in pairs
    ]
    return Exposure(
        np.array([f.theta_ratio for f in found]), np.array([f.outcome for f in found])
    )


def _sliding_under_each(
    structure: RockingParameters, motions: MotionSet, amplitudes: Sequence[Array]
) -> Exposure:
    """Return `_under_each` of a structure that slides and never rocks."""
    from ..spectra.scene import SceneCells
    from ..spectra.work.sliding_cells import sliding_block

    found = [
        sliding_block(
            structure,
            SceneCells(structure, m.motion, a, np.full(a.size, m.omega / structure.p)),
            ("slide",),
        )
        for m, a in zip(motions.members, amplitudes, strict=True)
    ]
    names = "theta_ratio", "outcome", "slide_max"
    return Exposure(*(np.array([f[name] for f in found]) for name in names))


def as_recorded(structure: RockingParameters, motions: MotionSet) -> Exposure:
    """Return the exposure of a structure to each unscaled motion, as if
    at one level.
    """
    own = [
        structure.dimensionless_amplitude(
            np.array([m.acceleration / m.motion.ground_peak])
        )
        for m in motions.members
    ]
    return _under_each(structure, motions, own)


def traced(
    structures: Sequence[RockingParameters],
    motions: MotionSet,
    workers: int | None = None,
    progress: StudyProgress | None = None,
) -> list[list[list[Range]]]:
    """Return for each structure and motion the intervals of the measure (SI) that
    overturn the structure, up to the highest level; the end of one that goes on beyond
    it is infinite. Under records intervals narrower than 0.5 % may be missed. progress:
    called with the number of searches that are done, of which a part counts as a
    fraction, and of all.
    """
    tasks = [
        (i, k)
        for i, structure in enumerate(structures)
        if friction_that_slides(structure) is None  # others never overturn
        for k in range(len(motions.members))
    ]
    found: list[list[list[Range]]] = [[[] for _ in motions.members] for _ in structures]
    if not tasks:
        return found
    workers = workers or (available_cpus() if motions.of_records else 1)
    workers = min(workers, len(tasks))
    done = known = 0.0

    def tell(reported: float) -> None:
        nonlocal known
        known = max(known, reported)
        if progress is not None:
            progress(known, len(tasks))

    search = partial(
        _traced_together,
        structures,
        motions,
        (lambda part: tell(done + part)) if workers == 1 else None,
    )
    shares = _shares(motions, tasks, workers)
    several = None if workers == 1 else lambda sum_: tell(min(sum_, len(tasks) - _LAST))
    for share, intervals in zip(
        shares, in_turn(search, shares, workers, several), strict=True
    ):
        for (i, k), own in zip(share, intervals, strict=True):
            found[i][k] = own
        done += len(share)
        tell(done)
    return found


def _shares(
    motions: MotionSet, tasks: Sequence[Pair], workers: int
) -> list[Sequence[Pair]]:
    """Return the searches that go together: each under a pulse by itself; those under
    records in shares of equal size, with as long records in each.
    """
    if not motions.of_records:
        return [[task] for task in tasks]
    count = workers * math.ceil(len(tasks) / (workers * _TOGETHER))
    length = [len(member.motion.segments) for member in motions.members]
    by_length = sorted(tasks, key=lambda task: length[task[1]])
    return [by_length[n::count] for n in range(count)]


def _traced_together(
    structures: Sequence[RockingParameters],
    motions: MotionSet,
    tell: Callable[[float], None] | None,
    tasks: Sequence[Pair],
) -> list[list[Range]]:
    """Return the intervals of the measure [SI] that each of these searches finds. tell:
    called with the number of searches that are done, None in a worker process.
    """
    told = tell or part_reporter()
    systems = {i: motions.method.system_of(structures[i]) for i, _ in tasks}
    asked, units = [], []
    for i, k in tasks:
        structure, member = structures[i], motions.members[k]
        units.append(motions.unit(structure, member))
        search = _search(structure, systems[i], motions, member, units[-1])
        omega = member.omega / structure.p
        asked.append(RecordSearch(search, omega))
    # Motions that do not lift the body up to the last level need no search.
    lifting = [n for n, (one, _) in enumerate(asked) if one.uplift < one.a_max]
    steps = steps_under_records(
        [asked[n] for n in lifting], lambda share: told(len(tasks) * share)
    )
    found: list[list[Range]] = [[] for _ in tasks]
    for n, own in zip(lifting, steps, strict=True):
        found[n] = _intervals(own, units[n], motions.measure.power)
    told(float(len(tasks)))
    return found


def _search(
    structure: RockingParameters,
    system: System,
    motions: MotionSet,
    member: MotionMember,
    unit: float,
) -> Search:
    """Return the search up to the last level under a motion; unit: its A at which the
    measure is 1.
    """
    long = len(member.motion.segments) > LONGEST_FINE
    return Search(
        system,
        member.motion,
        unit * float(motions.levels[-1]) ** (1.0 / motions.measure.power),
        ratio=RATIO if long else 0.0,
        digits=tracing_width(motions.method, member.motion),
        parts=16,
    )


def _intervals(steps: OutcomeSteps, unit: float, power: float) -> list[Range]:
    """Return the intervals of the measure [SI] in which a body falls, from its outcomes
    along the amplitude; unit: A at which the measure is 1.
    """
    runs = [
        (down, (next(run)[0] / unit) ** power)
        for down, run in groupby(steps, key=lambda step: Outcome(step[1]).falls)
    ]
    return [
        (x, end) for (down, x), (_, end) in pairwise([*runs, (False, np.inf)]) if down
    ]


def first_of(intervals: Sequence[Sequence[Range]]) -> Array:
    """Return the intensity of first overturning under each motion, NaN without
    overturning, (members,).
    """
    return np.array([found[0][0] if found else np.nan for found in intervals])


def share_overturned(
    intervals: Sequence[Sequence[Range]], weight: Array
) -> tuple[Array, Array]:
    """Return (the levels at which the exact share of overturning motions changes, the
    share from each level to the next).
    """
    steps = [
        step
        for found, w in zip(intervals, weight, strict=True)
        for low, high in found
        for step in ((low, w), (high, -w))
    ]
    steps = sorted(step for step in steps if np.isfinite(step[0]))
    x = np.array([edge for edge, _ in steps])
    share = np.cumsum([change for _, change in steps]) / float(np.sum(weight))
    last = np.append(np.diff(x) > 0.0, True) if x.size else np.zeros(0, dtype=bool)
    return x[last], np.clip(share[last], 0.0, 1.0)

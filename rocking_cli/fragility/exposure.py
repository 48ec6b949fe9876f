"""The responses of a structure to a set of motions: at levels of an intensity measure, or at every intensity up to the highest level."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics.method import Method
from ..dynamics.outcome import Outcome, falls
from ..dynamics.response import response
from ..envelopes.boundaries import Search
from ..envelopes.capacity import RATIO, tracing_width
from ..envelopes.intervals import in_turn
from ..envelopes.scan_grid import LONGEST_FINE
from ..errors import UsageError
from ..motions.grid import Axis
from ..processes import available_cpus
from ..structures.parameters import RockingParameters
from .measures import Measure, Member

Array = np.ndarray
Interval = tuple[float, float]

_PARTS = 16  # parts of a bracket in one cut


@dataclass(frozen=True, eq=False)
class Exposure:
    """A structure under each motion of a set at levels of a measure.

    theta_ratio: max |theta|/alpha, NaN where it falls; outcome: codes of `Outcome`; (members, levels).
    """

    levels: Array
    theta_ratio: Array
    outcome: Array

    def beyond(self, limit: float | None) -> tuple[Array, Array]:
        """(True beyond the limit state |theta|/alpha = `limit`, None for overturning; True if that is known), (members, levels). Lost
        contact is beyond every limit."""
        gone, known = falls(self.outcome), (self.outcome != Outcome.FAILED) & (self.outcome != Outcome.NOT_COMPUTED)
        if limit is None:
            return gone, known
        with np.errstate(invalid="ignore"):
            return gone | (self.theta_ratio > limit), known


def exposures(
    structures: Sequence[RockingParameters], members: Sequence[Member], measure: Measure, levels: Array, method: Method, *,
    path: Path | None = None, workers: int | None = None, **options: Any,
) -> list[Exposure]:  # fmt: skip
    """Each structure under every motion scaled to each level of a measure (SI).

    path: the spectra file to write for records, with the other fields of `SweepOptions`. With `resume` a complete file of the same scene,
    such as a merged one, is read; for a shard the result is empty. Raises UsageError for a path with pulses, or with several structures
    under a measure that depends on the structure.
    """
    scales = levels ** (1.0 / measure.power)
    recordings = [m.recording for m in members if m.recording is not None]
    if len(recordings) < len(members):
        if path is not None:
            raise UsageError("a spectra file goes with records, not with site pulses")
        amplitudes = [[_unit_amplitude(s, m, measure) * scales for m in members] for s in structures]
        return [Exposure(levels, *_under_each(s, members, a, method)) for s, a in zip(structures, amplitudes, strict=True)]
    groups = [[s] for s in structures] if measure.of_structure else [list(structures)]
    if path is not None and len(groups) > 1:
        raise UsageError(f"{measure.name} depends on the structure; a spectra file then holds one structure only")
    return [exposure for group in groups for exposure in _under_records(group, members, measure, levels, path, method, workers, options)]


def _under_records(
    structures: list[RockingParameters], members: Sequence[Member], measure: Measure, levels: Array, path: Path | None, method: Method,
    workers: int | None, options: dict[str, Any],
) -> list[Exposure]:  # fmt: skip
    from ..spectra.file.reader import SpectraFile
    from ..spectra.record_scene import structures_scene
    from ..spectra.sweep import SweepOptions, spectrum_of, write_scene

    unit = [m.measured(measure, structures[0]) ** (-1.0 / measure.power) for m in members]  # the factor that scales the measure to 1
    recordings = [m.recording.times(f) for m, f in zip(members, unit, strict=True) if m.recording]
    scene = structures_scene(structures, recordings, Axis("scale", levels ** (1.0 / measure.power)), method)
    if path is None:
        found = spectrum_of(scene, SweepOptions(workers=workers, check=0, progress=options.get("progress")))
        theta, outcome = found.theta_ratio, found.outcome
    else:
        if not (options.get("resume") and path.is_file()):
            write_scene(scene, path, SweepOptions(workers=workers, check=0, **options))
        if options.get("shard") is not None:
            return []
        with SpectraFile(path) as file:
            here = scene.identity()
            if {key: file.scene.get(key) for key in here} != here:
                raise UsageError(f"{path}: is of another scene; give another output, or `overwrite`")
            theta, outcome = file.array("theta_ratio"), file.array("outcome")
    return [Exposure(levels, theta[:, i], outcome[:, i]) for i in range(len(structures))]


def _under_each(
    structure: RockingParameters, members: Sequence[Member], amplitudes: Sequence[Array], method: Method
) -> tuple[Array, Array]:
    """(theta_ratio, outcome) of a structure under each motion at its amplitudes A, (members, amplitudes)."""
    system = method.system_of(structure)
    found = [
        response(system, m.motion, a, np.array([m.omega / structure.p]), structure.eta) for m, a in zip(members, amplitudes, strict=True)
    ]
    return np.array([f.theta_ratio for f in found]), np.array([f.outcome for f in found])


def as_recorded(structure: RockingParameters, members: Sequence[Member], method: Method) -> tuple[Array, Array]:
    """(theta_ratio, outcome) of a structure under each motion as it is, (members,)."""
    own = [np.array([structure.dimensionless_amplitude(m.acceleration / m.motion.peak)]) for m in members]
    theta, outcome = _under_each(structure, members, own, method)
    return theta[:, 0], outcome[:, 0]


def traced(
    structure: RockingParameters, members: Sequence[Member], measure: Measure, highest: float, method: Method, *,
    workers: int | None = None, progress: Callable[[int, int], None] | None = None,
) -> list[list[Interval]]:  # fmt: skip
    """For each motion of a set the intervals of a measure (SI) that overturn the structure, up to `highest`; the end of an interval beyond
    `highest` is infinite. Intervals are traced as in an envelope; under records those narrower than 0.5 % may be missed."""
    task = partial(_trace, structure, measure, highest, method)
    workers = min(workers or (available_cpus() if any(m.recording for m in members) else 1), len(members))
    found = []
    for intervals in in_turn(task, members, workers):
        found.append(intervals)
        if progress is not None:
            progress(len(found), len(members))
    return found


def _unit_amplitude(structure: RockingParameters, member: Member, measure: Measure) -> float:
    """The A at which the measure of a motion is 1."""
    own = float(structure.dimensionless_amplitude(member.acceleration)) / member.motion.peak
    return own * member.measured(measure, structure) ** (-1.0 / measure.power)


def _trace(structure: RockingParameters, measure: Measure, highest: float, method: Method, member: Member) -> list[Interval]:
    """The intervals of one motion."""
    unit = _unit_amplitude(structure, member, measure)
    long = len(member.motion.segments) > LONGEST_FINE
    search = Search(
        method.system_of(structure), member.motion, structure.eta, unit * highest ** (1.0 / measure.power),
        ratio=RATIO if long else 0.0, digits=tracing_width(method, member.motion), parts=_PARTS,
    )  # fmt: skip
    if not search.lowest < search.a_max:
        return []
    (steps,) = search.rows(np.array([member.omega / structure.p]))
    runs = [(down, (next(run)[0] / unit) ** measure.power) for down, run in groupby(steps, key=lambda step: Outcome(step[1]).falls)]
    return [(x, end) for (down, x), (_, end) in pairwise([*runs, (False, np.inf)]) if down]


def first_of(intervals: Sequence[Sequence[Interval]]) -> Array:
    """The intensity of first overturning under each motion, NaN without overturning, (members,)."""
    return np.array([found[0][0] if found else np.nan for found in intervals])


def share_overturned(intervals: Sequence[Sequence[Interval]], weight: Array) -> tuple[Array, Array]:
    """(levels at which the share of overturning motions changes, the share from each level on); the shares are exact."""
    steps = [
        (edge, sign * w) for found, w in zip(intervals, weight, strict=True) for i in found for edge, sign in zip(i, (1, -1), strict=True)
    ]
    steps = sorted(step for step in steps if np.isfinite(step[0]))
    x = np.array([edge for edge, _ in steps])
    share = np.cumsum([change for _, change in steps]) / float(np.sum(weight))
    last = np.append(np.diff(x) > 0.0, True) if x.size else np.zeros(0, dtype=bool)
    return x[last], np.clip(share[last], 0.0, 1.0)

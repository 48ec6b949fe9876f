"""Records with a scale factor, each in its own time, and sets of them."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import count
from typing import Any

import numpy as np

from ..documents.files import STDIN
from ..errors import DocumentError, UsageError
from .biaxial import Upwards
from .blocks import largest
from .intensity import Intensity, intensity
from .motion import Motion, checked_scale
from .polyline import record_motion
from .reading import factor_of, motion_of, remarks_on
from .records import Record, is_record
from .records.components import chosen, vertical_of
from .records.sets import NoRecord, read_set, record_files


@dataclass(frozen=True, eq=False)
class Recording:
    """A record times a factor, which may be negative.

    label: its name in a set; upwards: the vertical motion. Raises MotionError if the record is zero throughout, or the factor is zero
    or not finite.
    """

    record: Record
    factor: float = 1.0
    label: str = ""
    upwards: Upwards | None = None

    def __post_init__(self) -> None:
        label = (self.label or self.record.label).encode("utf-8", "backslashreplace").decode()  # file names may not be valid text
        object.__setattr__(self, "label", label)
        checked_scale(self.record.label, self.factor)
        if not np.any(self.record.acceleration):
            record_motion(self.record)  # raises the MotionError

    @property
    def acceleration(self) -> float:
        """The peak ground acceleration of the scaled record [m/s2]."""
        return abs(self.factor) * largest(self.record.acceleration)

    @cached_property
    def intensity(self) -> Intensity:
        """The intensity measures of the record without the factor."""
        return intensity(self.record)

    def times(self, factor: float) -> Recording:
        """The recording times a positive factor, which also scales its vertical motion."""
        up = None if self.upwards is None else replace(self.upwards, scale=self.upwards.scale * factor)
        return replace(self, factor=self.factor * factor, upwards=up)

    @property
    def motion(self) -> Motion:
        """The motion in its own time (omega_g = 1 rad/s), named by its label; only the last two motions are kept in memory."""
        return _motion(self)

    def identity(self) -> list[Any]:
        """The data on which a result depends: label, hash of the file, component, dt [s], unit in the file, factor, vertical motion."""
        r, up = self.record, [] if self.upwards is None else [self.upwards.identity()]
        return [self.label, r.sha256, r.component, r.dt, r.unit, self.factor, *up]


@lru_cache(maxsize=2)
def _motion(recording: Recording) -> Motion:
    across = record_motion(recording.record, recording.factor, recording.label)
    return across if recording.upwards is None else recording.upwards(across)


def with_distinct_labels(recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """The same recordings with distinct labels: equal labels get a number."""
    times, found = Counter(r.label for r in recordings), []
    taken = set(times)
    for r in recordings:
        if times[r.label] > 1:
            label = next(name for n in count(1) if (name := f"{r.label} ({n})") not in taken)  # a file may have such a name
            taken.add(label)
            r = replace(r, label=label)
        found.append(r)
    return tuple(found)


def read_motions(
    paths: Sequence[str],
    *,
    component: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    scale: float | None = None,
    scale_to: str | None = None,
    vertical: float | None = None,
    tell: Callable[[str], None] | None = None,
    unread: Callable[[str], None] | None = None,
) -> Motion | tuple[Recording, ...]:
    """The motion of a single motion document, or the records of files, directories and lists of files (see `record_files`).

    component: `horizontal`, `all`, or a name or number; None: each horizontal component of each file; vertical: factor of the vertical
    component of the same file, which is added to each; tell: called with each remark and each file of a directory that is left out;
    unread: called with each file of a directory that cannot be read, an error if None; other arguments as for `read_motion`.
    Raises UsageError and DocumentError as `read_motion` does, and UsageError if there is no record.
    """
    say = tell or (lambda text: None)

    def shaken(records: list[Record]) -> list[Recording]:
        upwards = None if vertical is None else Upwards(record_motion(vertical_of(records)), vertical)
        return [Recording(record, upwards=upwards) for record in chosen(records, component)]

    found: list[Recording] = []
    try:
        for recording in read_set(paths, shaken, unit=unit, dt=dt, tell=say, unread=unread):
            record = recording.record
            found.append(replace(recording, factor=factor_of(record, scale, scale_to)))
            for remark in remarks_on(record):
                say(f"{record.source}: {remark}")
    except NoRecord as error:
        if len(paths) > 1 or error.source not in (paths[0], STDIN):
            raise DocumentError(f"{error}; a set holds records only") from None
        of_records = {"component": component, "unit": unit, "dt": dt, "scale_to": scale_to, "vertical": vertical}
        return motion_of(error.source, error.raw, scale=scale, **of_records)
    if not found:
        raise UsageError(f"{', '.join(paths)}: no record among the files")
    return with_distinct_labels(found)


def holds_records(path: str) -> bool:
    """True if a path is a record, a directory or a list of files, by its content; false for standard input."""
    if path == "-" or not os.path.exists(path):
        return False
    return os.path.isdir(path) or (os.path.isfile(path) and (is_record(path) or next(record_files([path]))[0] != path))

"""Records with a scale factor, each in its own time."""

import hashlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import count
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from ..documents.files import whole_text
from ..showing import Shown
from .biaxial import Upwards
from .blocks import largest
from .intensity import Intensity, intensity
from .motion import Motion, checked_scale
from .records.record import Record, record_motion

if TYPE_CHECKING:
    from .buildings import Building


@dataclass(frozen=True, eq=False, repr=False)
class Recording(Shown):
    """A record times a factor, in its own time.

    `load_records` makes them. `motion` is its motion, `acceleration` its peak,
    `intensity` its measures without the factor, `times` scales it. Raises MotionError
    for a zero record or a bad factor.

    Attributes
    ----------
    record: as recorded
    factor: may be negative [-]
    label: its name in a set
    upwards: vertical motion with it, None without one
    building: the building on whose floor the motion is; None on the ground. The record,
        its factor and all measures are those of the ground.

    Examples
    --------
    >>> record = read_record("configs/motions/synthetic.at2")
    >>> stronger = Recording(record, factor=1.5).times(2.0)
    >>> stronger.factor, round(stronger.acceleration, 3)
    (3.0, 11.772)
    """

    record: Record  # as recorded
    factor: float = 1.0  # may be negative [-]
    label: str = ""  # name of the record in a set
    upwards: Upwards | None = None  # vertical motion with it, None without one
    # the building on whose floor the motion is; None on the ground. The record,
    # its factor and all measures are those of the ground.
    building: "Building | None" = None

    def __post_init__(self) -> None:
        label = whole_text(self.label or self.record.label)
        object.__setattr__(self, "label", label)
        checked_scale(self.record.label, self.factor)
        if not np.any(self.record.acceleration):
            record_motion(self.record)  # raises the MotionError

    def _shown(self) -> dict[str, Any]:
        vertical = (
            {} if self.upwards is None else {"vertical": "with a vertical motion"}
        )
        scaled = {"factor": self.factor, "pga": self.acceleration}
        return {**self.record._shown(), "record": self.label, **scaled, **vertical}

    def _rows(self) -> list[dict[str, float]]:
        return [
            {"t": row["t"], "acceleration": self.factor * row["acceleration"]}
            for row in self.record._rows()
        ]

    @property
    def acceleration(self) -> float:
        """The peak ground acceleration of the scaled record [m/s2]."""
        return abs(self.factor) * largest(self.record.acceleration)

    @cached_property
    def intensity(self) -> Intensity:
        """The intensity measures of the record without the factor."""
        return intensity(self.record)

    def times(self, factor: float) -> Self:
        """Return the recording times a factor, which also scales its vertical motion.

        Parameters
        ----------
        factor
            positive [-]

        Returns
        -------
        Recording
        """
        up = (
            None
            if self.upwards is None
            else replace(self.upwards, scale=self.upwards.scale * factor)
        )
        return replace(self, factor=self.factor * factor, upwards=up)

    def on_floor(self, building: "Building") -> Self:
        """Return the recording on a floor of a building; its label names it.

        Parameters
        ----------
        building
            the modes that move the floor

        Returns
        -------
        Recording
        """
        label = f"{self.label} on {building.name}"
        return replace(self, building=building, label=label)

    @property
    def motion(self) -> Motion:
        """The motion in its own time (omega_g = 1 rad/s). Only the last two motions are
        kept in memory.
        """
        return _motion(self)

    def identity(self) -> list[Any]:
        """The data on which a result depends: label, hash of the samples (of one file
        they differ with the column and the lines that are skipped), component, dt [s],
        factor, vertical motion, building.
        """
        r, more = self.record, list[Any]()
        samples = hashlib.sha256(np.ascontiguousarray(r.acceleration, "<f8").tobytes())
        if self.upwards is not None:
            more.append(self.upwards.identity())
        if self.building is not None:
            more.append({"building": self.building.identity()})
        return [
            *(self.label, samples.hexdigest(), r.component, r.dt, self.factor),
            *more,
        ]


@lru_cache(maxsize=2)
def _motion(recording: Recording) -> Motion:
    across: Motion = record_motion(
        recording.record,
        recording.factor,
        recording.label + " times -1" * (recording.factor < 0.0),
    )
    if recording.building is not None:
        across = recording.building.moved_by(across)
    return across if recording.upwards is None else recording.upwards(across)


def with_distinct_labels(recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Return the recordings with a number at equal labels."""
    times, found = Counter(r.label for r in recordings), []
    taken = set(times)
    for r in recordings:
        if times[r.label] > 1:
            # a file may have such a name
            label = next(
                name for n in count(1) if (name := f"{r.label} ({n})") not in taken
            )
            taken.add(label)
            r = replace(r, label=label)
        found.append(r)
    return tuple(found)

"""The options of the ground motion: pulses, records and the vertical motion."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar

import click

from ..errors import RockingError
from .command import option, partly, refuse
from .parameter_types import NUMBER, PULSE, STATION, InputPath, PulseOrPath, quantity
from .printing import note, warn

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.biaxial import Upwards
    from ..motions.grid import Grid
    from ..motions.recording import Recording

_OF_A_FILE = ("vertical_component", "vertical_unit", "vertical_dt")
_MOTION = (
    "A record or a motion document instead of a pulse; for a set: records, a directory"
    " or a list; repeatable."
)
_VERTICAL = (
    "Vertical motion, upwards: a pulse by name, a motion document, a record, or"
    f" {STATION}: the component of the same file."
)
COLUMN = (
    "Column of a table of numbers, from 1; all: each line goes on from the one before."
)
DT = "Time between the values of a record in a single column."


@contextmanager
def named(**names: str) -> Iterator[None]:
    """Context in which errors name these options instead of the arguments of the
    library.
    """
    try:
        yield
    except RockingError as error:
        error.args = (
            re.sub(
                r"`(\w+)`",
                lambda found: f"`{names.get(found[1], found[1])}`",
                str(error),
            ),
        )
        raise


@dataclass(frozen=True)
class Reading:
    """The options for reading records."""

    component: str | None = option(
        "--component",
        "Component of a record by name or number (default: each horizontal one).",
        metavar="horizontal|all|NAME",
    )
    unit: str | None = option(
        "--unit",
        "Unit of a record in plain columns of numbers, such as g or m/s2.",
        metavar="UNIT",
    )
    motion_dt: float | None = option("--dt --motion-dt", DT, type=quantity("time"))
    column: str | None = option("--column", COLUMN, metavar="NUMBER|all")


@dataclass(frozen=True)
class Ground:
    """The motion of a call: one pulse or motion document, or None and a set of
    records.
    """

    motion: Motion | None  # None with a set of records
    recordings: tuple[Recording, ...] = ()  # the set of records
    grid: Grid | None = None  # one cell, the demand; None without one
    upwards: Upwards | None = None  # vertical motion that the motions have already

    @property
    def shakes(self) -> list[tuple[Motion, Grid]]:
        """Each motion with its demand; without a stated one the demand of a record is
        its own peak.
        """
        from ..motions.grid import as_recorded

        shakes = [
            (r.motion, self.grid or as_recorded(r.acceleration))
            for r in self.recordings
        ]
        return (
            shakes
            if self.motion is None or self.grid is None
            else [*shakes, (self.motion, self.grid)]
        )

    @property
    def reversed(self) -> Ground:
        """The motions in the opposite direction; vertical motions stay as they are."""
        motion = None if self.motion is None else self.motion.scaled(-1.0)
        return replace(
            self,
            motion=motion,
            recordings=tuple(replace(r, factor=-r.factor) for r in self.recordings),
        )

    def needed(self, *instead: str) -> list[tuple[Motion, Grid]]:
        """Return `shakes`. Raises click.UsageError, which names the options `instead`,
        if there is none.
        """
        if not self.shakes:
            raise no_shaking("--motion FILE", *instead)
        return self.shakes

    def with_upwards(self, upwards: Upwards | None) -> Ground:
        """Return the motions with this vertical motion added to each."""
        if upwards is None:
            return self
        motion = None if self.motion is None else upwards(self.motion)
        return replace(
            self,
            motion=motion,
            recordings=tuple(replace(r, upwards=upwards) for r in self.recordings),
            upwards=upwards,
        )


@dataclass(frozen=True)
class Source:
    """A pulse by name, or files of motions."""

    pulse: str | None = option(
        "--pulse",
        "Ground motion (default: sine); see `rocking help motions`.",
        type=PULSE,
        metavar="NAME",
    )
    cycles: float | None = option(
        "--cycles",
        "Cycles of a sine or cosine, in half cycles (default 1).",
        type=NUMBER,
    )
    gamma: float | None = option(
        "--gamma",
        "Duration over period of a mavroeidis-papageorgiou pulse (default 2).",
        type=NUMBER,
    )
    phase: float | None = option(
        "--phase",
        "Phase of a mavroeidis-papageorgiou pulse (default 0 rad).",
        type=quantity("angle"),
    )
    motion: tuple[str, ...] = option(
        "--motion", _MOTION, multiple=True, type=InputPath(), metavar="FILE..."
    )


# The name and the parameters of a pulse.
_PULSE = tuple(of.name for of in fields(Source) if of.name != "motion")


@dataclass(frozen=True)
class Motions(Reading, Source):
    """The ground motion: a pulse, a motion document, a record or a set of them."""

    TOPIC: ClassVar[str] = "motions"  # whose page explains these options

    scale: float | None = option(
        "--scale",
        "Factor of the motion; a negative one reverses it.",
        type=NUMBER,
        metavar="FACTOR",
    )
    scale_to: str | None = option(
        "--scale-to",
        "Scale a record to an intensity measure, such as PGA=0.35g.",
        metavar="IM=VALUE",
    )

    def one(self) -> Ground:
        """Return the motion that the options describe. Raises UsageError for a set of
        records.
        """
        from ..motions.reading import read_motion

        if len(self.motion) > 1 or any(map(os.path.isdir, self.motion)):
            raise click.UsageError(
                f"--motion: found {' '.join(self.motion)}; expected one motion"
            )
        upwards, station = self.upwards()
        if not self.motion:
            return Ground(self._pulse(station)).with_upwards(upwards)
        with named(dt="motion_dt"):
            return Ground(
                read_motion(self.motion[0], **self._choices(station))
            ).with_upwards(upwards)

    def several(
        self, files: tuple[str, ...], one_upwards: bool = False
    ) -> tuple[tuple[str, ...], Ground]:
        """Return (the structure files, the motion or set of records); one_upwards:
        refuse a vertical motion for a set.

        Records among the files belong to the set, so that a shell pattern after
        --motion works. Raises UsageError.
        """
        upwards, station = self.upwards()
        if not self.motion:
            return files, Ground(self._pulse(station)).with_upwards(upwards)
        from ..motions.reading import holds_records, read_motions

        own = [path for path in files if holds_records(path)]
        files = tuple(path for path in files if path not in own)
        if "-" in self.motion and "-" in files:
            raise click.UsageError(
                "standard input is given both as structure and as motion; expected"
                " only one"
            )
        with named(dt="motion_dt"):
            found = read_motions(
                (*self.motion, *own), unread=leave_out, **self._choices(station)
            )
        if one_upwards and upwards is not None and isinstance(found, tuple):
            raise click.UsageError(
                "--vertical goes with one pulse or motion document here, not with a set"
                " of records"
            )
        ground = Ground(None, found) if isinstance(found, tuple) else Ground(found)
        return files, ground.with_upwards(upwards)

    def upwards(self) -> tuple[Upwards | None, float | None]:
        """Return (the vertical motion of a pulse or a file, the factor of the vertical
        component of the same file), None if not stated.
        """
        return None, None

    def _choices(self, station: float | None) -> Any:
        """Return the choices for the motion of a file."""
        refuse("does not go with --motion", *_PULSE)
        same = {
            key: getattr(self, key)
            for key in ("component", "unit", "column", "scale", "scale_to")
        }
        return {**same, "dt": self.motion_dt, "vertical": station, "tell": note}

    def _pulse(self, station: float | None) -> Motion:
        from ..motions import pulse

        refuse(
            "goes with a record: give --motion",
            "component",
            "unit",
            "motion_dt",
            "column",
            "scale_to",
        )
        if station is not None:
            raise click.UsageError(
                f"--vertical {STATION} goes with a record: give --motion"
            )
        found = pulse(
            self.pulse or "sine",
            **{
                key: value
                for key in _PULSE[1:]
                if (value := getattr(self, key)) is not None
            },
        )
        return found if self.scale is None else found.scaled(self.scale)


@dataclass(frozen=True)
class BothWays(Motions):
    """The ground motion and a vertical one."""

    TOPIC: ClassVar[str] = "motions"

    vertical: str | None = option(
        "--vertical", _VERTICAL, type=PulseOrPath(), metavar="MOTION"
    )
    vertical_scale: float | None = option(
        "--vertical-scale",
        "Factor of the vertical motion (default 1).",
        type=NUMBER,
        metavar="FACTOR",
    )
    vertical_component: str | None = option(
        "--vertical-component", "Component of a vertical record.", metavar="NAME"
    )
    vertical_unit: str | None = option(
        "--vertical-unit",
        "Unit of a vertical record in plain columns of numbers.",
        metavar="UNIT",
    )
    vertical_dt: float | None = option("--vertical-dt", DT, type=quantity("time"))

    def upwards(self) -> tuple[Upwards | None, float | None]:
        factor = 1.0 if self.vertical_scale is None else self.vertical_scale
        if self.vertical is None:
            refuse("goes with --vertical", "vertical_scale", *_OF_A_FILE)
            return None, None
        if self.vertical == STATION:
            refuse(f"does not go with --vertical {STATION}", *_OF_A_FILE)
            return None, factor
        from ..motions import PULSES, pulse
        from ..motions.biaxial import Upwards
        from ..motions.reading import read_motion

        if self.vertical in PULSES:
            refuse("goes with a record: give one to --vertical", *_OF_A_FILE)
            motion = pulse(self.vertical)
        else:
            component, unit, dt = (
                self.vertical_component,
                self.vertical_unit,
                self.vertical_dt,
            )
            with named(
                component="vertical_component", unit="vertical_unit", dt="vertical_dt"
            ):
                motion = read_motion(
                    self.vertical, component=component, unit=unit, dt=dt, tell=note
                )
        return Upwards(motion, factor), None


def leave_out(line: str) -> None:
    """Print why a file of a directory cannot be read and is left out."""
    warn(line)
    partly()


def no_shaking(*instead: str) -> click.UsageError:
    """Return the error for a call without a motion; instead: other options that may
    state one.
    """
    return click.UsageError(
        ", or ".join(
            ("no shaking: give --a-g and --omega-g (or --f-g, --T-g)", *instead)
        )
    )

"""The options of the ground motion: pulses, records and the vertical motion."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, cast

import click

from ..errors import RockingError
from .command import flag, option, partly, refuse
from .parameter_types import NUMBER, PULSE, STATION, InputPath, PulseOrPath, quantity
from .printing import note

if TYPE_CHECKING:
    import numpy as np

    from ..motions import Motion
    from ..motions.biaxial import Upwards
    from ..motions.buildings import Building
    from ..motions.grid import Grid
    from ..motions.recording import Recording
    from ..motions.records import Stated

_MOTION = "A record, a motion document, a folder or a list, not a pulse; repeatable."
_VERTICAL = f"Vertical motion: a file, a pulse, or {STATION}: of the same record."
COLUMN = (
    "Column of a table of numbers, from 1; all: each line goes on from the one before;"
    " pairs: a line holds several times, each with its value."
)
AS_IT_STANDS = (
    "Take numbers that are unlike a ground motion: of one sign, or far from zero."
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


def building() -> Any:
    """The option for the building below a body."""
    return option(
        "--building",
        "A mode of a linear building on whose floor the body stands; repeatable.",
        multiple=True,
        metavar="T=…,xi=…,gamma_psi=…",
    )


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
    column: str | None = option("--column", COLUMN, metavar="NUMBER|all|pairs")
    skip: str | None = option(
        "--skip",
        "Lines above a record, and below it, that are not read.",
        metavar="ABOVE[:BELOW]",
    )
    as_it_stands: bool = flag("--as-it-stands", AS_IT_STANDS)

    @property
    def stated(self) -> Stated:
        """What the options state of a file, as keywords of the library."""
        same = ("unit", "column", "skip", "as_it_stands")
        stated = {key: getattr(self, key) for key in same}
        return cast("Stated", {**stated, "dt": self.motion_dt})


@dataclass(frozen=True)
class Ground:
    """The motion of a call: one pulse or motion document, or None and a set of
    records.
    """

    motion: Motion | None  # None with a set of records
    recordings: tuple[Recording, ...] = ()  # the set of records
    grid: Grid | None = None  # one cell, the demand; None without one
    upwards: Upwards | None = None  # vertical motion that the motions have already
    # of a pulse whose amplitude and frequency are not stated yet; None for a motion
    # that is that of a floor already, and without one
    building: Building | None = None

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

    def on_floor(self, building: Building | None) -> Ground:
        """Return the motions on a floor of a building; that of a pulse waits for its
        amplitude and frequency.
        """
        if building is None:
            return self
        from ..motions.buildings import floor_of

        for r in self.recordings:
            note(*ends_abruptly(r.label, r.record.acceleration))
        recordings = tuple(r.on_floor(building) for r in self.recordings)
        if self.motion is None or self.motion.acceleration is None:
            waits = None if self.motion is None else building
            return replace(self, recordings=recordings, building=waits)
        note(*ends_abruptly(self.motion.name, self.motion.segments.s_end))
        return replace(self, motion=floor_of(self.motion, building))

    def with_grid(self, grid: Grid) -> Ground:
        """Return the motions with their demand. Raises UsageError for a pulse on
        a floor whose amplitude or frequency is dimensionless.
        """
        if self.building is None or self.motion is None:
            return replace(self, grid=grid)
        from ..motions.floors import moved_by_floor

        motion, grid = moved_by_floor(self.motion, grid, self.building.modes)
        return replace(self, motion=motion, grid=grid, building=None)


def ends_abruptly(label: str, acceleration: np.ndarray) -> list[str]:
    """Return a line on a record that ends with a part of its peak; none for another.
    acceleration: its samples, in any unit.
    """
    share = abs(float(acceleration[-1])) / float(abs(acceleration).max() or 1.0)
    if share <= 1e-3:
        return []
    return [
        f"{label}: the record ends with {100.0 * share:.2g} % of its PGA, and the"
        " building then vibrates freely"
    ]


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
        "--motion",
        _MOTION,
        multiple=True,
        type=InputPath(),
        metavar="FILE[,unit=g,column=2,dt=0.01,skip=5,component=NS]",
    )


# The name of a pulse and its parameters, which are the words of `pulse` in Python.
OF_A_PULSE = tuple(of.name for of in fields(Source) if of.name != "motion")


@dataclass(frozen=True)
class Motions(Reading, Source):
    """The ground motion: a pulse, a motion document, a record or a set of them."""

    # True if an amplitude and a frequency are stated beside it
    takes_demand: ClassVar[bool] = False

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
    building: tuple[str, ...] = building()

    @property
    def carrier(self) -> Building | None:
        """The building that --building states. Raises UsageError."""
        if not self.building:
            return None
        from ..motions.buildings import parse_building

        return parse_building(self.building)

    def floor(self, ground: Ground, waits: bool) -> Ground:
        """Return the motions on the floor that --building states; waits: an amplitude
        and a frequency of a pulse follow. Raises UsageError.
        """
        found = ground.on_floor(self.carrier)
        if found.building is not None and not waits:
            raise click.UsageError(
                "--building goes with records here, as the motion of a floor under a"
                " pulse depends on its frequency: rocking check, response, solve and"
                " report take one pulse"
            )
        return found

    def one(self) -> Ground:
        """Return the motion that the options describe. Raises UsageError for a set of
        records.
        """
        waits = self.takes_demand
        from ..motions.reading import read_motion

        if len(self.motion) > 1 or any(map(os.path.isdir, self.motion)):
            raise click.UsageError(
                f"--motion: found {' '.join(self.motion)}; expected one motion"
            )
        upwards, station = self.upwards()
        if not self.motion:
            found = Ground(self._pulse(station)).with_upwards(upwards)
            return self.floor(found, waits)
        with named(dt="motion_dt"):
            found = Ground(read_motion(self.motion[0], **self._choices(station)))
        if found.motion is not None and found.motion.acceleration is None:
            return self.floor(found.with_upwards(upwards), waits)
        return self.floor(found, waits).with_upwards(upwards)

    def several(
        self, files: tuple[str, ...], one_upwards: bool = False
    ) -> tuple[tuple[str, ...], Ground]:
        """Return (the structure files, the motion or set of records); one_upwards:
        refuse a vertical motion for a set.

        Records among the files belong to the set, so that a shell pattern after
        --motion works. Raises UsageError.
        """
        upwards, station = self.upwards()
        waits = self.takes_demand
        if not self.motion:
            pulse = Ground(self._pulse(station)).with_upwards(upwards)
            return files, self.floor(pulse, waits)
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
        if isinstance(found, tuple):
            placed = self.floor(Ground(None, found), waits)
            return files, placed.with_upwards(upwards)
        return files, self.floor(Ground(found).with_upwards(upwards), waits)

    def upwards(self) -> tuple[Upwards | None, float | None]:
        """Return (the vertical motion of a pulse or a file, the factor of the vertical
        component of the same file), None if not stated.
        """
        return None, None

    def _choices(self, station: float | None) -> Any:
        """Return the choices for the motion of a file."""
        refuse("does not go with --motion", *OF_A_PULSE)
        same = {key: getattr(self, key) for key in ("component", "scale", "scale_to")}
        return {**self.stated, **same, "vertical": station, "tell": note}

    def _pulse(self, station: float | None) -> Motion:
        from ..motions import pulse

        refuse(
            "goes with a record: give --motion",
            "component",
            "unit",
            "motion_dt",
            "column",
            "skip",
            "as_it_stands",
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
                for key in OF_A_PULSE[1:]
                if (value := getattr(self, key)) is not None
            },
        )
        return found if self.scale is None else found.scaled(self.scale)


@dataclass(frozen=True)
class BothWays(Motions):
    """The ground motion and a vertical one."""

    vertical: str | None = option(
        "--vertical", _VERTICAL, type=PulseOrPath(), metavar="FILE[,unit=g,…]"
    )
    vertical_scale: float | None = option(
        "--vertical-scale",
        "Factor of the vertical motion (default 1).",
        type=NUMBER,
        metavar="FACTOR",
    )

    def upwards(self) -> tuple[Upwards | None, float | None]:
        factor = 1.0 if self.vertical_scale is None else self.vertical_scale
        if self.vertical is None:
            refuse("goes with --vertical", "vertical_scale")
            return None, None
        if self.vertical == STATION:
            return None, factor
        from ..motions import PULSES, pulse
        from ..motions.biaxial import Upwards
        from ..motions.pulses import is_pulse
        from ..motions.reading import read_motion
        from ..motions.records import Stated

        added = not os.path.exists(self.vertical) and is_pulse(self.vertical)
        if self.vertical in PULSES or added:
            motion = pulse(self.vertical)
        else:
            stated = ("component", *Stated.__annotations__)
            with named(**{key: f"--vertical FILE,{key}=" for key in stated}):
                motion = read_motion(self.vertical, tell=note)
        return Upwards(motion, factor), None


def leave_out(line: str) -> None:
    """Print why a file of a directory cannot be read and is left out."""
    note(line, even_quiet=True)
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

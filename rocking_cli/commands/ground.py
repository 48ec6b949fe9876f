"""The options of the ground motion: pulses, records, the vertical motion, and the
demand of one amplitude and frequency.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import click

from ..errors import RockingError, UsageError
from .command import option, partly, refuse
from .options import remark_on
from .parameter_types import NUMBER, PULSE, STATION, InputPath, PulseOrPath, quantity
from .printing import note, warn

if TYPE_CHECKING:
    import numpy as np

    from ..motions import Motion
    from ..motions.biaxial import Upwards
    from ..motions.buildings import Building
    from ..motions.grid import Grid
    from ..motions.recording import Recording
    from ..structures import RockingParameters

_PULSE = ("pulse", "cycles", "gamma", "phase")
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
        """Return the motions with their demand. Raises click.UsageError for a pulse on
        a floor whose amplitude or frequency is dimensionless.
        """
        if self.building is None or self.motion is None:
            return replace(self, grid=grid)
        if grid.dimensionless or grid.amplitude.name != "a_g":
            raise click.UsageError(
                "--building goes with an amplitude and a frequency that have units:"
                " give --a-g and --f-g, --T-g or --omega-g"
            )
        from ..motions.buildings import floor_of
        from ..motions.grid import as_recorded

        a_g = float(grid.amplitude.values[0])
        omega = float(grid.frequency.values[0])
        moved = floor_of(self.motion, self.building, a_g, omega)
        return replace(self, motion=moved, grid=as_recorded(a_g), building=None)


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
        "--motion", _MOTION, multiple=True, type=InputPath(), metavar="FILE..."
    )


@dataclass(frozen=True)
class Motions(Reading, Source):
    """The ground motion: a pulse, a motion document, a record or a set of them."""

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

    def floor(self, ground: Ground, waits: bool) -> Ground:
        """Return the motions on the floor that --building states; waits: an amplitude
        and a frequency of a pulse follow. Raises UsageError.
        """
        from ..motions.buildings import parse_building

        found = ground.on_floor(parse_building(self.building))
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
        waits = isinstance(self, Shaking)
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
        waits = isinstance(self, Shaking)
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


@dataclass(frozen=True)
class Shaking:
    """One amplitude and one frequency, with units or dimensionless."""

    a_g: str | None = option(
        "--a-g",
        "Amplitude of the motion, m/s2 or with g; a negative one reverses it.",
        metavar="VALUE",
    )
    omega_g: str | None = option(
        "--omega-g", "Angular frequency of the motion, rad/s.", metavar="VALUE"
    )
    f_g: str | None = option("--f-g", "Frequency of the motion in Hz.", metavar="VALUE")
    T_g: str | None = option(
        "--T-g",
        "Period of the motion in s; for a rectangular pulse its duration t_p.",
        metavar="VALUE",
    )
    A: str | None = option(
        "--A", "Dimensionless amplitude a_scale a_g/(alpha g).", metavar="VALUE"
    )
    Omega: str | None = option(
        "--Omega", "Dimensionless frequency omega_g/p.", metavar="VALUE"
    )

    def of(self, ground: Ground) -> Ground:
        """Return the motion and its demand, a grid of one cell, None if the options
        state no value. Raises UsageError.
        """
        from ..motions.grid import parse_grid

        given = {
            one.name: value
            for one in fields(Shaking)
            if (value := getattr(self, one.name)) is not None
        }
        if given:
            refuse(
                "does not go with an amplitude: expected one of them for the PGA of the"
                " record",
                "scale_to",
            )
        own = None if ground.motion is None else ground.motion.acceleration
        if given.get("a_g", "").startswith("-"):
            given["a_g"] = given["a_g"][1:]
            ground = ground.reversed
        if own is not None and not given:
            given = {"a_g": f"{own!r} m/s2"}
        if not given:
            return ground
        from ..documents.quantities import with_a_point

        for key, value in given.items():
            if "," in value or ":" in value:
                also = (
                    ""
                    if key in ("a_g", "A")
                    else " (rocking check and solve take FROM:TO)"
                )
                raise click.UsageError(
                    f"--{key.replace('_', '-')}: found {value!r}; expected one"
                    f" value{also}{with_a_point(value)}"
                )
        axes = ",".join(f"{key}={value}" for key, value in given.items())
        try:
            grid = parse_grid(axes, own_time=own is not None or bool(ground.recordings))
        except UsageError as error:
            text = str(error).replace(
                "`grid`: ", ""
            )  # the axes are options of their own here
            raise UsageError(re.sub(r"`grid` (\w+):", r"`\1`:", text)) from None
        remark_on(grid=grid)
        return ground.with_grid(grid)


@dataclass(frozen=True)
class Demand(Shaking, BothWays):
    """The ground motion, a vertical one, and the demand."""

    def ends(self) -> list[Demand]:
        """Return the demands at both ends of a range of frequencies FROM:TO, if there
        is one. Raises click.UsageError.
        """
        given = {key: getattr(self, key) for key in ("omega_g", "f_g", "T_g", "Omega")}
        if (self.a_g or self.A) and not self.motion and not any(given.values()):
            ways = (
                "a range of frequencies such as --f-g 0.5:5, records by --motion FILE"
                " --scale-to PGA=0.3g"
            )
            raise click.UsageError(
                f"--a-g alone is no motion: give {ways}, or see the static lambda of"
                " rocking params"
            )
        of = {
            key: text.split(":")
            for key, text in given.items()
            if text and text.count(":") == 1
        }
        if of and self.building:
            raise click.UsageError(
                "--building does not go with a range of frequencies: give one"
            )
        return [replace(self, **{key: end}) for key, ends in of.items() for end in ends]


@dataclass(frozen=True)
class Directed(Demand):
    """The demand, or two horizontal components in a direction."""

    azimuth: str | None = option(
        "--azimuth",
        "Direction in deg, from the first component to the second; of a span the worst"
        " (check).",
        metavar="ANGLE|START:STOP:N",
    )

    def azimuths(self) -> np.ndarray | None:
        """Return the directions that --azimuth states [rad]. Raises UsageError."""
        if self.azimuth is None:
            return None
        import numpy as np

        from ..motions.grid import parse_span

        refuse(
            "does not go with --azimuth: --scale FACTOR scales both components",
            "scale_to",
            *(one.name for one in fields(Shaking)),
        )
        if not self.motion:
            raise click.UsageError("--azimuth goes with a record: give --motion")
        return np.radians(
            parse_span("--azimuth", self.azimuth.replace("deg", ""), "number")
        )


def sign() -> Any:
    """The option for the direction of the motion."""
    return option(
        "--sign",
        "Direction of the motion; both matters to bodies whose sides differ.",
        type=click.Choice(["+", "-", "both"]),
        default="+",
    )


def note_demand(shakes: Sequence[tuple[Motion, Grid]]) -> None:
    """Print the amplitude and frequency of the demand."""
    from ..motions.grid import demand_in_words
    from ..reports.plausibility import bare_remarks

    asked = click.get_current_context().params
    note(
        f"demand: {demand_in_words(shakes)}{_floor_in_words(shakes)}",
        *bare_remarks(
            f"a_g={asked['a_g']}" if asked["a_g"] else asked.get("scale_to") or ""
        ),
    )


def _floor_in_words(shakes: Sequence[tuple[Motion, Grid]]) -> str:
    """Return what a floor makes of the demand in words; empty on the ground."""
    from ..documents.quantities import DEFAULT_GRAVITY

    peaks = [
        float(grid.amplitude.values[0]) * motion.largest / DEFAULT_GRAVITY
        for motion, grid in shakes
        if motion.floor is not None
    ]
    if not peaks:
        return ""
    span = " to ".join(dict.fromkeys(f"{x:.4g}" for x in (min(peaks), max(peaks))))
    return f", of the ground; {span} g on the floor of the building"


def note_governing(
    structures: Iterable[RockingParameters], dimensionless: bool
) -> None:
    """Print the governing equation of each structure."""
    from ..dynamics.method import governing_method, model_in_words

    lines = (
        model_in_words(
            governing_method(one, dimensionless=dimensionless),
            one,
            dimensionless=dimensionless,
        )
        for one in structures
    )
    note(*dict.fromkeys(lines))

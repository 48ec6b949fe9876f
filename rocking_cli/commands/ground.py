"""The options of the ground motion: pulses, records, the vertical part."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import click

from ..errors import RockingError
from .groups import option
from .parameter_types import STATION, InputPath, PulseOrPath, Quantity, Registered, pulse_names
from .printing import note, warn

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.biaxial import Upwards
    from ..motions.grid import Grid
    from ..motions.recording import Recording

_PULSE = ("pulse", "cycles", "gamma", "phase")
DT = "Time between the values of a record in a single column."


@contextmanager
def _named(**names: str) -> Iterator[None]:
    """Context that replaces the names of library arguments in errors by those of options."""
    try:
        yield
    except RockingError as error:
        error.args = (re.sub(r"`(\w+)`", lambda found: f"`{names.get(found[1], found[1])}`", str(error)),)
        raise


@dataclass(frozen=True)
class Reading:
    """The options for reading records."""

    component: str | None = option(
        "--component", metavar="horizontal|all|NAME",
        help="Component of a record by name or number (default: each horizontal component of each file, as a motion of its own).",
    )  # fmt: skip
    unit: str | None = option("--unit", metavar="UNIT", help="Unit of a record in plain columns of numbers, such as g or m/s2.")
    motion_dt: float | None = option("--dt", "--motion-dt", type=Quantity("time"), metavar="TIME", help=DT)


@dataclass(frozen=True)
class Ground:
    """The motion of a call: one pulse or motion document, or None and a set of records. grid: one cell, the demand."""

    motion: Motion | None
    recordings: tuple[Recording, ...] = ()
    grid: Grid | None = None
    unread: tuple[str, ...] = ()  # files of a directory that cannot be read

    @property
    def shakes(self) -> list[tuple[Motion, Grid]]:
        """Each motion with its demand, which is the peak of a record if the call states none."""
        from ..motions.grid import as_recorded

        shakes = [(r.motion, self.grid or as_recorded(r.acceleration)) for r in self.recordings]
        return shakes if self.motion is None or self.grid is None else [*shakes, (self.motion, self.grid)]

    def with_upwards(self, upwards: Upwards | None) -> Ground:
        """The same motions together with a vertical one."""
        if upwards is None:
            return self
        motion = None if self.motion is None else upwards(self.motion)
        return replace(self, motion=motion, recordings=tuple(replace(r, upwards=upwards) for r in self.recordings))

    def of_one(self, upwards: Upwards | None) -> Ground:
        """The same motion together with a vertical one. Raises click.UsageError for a vertical one and a set of records."""
        if upwards is not None and self.motion is None:
            raise click.UsageError("--vertical goes with one pulse or motion document here, not with a set of records")
        return self.with_upwards(upwards)


@dataclass(frozen=True)
class Vertical:
    """A vertical motion."""

    vertical: str | None = option(
        "--vertical", type=PulseOrPath(), metavar="MOTION",
        help=f"Vertical motion, upwards: a pulse by name, a motion document, a record, or {STATION}: the component of the same file.",
    )  # fmt: skip
    vertical_scale: float | None = option(
        "--vertical-scale", type=float, metavar="FACTOR", help="Factor of the vertical motion (default 1)."
    )
    vertical_component: str | None = option("--vertical-component", metavar="NAME", help="The component of a file that holds several.")
    vertical_unit: str | None = option("--vertical-unit", metavar="UNIT", help="Unit of a vertical record in plain columns of numbers.")
    vertical_dt: float | None = option("--vertical-dt", type=Quantity("time"), metavar="TIME", help=DT)

    def _reading(self) -> dict[str, Any]:
        found = {"component": self.vertical_component, "unit": self.vertical_unit, "dt": self.vertical_dt}
        return {key: value for key, value in found.items() if value is not None}

    def of_the_station(self) -> float | None:
        """The factor of the vertical component of the same file; None without --vertical station. Raises click.UsageError."""
        if self.vertical != STATION:
            return None
        for key in self._reading():
            raise click.UsageError(f"--vertical-{key} does not go with --vertical {STATION}")
        return 1.0 if self.vertical_scale is None else self.vertical_scale

    def upwards(self) -> Upwards | None:
        """The vertical motion of a pulse or a file; None without one. Raises UsageError."""
        given = self._reading()
        if self.vertical is None:
            for key in [*(["scale"] if self.vertical_scale is not None else []), *given]:
                raise click.UsageError(f"--vertical-{key} goes with --vertical")
        if self.vertical in (None, STATION):
            return None
        from ..motions import PULSES, pulse
        from ..motions.biaxial import Upwards
        from ..motions.reading import read_motion

        if self.vertical in PULSES:
            for key in given:
                raise click.UsageError(f"--vertical-{key} goes with a record: give one to --vertical")
            motion = pulse(self.vertical)
        else:
            with _named(component="vertical_component", unit="vertical_unit", dt="vertical_dt"):
                motion = read_motion(self.vertical, tell=note, **given)
        return Upwards(motion, 1.0 if self.vertical_scale is None else self.vertical_scale)


@dataclass(frozen=True)
class Source:
    """A pulse by name, or files of motions."""

    pulse: str | None = option("--pulse", type=Registered(pulse_names), help="Ground motion (default: sine); see `rocking help motions`.")
    cycles: float | None = option("--cycles", type=float, help="Cycles of a sine or cosine, in half cycles (default 1).")
    gamma: float | None = option("--gamma", type=float, help="Duration over period of a mavroeidis-papageorgiou pulse (default 2).")
    phase: float | None = option(
        "--phase", type=Quantity("angle"), metavar="ANGLE",
        help="Phase of a mavroeidis-papageorgiou pulse, in rad or with a unit (default 0).",
    )  # fmt: skip
    motion: tuple[str, ...] = option(
        "--motion", multiple=True, type=InputPath(), metavar="FILE...",
        help="A record or a motion document instead of a pulse; for a set: records, a directory or a list; repeatable.",
    )  # fmt: skip


@dataclass(frozen=True)
class Motions(Reading, Source):
    """The ground motion: a pulse, a motion document, a record or a set of them."""

    scale: float | None = option("--scale", type=float, metavar="FACTOR", help="Factor of the motion; a negative one reverses it.")
    scale_to: str | None = option("--scale-to", metavar="IM=VALUE", help="Scale a record to an intensity measure, such as PGA=0.35g.")

    def one(self, vertical: Vertical | None = None) -> Ground:
        """The motion that the options describe, with its vertical part. Raises UsageError for a set of records."""
        if len(self.motion) > 1 or any(map(os.path.isdir, self.motion)):
            raise click.UsageError(f"--motion: found {' '.join(self.motion)}; expected one motion")

        def read(paths: tuple[str, ...], **given: Any) -> Motion:
            from ..motions.reading import read_motion

            return read_motion(paths[0], **given)

        found = Ground(self._read(vertical, read))
        return found if vertical is None else found.with_upwards(vertical.upwards())

    def several(self, files: tuple[str, ...], vertical: Vertical | None = None) -> tuple[tuple[str, ...], Ground]:
        """(the structure files, the motion or the set of records that the options describe), without a vertical motion.

        Records among the files belong to the set, so that a shell pattern after --motion works. Raises UsageError.
        """
        unread: list[str] = []

        def leave_out(line: str) -> None:
            warn(line)
            unread.append(line)

        def read(paths: tuple[str, ...], **given: Any) -> Motion | tuple[Recording, ...]:
            from ..motions.reading import holds_records, read_motions

            nonlocal files
            own = [path for path in files if holds_records(path)]
            files = tuple(path for path in files if path not in own)
            if "-" in paths and "-" in files:
                raise click.UsageError("standard input is given both as structure and as motion; expected only one")
            return read_motions((*paths, *own), unread=leave_out, **given)

        found = self._read(vertical, read)
        return files, Ground(None, found, None, tuple(unread)) if isinstance(found, tuple) else Ground(found)

    def _read(self, vertical: Vertical | None, read: Callable[..., Any]) -> Any:
        station = None if vertical is None else vertical.of_the_station()
        given = {key: value for key, value in vars(self).items() if value is not None and key != "motion"}
        if station is not None:
            given["vertical"] = station
        shape = {key: given.pop(key) for key in _PULSE if key in given}
        if self.motion:
            for key in shape:
                raise click.UsageError(f"--motion does not go with --{key}")
            if "motion_dt" in given:
                given["dt"] = given.pop("motion_dt")
            with _named(dt="motion_dt"):
                return read(self.motion, tell=note, **given)
        from ..motions import pulse

        factor = given.pop("scale", None)
        for key in given:
            flag = f"--vertical {STATION}" if key == "vertical" else f"--{key.replace('_', '-')}"
            raise click.UsageError(f"{flag} goes with a record: give --motion")
        found = pulse(shape.pop("pulse", "sine"), **shape)
        return found if factor is None else found.scaled(factor)

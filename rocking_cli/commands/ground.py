"""The options of the ground motion: pulses, records, the vertical part, one amplitude and frequency."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial, wraps
from typing import TYPE_CHECKING, Any

import click

from ..errors import RockingError, UsageError
from .options import note, remark_on, time
from .parameter_types import STATION, InputPath, PulseOrPath, Registered, pulse_names

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.recording import Recording

F = Callable[..., Any]

pulse = click.option("--pulse", type=Registered(pulse_names), help="Ground motion (default: sine); see `rocking help motions`.")
cycles = click.option("--cycles", type=float, help="Cycles of a sine or cosine, in half cycles (default 1).")
gamma = click.option("--gamma", type=float, help="Duration over period of a mavroeidis-papageorgiou pulse (default 2).")
phase = click.option("--phase", metavar="ANGLE", help="Phase of a mavroeidis-papageorgiou pulse, in rad or with a unit (default 0).")
motion_file = click.option(
    "--motion", "motion_file", type=InputPath(), metavar="FILE", help="A record, or a motion document, instead of a pulse."
)
motion_files = click.option(
    "--motion", "motion_files", multiple=True, type=InputPath(), metavar="FILE...",
    help="Records, a directory or a list of them, or one motion document, instead of a pulse; repeatable.",
)  # fmt: skip
scale = click.option("--scale", type=float, metavar="FACTOR", help="Factor of the motion; a negative one turns it over.")
scale_to = click.option("--scale-to", metavar="IM=VALUE", help="Scale a record to an intensity measure, such as PGA=0.35g.")
component = click.option(
    "--component", metavar="horizontal|all|NAME",
    help="Components of a record, one by name or number (default: of each file of a set the horizontal ones, as motions of their own).",
)  # fmt: skip
unit = click.option("--unit", metavar="UNIT", help="Unit of a record in plain columns of numbers, such as g or m/s2.")


def dt(flag: str = "--dt", name: str = "dt") -> F:
    """The time between the values of a record; flag: where the command has a --dt of its own."""
    return click.option(flag, name, metavar="TIME", help="Time between the values of a record in a single column.")


def motion(command: F | None = None, *, dt_flag: str = "--dt") -> F:
    """The options of the ground motion; the command gets the motion itself. dt_flag: where the command has a --dt of its own."""
    if command is None:
        return partial(motion, dt_flag=dt_flag)

    @wraps(command)
    def with_motion(*arguments: Any, **given: Any) -> Any:
        mine = {key: given.pop(key) for key in (*_PULSE, *_FILE)}
        there = {k: v for k, v in mine.items() if v is not None}
        if os.path.isdir(there.get("motion_file", "")):
            raise click.UsageError(f"--motion: {there['motion_file']} is a directory; accepted here is one motion")
        found = _motion_of(there | _of_the_station(given), dt_flag, given.get("quiet", False), [])
        return command(*arguments, motion=found, **given)

    for option in (scale_to, scale, dt(dt_flag, "motion_dt"), unit, component, motion_file, phase, gamma, cycles, pulse):
        with_motion = option(with_motion)
    return with_motion


def vertical(command: F) -> F:
    """--vertical and what goes with it, below the options of the motion, which then has a vertical part."""

    @wraps(command)
    def with_vertical(*arguments: Any, upwards: Callable[[Motion], Motion] | None, **given: Any) -> Any:
        if upwards is not None:
            if given["motion"] is None:
                raise click.UsageError("--vertical goes with one pulse or motion document here, not with a set of records")
            given["motion"] = upwards(given["motion"])
        return command(*arguments, **given)

    return vertical_of_each(with_vertical)


def vertical_of_each(command: F) -> F:
    """The same where motions may be a set of records: the command gets `upwards`, which gives a motion that vertical part, or None."""

    @wraps(command)
    def with_vertical(*arguments: Any, vertical: str | None, **given: Any) -> Any:
        own = {key: given.pop(f"vertical_{key}") for key in ("scale", *_OF_RECORDS)}
        there = {key: value for key, value in own.items() if value is not None}
        if vertical == STATION:  # the motions have it already
            return command(*arguments, upwards=None, **given)
        if vertical is None:
            if there:
                raise click.UsageError(f"--vertical-{next(iter(there))} goes with --vertical")
            return command(*arguments, upwards=None, **given)
        from ..motions.biaxial import Upwards

        factor = there.pop("scale", 1.0)
        up = _upwards(vertical, there, given.get("quiet", False))
        return command(*arguments, upwards=Upwards(up, factor), **given)

    for name, kind, metavar, meaning in (
        ("dt", str, "TIME", "Time between the values of a vertical record in a single column."),
        ("unit", str, "UNIT", "Unit of a vertical record in plain columns of numbers."),
        ("component", str, "NAME", "The component of a file that holds several."),
        ("scale", float, "FACTOR", "Factor of the vertical motion (default 1)."),
    ):
        with_vertical = click.option(f"--vertical-{name}", type=kind, metavar=metavar, help=meaning)(with_vertical)
    told = f"Vertical motion, upwards: a pulse by name, a motion document, a record, or {STATION}: the component of the same file."
    return click.option("--vertical", type=PulseOrPath(), metavar="MOTION", help=told)(with_vertical)


_OF_RECORDS = ("component", "unit", "dt")


def _upwards(name: str, given: dict[str, Any], quiet: bool) -> Motion:
    """The vertical motion: a pulse, or what a file holds."""
    from ..motions import PULSES, pulse
    from ..motions.reading import read_motion

    if name in PULSES:
        for key in given:
            raise click.UsageError(f"--vertical-{key} goes with a record: give one to --vertical")
        return pulse(name)
    if "dt" in given:
        given["dt"] = time("--vertical-dt", given["dt"])
    try:
        return read_motion(name, tell=partial(note, quiet=quiet), **given)
    except RockingError as error:
        error.args = (re.sub(rf"`({'|'.join(_OF_RECORDS)})`", r"--vertical-\1", str(error)),)
        raise


def motions(command: F) -> F:
    """The options of the ground motion, which may be a set of records; the command gets `motion`, None where there are records, and
    `recordings`.

    Records among the command's `files` belong to the set, so that a shell's pattern after --motion does.
    """

    @wraps(command)
    def with_motions(*arguments: Any, **given: Any) -> Any:
        mine = {key: given.pop(key) for key in (*_PULSE, "motion_files", *_FILE[1:])}
        there = {k: v for k, v in mine.items() if v is not None and v != ()}
        if "motion_files" in there:
            from ..motions.recording import holds_records

            own = {path: holds_records(path) for path in given["files"]}
            there["motion_files"] += tuple(path for path in given["files"] if own[path])
            given["files"] = tuple(path for path in given["files"] if not own[path])
            if "-" in there["motion_files"] and "-" in given["files"]:
                raise click.UsageError("standard input is given as structure and as motion; accepted is one of them")
        unread: list[str] = []
        found = _motion_of(there | _of_the_station(given), "--dt", given.get("quiet", False), unread)
        is_set = isinstance(found, tuple)
        result = command(*arguments, motion=None if is_set else found, recordings=found if is_set else (), **given)
        end_unread(unread)
        return result

    for option in (scale_to, scale, dt("--dt", "motion_dt"), unit, component, motion_files, phase, gamma, cycles, pulse):
        with_motions = option(with_motions)
    return with_motions


def _of_the_station(given: dict[str, Any]) -> dict[str, float]:
    """The factor of the vertical component of the same file, where --vertical asks for it."""
    if given.get("vertical") != STATION:
        return {}
    for key in _OF_RECORDS:
        if given[f"vertical_{key}"] is not None:
            raise click.UsageError(f"--vertical-{key} does not go with --vertical {STATION}")
    factor = given["vertical_scale"]
    return {"vertical": 1.0 if factor is None else factor}


def end_unread(files: list[str]) -> None:
    """End with exit code 4 where files of a directory could not be read."""
    if files:
        click.get_current_context().exit(4)


_PULSE = ("pulse", "cycles", "gamma", "phase")
_FILE = ("motion_file", "component", "unit", "motion_dt", "scale", "scale_to")


def _motion_of(given: dict[str, Any], dt_flag: str, quiet: bool, unread: list[str]) -> Motion | tuple[Recording, ...]:
    """The motion that the options describe; the records of a set where they are `motion_files`, and then in `unread` the files of a
    directory that cannot be read."""
    from ..motions import pulse as named_pulse

    if "phase" in given:
        from ..documents.quantities import parse_quantity

        try:
            given["phase"] = parse_quantity(given["phase"], "angle")
        except ValueError as error:
            raise click.UsageError(f"--phase: found {given['phase']!r}; accepted is {error}") from None
    if "motion_dt" in given:
        given["dt"] = time(dt_flag, given.pop("motion_dt"))
    if "motion_file" in given or "motion_files" in given:
        for key in _PULSE:
            if key in given:
                raise click.UsageError(f"--motion does not go with --{key}")
        from ..motions.reading import read_motion
        from ..motions.recording import read_motions

        def leave_out(line: str) -> None:
            note(line, quiet=False)
            unread.append(line)

        tell = partial(note, quiet=quiet)
        try:
            if "motion_file" in given:
                return read_motion(given.pop("motion_file"), tell=tell, **given)
            return read_motions(given.pop("motion_files"), tell=tell, unread=leave_out, **given)
        except RockingError as error:
            error.args = (str(error).replace("`dt`", dt_flag),)
            raise
    for key, flag in (
        ("component", "--component"),
        ("unit", "--unit"),
        ("dt", dt_flag),
        ("scale_to", "--scale-to"),
        ("vertical", f"--vertical {STATION}"),
    ):
        if key in given:
            raise click.UsageError(f"{flag} goes with a record: give --motion")
    factor = given.pop("scale", None)
    found = named_pulse(given.pop("pulse", "sine"), **given)
    return found if factor is None else found.scaled(factor)


def shaking(command: F) -> F:
    """One amplitude and one frequency, with units or dimensionless; the command gets a grid of one cell, None without any.

    A record has both; only its peak may be given anew. Of a set of records there is no grid unless it is.
    """

    @wraps(command)
    def with_shaking(*arguments: Any, **given: Any) -> Any:
        from ..motions.grid import parse_grid

        own = given["motion"].acceleration if given.get("motion") is not None else None
        records = bool(given.get("recordings"))
        flags = {"a_g": "--a-g", "omega_g": "--omega-g", "f_g": "--f-g", "T_g": "--T-g", "A": "--A", "Omega": "--Omega"}
        axes = {key: given.pop(key.lower() if key in ("A", "Omega", "T_g") else key) for key in flags}
        there = {key: value for key, value in axes.items() if value is not None}
        if there.get("a_g", "").startswith("-"):  # the same motion turned over
            there["a_g"] = there["a_g"][1:]
            if given.get("motion") is not None:
                given["motion"] = given["motion"].scaled(-1.0)
            if given.get("recordings"):
                given["recordings"] = tuple(replace(r, factor=-r.factor) for r in given["recordings"])
        grid = None
        if own is not None and not there:
            there = {"a_g": f"{own!r} m/s2"}
        for key, value in there.items():
            if "," in value:
                raise click.UsageError(f"{flags[key]}: found {value!r}; accepted is one value")
        if there:
            try:
                grid = parse_grid(",".join(f"{key}={value}" for key, value in there.items()), own_time=own is not None or records)
            except UsageError as error:
                text = str(error).replace("`grid`: ", "")  # the axes are options of their own here
                raise UsageError(re.sub(r"`grid` (\w+):", r"`\1`:", text)) from None
            if grid.shape != (1, 1):
                raise UsageError(f"found {' '.join(f'{flags[k]} {v}' for k, v in there.items())}; accepted is one value of each")
        remark_on(grid=grid)
        return command(*arguments, shaking=grid, **given)

    for name, meaning in (
        ("--Omega", "Dimensionless frequency omega_g/p."),
        ("--A", "Dimensionless amplitude a_scale a_g/(alpha g)."),
        ("--T-g", "Its period in s, the duration t_p of a rectangular pulse."),
        ("--f-g", "Its frequency in Hz."),
        ("--omega-g", "Angular frequency of the motion, rad/s."),
        ("--a-g", "Amplitude of the ground acceleration, m/s2 or with g; a negative one turns the motion over."),
    ):
        with_shaking = click.option(name, metavar="VALUE", help=meaning)(with_shaking)
    return with_shaking

"""The options of the demand: amplitude, frequency and direction of a motion, and the
lines that name them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar

import click

from ..errors import UsageError
from .command import option, refuse
from .ground import BothWays, Ground
from .options import remark_on
from .printing import detail, note

if TYPE_CHECKING:
    import numpy as np

    from ..motions import Motion
    from ..motions.grid import Grid
    from ..structures import RockingParameters


@dataclass(frozen=True)
class Shaking:
    """One amplitude and one frequency, with units or dimensionless."""

    a_g: str | None = option(
        "--pga --a-g",
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
        stated = {
            one.name: value
            for one in fields(Shaking)
            if (value := getattr(self, one.name)) is not None
        }
        if stated:
            refuse(
                "does not go with an amplitude: expected one of them for the PGA of the"
                " record",
                "scale_to",
            )
        own = None if ground.motion is None else ground.motion.acceleration
        if stated.get("a_g", "").startswith("-"):
            stated["a_g"] = stated["a_g"][1:]
            ground = ground.reversed
        if own is not None and not stated:
            stated = {"a_g": f"{own!r} m/s2"}
        if not stated:
            return ground
        _require_single(stated)
        grid = _grid(stated, own_time=own is not None or bool(ground.recordings))
        remark_on(grid=grid)
        return ground.with_grid(grid)


def _require_single(stated: Mapping[str, str]) -> None:
    """Raise click.UsageError for an option that states several values."""
    from ..documents.quantities import with_a_point

    for key, value in stated.items():
        if "," in value or ":" in value:
            also = (
                "" if key in ("a_g", "A") else " (rocking check and solve take FROM:TO)"
            )
            raise click.UsageError(
                f"--{key.replace('_', '-')}: found {value!r}; expected one"
                f" value{also}{with_a_point(value)}"
            )


def _grid(stated: Mapping[str, str], own_time: bool) -> Grid:
    """Return the grid of one cell that options state; own_time: True if the motion has
    its own time. Raises UsageError, which names the options.
    """
    from ..motions.grid import parse_grid

    axes = ",".join(f"{key}={value}" for key, value in stated.items())
    try:
        return parse_grid(axes, own_time=own_time)
    except UsageError as error:
        # the axes are options of their own here
        text = str(error).replace("`grid`: ", "")
        raise UsageError(re.sub(r"`grid` (\w+):", r"`\1`:", text)) from None


@dataclass(frozen=True)
class DemandOptions(Shaking, BothWays):
    """The ground motion, a vertical one, and the demand."""

    takes_demand: ClassVar[bool] = True

    def ends(self) -> list[DemandOptions]:
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
        return [replace(self, **{key: end}) for key, ends in of.items() for end in ends]


@dataclass(frozen=True)
class Directed(DemandOptions):
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
            "does not go with --azimuth: --scale and --scale-to scale both components",
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
    detail(f"demand: {demand_in_words(shakes)}{_floor_in_words(shakes)}")
    note(
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
    from ..dynamics.method import governing_method
    from ..reports.remarks import model_in_words

    lines = (
        model_in_words(
            governing_method(one, dimensionless=dimensionless),
            one,
            dimensionless=dimensionless,
        )
        for one in structures
    )
    detail(*dict.fromkeys(lines))

"""The demand: one amplitude and one frequency of a motion."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from ..errors import UsageError
from .ground import Ground
from .groups import option
from .options import remark_on
from .printing import note

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.grid import Grid
    from ..structures import RockingParameters


def no_shaking(*instead: str) -> click.UsageError:
    """The error for a call without a motion; instead: other options that may state one."""
    return click.UsageError(", or ".join(("no shaking: give --a-g and --omega-g (or --f-g, --T-g)", *instead)))


def needed(ground: Ground) -> list[tuple[Motion, Grid]]:
    """The motions with their demands. Raises click.UsageError if there are none."""
    if not ground.shakes:
        raise no_shaking("--motion FILE")
    return ground.shakes


@dataclass(frozen=True)
class Shaking:
    """One amplitude and one frequency, with units or dimensionless."""

    a_g: str | None = option(
        "--a-g", metavar="VALUE", help="Amplitude of the ground acceleration, m/s2 or with g; a negative one reverses the motion."
    )
    omega_g: str | None = option("--omega-g", metavar="VALUE", help="Angular frequency of the motion, rad/s.")
    f_g: str | None = option("--f-g", metavar="VALUE", help="Its frequency in Hz.")
    T_g: str | None = option("--T-g", metavar="VALUE", help="Its period in s, the duration t_p of a rectangular pulse.")
    A: str | None = option("--A", metavar="VALUE", help="Dimensionless amplitude a_scale a_g/(alpha g).")
    Omega: str | None = option("--Omega", metavar="VALUE", help="Dimensionless frequency omega_g/p.")

    def of(self, ground: Ground) -> Ground:
        """The motion with its demand, a grid of one cell; the motion is reversed for a negative a_g.

        A record has both values, so only its peak may be given. The grid is None without any value. Raises UsageError.
        """
        from ..motions.grid import parse_grid

        given = {key: value for key, value in vars(self).items() if value is not None}
        own = None if ground.motion is None else ground.motion.acceleration
        if given.get("a_g", "").startswith("-"):
            given["a_g"] = given["a_g"][1:]
            motion = None if ground.motion is None else ground.motion.scaled(-1.0)
            ground = replace(ground, motion=motion, recordings=tuple(replace(r, factor=-r.factor) for r in ground.recordings))
        if own is not None and not given:
            given = {"a_g": f"{own!r} m/s2"}
        if not given:
            return ground
        flags = {key: f"--{key.replace('_', '-')}" for key in given}
        for key, value in given.items():
            if "," in value:
                raise click.UsageError(f"{flags[key]}: found {value!r}; expected one value")
        try:
            grid = parse_grid(
                ",".join(f"{key}={value}" for key, value in given.items()), own_time=own is not None or bool(ground.recordings)
            )
        except UsageError as error:
            text = str(error).replace("`grid`: ", "")  # the axes are options of their own here
            raise UsageError(re.sub(r"`grid` (\w+):", r"`\1`:", text)) from None
        if grid.shape != (1, 1):
            raise UsageError(f"found {' '.join(f'{flags[k]} {v}' for k, v in given.items())}; expected one value of each")
        remark_on(grid=grid)
        return replace(ground, grid=grid)


def note_demand(shakes: Sequence[tuple[Motion, Grid]]) -> None:
    """Print the amplitude and frequency of the demand, with the acceleration in m/s2 and g."""
    from ..motions.grid import demand_in_words
    from ..reports.plausibility import bare_remarks

    note(f"demand: {demand_in_words(shakes)}")
    asked = click.get_current_context().params
    for remark in bare_remarks(f"a_g={asked['a_g']}" if asked["a_g"] else asked.get("scale_to") or ""):
        note(remark)


def note_governing(structures: Iterable[RockingParameters], dimensionless: bool) -> None:
    """Print the governing equation of each structure."""
    from ..dynamics.method import governing_method, model_in_words

    for line in dict.fromkeys(
        model_in_words(governing_method(one, dimensionless=dimensionless), one, dimensionless=dimensionless) for one in structures
    ):
        note(line)

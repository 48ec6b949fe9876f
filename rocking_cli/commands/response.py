"""`rocking response`: the time history of one structure under one motion."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import click

from ..errors import UsageError
from . import ground, options
from .groups import option, takes
from .parameter_types import InputPath, Quantity
from .printing import emit, form, note, printed
from .shaking import Shaking, no_shaking, note_demand


@dataclass(frozen=True)
class OneMotion(ground.Motions):
    """The ground motion, with --dt for the rows."""

    motion_dt: float | None = option("--motion-dt", type=Quantity("time"), metavar="TIME", help=ground.DT)


@dataclass(frozen=True)
class Rows:
    """The options of `rocking response`."""

    release: float = option(
        "--release", type=float, default=0.0, metavar="RATIO", help="Release from theta/alpha = RATIO; without a motion: free rocking."
    )
    duration: float | None = option(
        "--duration", type=Quantity("time"), metavar="TIME", help="Duration of the rows (default: the shaking and 30/p after it)."
    )
    dt: float | None = option(
        "--dt", type=Quantity("time"), metavar="TIME", help="Time between two rows (default: the samples of a record, 500 rows of a pulse)."
    )
    steps: bool = option("--steps", is_flag=True, help="Rows at the solver's own steps instead.")
    events: bool = option("--events", is_flag=True, help="Uplifts, impacts, peaks, rest and overturning instead of the time history.")
    forces: bool = option("--forces", is_flag=True, help="Also the forces on the ground, or on the joints of an arch, over m g.")
    dimensionless: bool = option("--dimensionless", is_flag=True, help="theta/alpha against p t; --dt in p t too.")


@click.command(epilog="Example: rocking response configs/arch.yaml --pulse rectangular-impulse --a-g 0.9g --T-g 0.4 --model both --events")
@click.argument("file", type=InputPath())
@takes(motions=OneMotion, vertical=ground.Vertical, shaking=Shaking, model=options.Models, wanted=Rows)
@printed
def response(file: str, motions: OneMotion, vertical: ground.Vertical, shaking: Shaking, model: options.Models, wanted: Rows) -> int:
    """Time history of one structure: t [s], theta [rad], theta_dot [rad/s], ground_acceleration [m/s2].

    FILE holds one structure. An overturning body is followed to 3 alpha, or until it lies on its side or its linkage has
    collapsed. The speed of an impact in the events is the speed before it. With --json the last row of each model is a summary.
    --forces: fx_ratio and fz_ratio, the horizontal and vertical force over m g, and the friction that they need.
    """
    from ..responses.time_history import time_history

    shaken = shaking.of(motions.one(vertical))
    structures = options.structures_of((file,))
    if len(structures) != 1:
        raise click.UsageError(f"{file} holds {len(structures)} structures; expected one (rocking compare takes several)")
    if shaken.grid is None and (motions.pulse or motions.motion or not wanted.release):
        raise no_shaking("--A and --Omega", "--release without a motion for free rocking")
    if wanted.steps and wanted.dt is not None:
        raise click.UsageError("--steps does not go with --dt")
    if wanted.dt is not None and not wanted.dt > 0.0:
        raise UsageError(f"--dt: found {wanted.dt:g} s; expected a positive time")
    bare = shaken.grid is not None and shaken.grid.dimensionless
    methods = model.methods(structures, bare)
    found = time_history(
        structures[0], shaken.motion if shaken.grid else None, shaken.grid, methods, release=wanted.release, duration=wanted.duration
    )
    shown = {"dimensionless": wanted.dimensionless, "forces": wanted.forces}
    rows = found.events(**shown) if wanted.events else found.records(dt=wanted.dt, steps=wanted.steps, **shown)
    closing = found.summaries(**shown) if wanted.events and form() == "json" else ()
    emit(chain(rows, closing), ("model", "event") if wanted.events else ())
    if shaken.grid is not None:
        note_demand(shaken.shakes)
    for line in (*model.in_words(methods, structures, bare), *found.summary(forces=wanted.forces)):
        note(line)
    return 4 if found.failed else 0

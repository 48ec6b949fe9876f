"""`rocking response`: the time history of one structure under one motion."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import click

from ..errors import UsageError
from . import ground, options
from .parameter_types import InputPath

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.grid import Grid


@click.command(epilog="Example: rocking response configs/arch.yaml --pulse rectangular-impulse --a-g 0.9g --T-g 0.4 --model both --events")
@click.argument("file", type=InputPath())
@ground.motion(dt_flag="--motion-dt")
@ground.vertical
@ground.shaking
@options.methods
@click.option("--release", type=float, default=0.0, metavar="RATIO", help="Release from theta/alpha = RATIO; alone: free rocking.")
@click.option("--duration", metavar="TIME", help="Time to show (default: the shaking and 30/p after it).")
@click.option("--dt", metavar="TIME", help="Time between two rows (default: the samples of a record, 500 rows of a pulse).")
@click.option("--steps", is_flag=True, help="Rows at the solver's own steps instead.")
@click.option("--events", is_flag=True, help="Uplifts, impacts, peaks, rest and overturning instead of the time history.")
@click.option("--forces", is_flag=True, help="Also the forces on the ground, or on the joints of an arch, over m g.")
@click.option("--dimensionless", is_flag=True, help="theta/alpha against p t; --dt in p t too.")
@options.output_form
@options.quiet
@click.pass_context
def response(
    context: click.Context,
    file: str,
    motion: Motion,
    shaking: Grid | None,
    models: tuple[str, ...],
    tolerance: float,
    release: float,
    duration: str | None,
    dt: str | None,
    steps: bool,
    events: bool,
    forces: bool,
    dimensionless: bool,
    form: str | None,
    quiet: bool,
) -> None:
    """Time history of one structure: t [s], theta [rad], theta_dot [rad/s], ground_acceleration [m/s2].

    FILE holds one structure. An overturning body is followed to 3 alpha, or until it lies on its side or its linkage has
    collapsed. In the events the speed at an impact is that before it; with --json a summary of each model is the last record.
    --forces: fx_ratio and fz_ratio, the horizontal and vertical force over m g, and the friction that they need.
    """
    from ..dynamics.method import governing_method
    from ..responses.time_history import time_history

    structures = options.structures_of((file,))
    if len(structures) != 1:
        raise click.UsageError(f"{file} holds {len(structures)} structures, accepted is one; rocking compare takes several")
    if shaking is None and not release:
        raise click.UsageError("no shaking: give --a-g and --omega-g (or --f-g, --T-g), or --A and --Omega, or --release for free rocking")
    if shaking is None and (context.params["pulse"] or context.params["motion_file"]):
        raise click.UsageError("a motion needs --a-g and --omega-g (or --f-g, --T-g), or --A and --Omega")
    if steps and dt is not None:
        raise click.UsageError("--steps does not go with --dt")
    step = None if dt is None else options.time("--dt", dt)
    if step is not None and not step > 0.0:
        raise UsageError(f"--dt: found {dt}, accepted is a positive time")
    bare = shaking is not None and shaking.dimensionless
    methods = [governing_method(*structures, model=model, tolerance=tolerance, dimensionless=bare) for model in models]
    found = time_history(
        structures[0],
        motion if shaking else None,
        shaking,
        methods,
        release=release,
        duration=None if duration is None else options.time("--duration", duration),
    )
    shown = {"dimensionless": dimensionless, "forces": forces}
    records = found.events(**shown) if events else found.records(dt=step, steps=steps, **shown)
    closing = found.summaries(**shown) if events and form == "json" else ()
    options.emit(chain(records, closing), form, ("model", "event") if events else ())
    if shaking is not None:
        options.note_demand([(motion, shaking)], quiet)
    options.note_models(methods, structures, models, bare, quiet)
    for line in found.summary(forces=forces):
        options.note(line, quiet)
    if found.failed:
        context.exit(4)

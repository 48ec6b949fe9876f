"""`rocking compare`: structures under motions scaled alike, and the linear against the nonlinear equation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from . import ground, options

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.grid import Grid


@click.command(epilog="Example: rocking compare configs/block.yaml configs/spire.yaml configs/arch.yaml --A 2 --Omega 4 --eta 0.8")
@options.files
@ground.motion
@ground.shaking
@options.methods
@click.option("--eta", type=click.FloatRange(0.0, 1.0), help="Restitution for every structure instead of its own.")
@click.option("--curves", is_flag=True, help="The curves t, theta, tau, theta_ratio instead of a record a structure.")
@options.output_form
@options.quiet
@click.pass_context
def compare(
    context: click.Context,
    files: tuple[str, ...],
    motion: Motion,
    shaking: Grid | None,
    models: tuple[str, ...],
    tolerance: float,
    eta: float | None,
    curves: bool,
    form: str | None,
    quiet: bool,
) -> None:
    """Compare the responses of structures to one motion scaled to equal A and Omega.

    a_g and omega_g given in units are those of the first structure. A line on standard error says how far the dimensionless
    curves lie apart; for structures of equal restitution they collapse in the linear model (Fig. 8). --model both compares the
    equations (Fig. 7): peaks, and quarter periods of free rocking from 0.3, 0.6 and 0.9 alpha.
    """
    from ..dynamics.method import governing_method
    from ..responses import comparison

    structures = options.structures_of(files)
    if shaking is None:
        raise click.UsageError("no shaking: give --A and --Omega, or --a-g and --omega-g (or --f-g, --T-g) of the first structure")
    if eta is not None:
        try:
            structures = [s.with_restitution(eta) for s in structures]
        except ValueError as error:
            raise click.UsageError(f"--eta: {error}") from None
    bare = shaking.dimensionless
    methods = [governing_method(*structures, model=model, tolerance=tolerance, dimensionless=bare) for model in models]
    responses = comparison.compare(structures, motion, shaking, methods)
    options.emit((comparison.curve_records if curves else comparison.comparison_records)(responses, methods), form)
    options.note_models(methods, structures, models, bare, quiet)
    for method in methods:
        if len(structures) > 1:
            distance = comparison.collapse(responses, method.model)
            options.note(f"collapse, {method.model}: the dimensionless curves lie up to {distance:.2g} apart in theta/alpha", quiet)
    if len({s.eta for s in structures}) > 1:
        hint = "" if any(s.one_sided for s in structures) else "; --eta gives all the same"
        options.note(f"the structures differ in restitution, so their curves part at the first impact{hint}", quiet)
    if any(r.failed for r in responses):
        context.exit(4)

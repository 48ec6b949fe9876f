"""`rocking compare`: structures at equal A and Omega, or the linear and the nonlinear
equation.
"""

import click

from . import demand, equations, ground, options
from .command import command, flag, group, option, partly
from .printing import detail, emit, note, printed


@command(
    "rocking compare configs/block.yaml configs/spire.yaml configs/arch.yaml --A 2"
    " --Omega 4 --eta 0.8",
    printed,
)
def compare(
    files: tuple[str, ...] = options.files(),
    motions: ground.Motions = group(ground.Motions),
    shaking: demand.Shaking = group(demand.Shaking),
    model: equations.Models = group(equations.Models),
    eta: float | None = option(
        "--eta",
        "Restitution for every structure instead of its own.",
        type=click.FloatRange(0.0, 1.0),
    ),
    curves: bool = flag(
        "--curves",
        "Print the curves t, theta, tau, theta_ratio instead, which -o draws.",
    ),
    figure: options.FigureFile = group(options.FigureFile),
) -> None:
    """Compare the responses of structures to one motion scaled to equal A and Omega.

    a_g and omega_g with units hold for the first structure. A line on standard error
    states the largest distance of the dimensionless curves. For structures of equal
    restitution the linear curves coincide (Fig. 8). --model both compares the equations
    (Fig. 7): peaks, and quarter periods of free rocking from 0.3, 0.6 and 0.9 alpha.
    """
    from ..errors import StructureError
    from ..reports.remarks import direction_in_words, stuck_in_words
    from ..responses import comparison

    figure.check()
    shaken = shaking.of(motions.one())
    structures = options.structures_of(files)
    if shaken.grid is None or shaken.motion is None:
        raise ground.no_shaking("--A and --Omega")
    if eta is not None:
        try:
            structures = [s.with_restitution(eta) for s in structures]
        except StructureError as error:
            raise click.UsageError(f"--eta: {error}") from None
    methods = model.methods(structures, shaken.grid.dimensionless)
    responses = comparison.compare(structures, shaken.motion, shaken.grid, methods)
    if curves:
        emit(comparison.curve_rows(responses, methods))
    else:
        emit(comparison.comparison_rows(responses, methods))
    if figure.output is not None:
        figure.draw(list(comparison.curve_rows(responses, methods)))
    detail(*model.in_words(methods, structures, shaken.grid.dimensionless))
    note(
        *direction_in_words(*structures),
        *stuck_in_words(structures),
    )
    for method in methods:
        if len(structures) > 1:
            distance = comparison.collapse(responses, method.model)
            note(
                f"collapse, {method.model}: the dimensionless curves lie up to"
                f" {distance:.2g} apart in theta/alpha"
            )
    if len({s.eta for s in structures}) > 1:
        hint = (
            "" if any(s.one_sided for s in structures) else "; --eta gives all the same"
        )
        note(
            "the structures differ in restitution, so their curves part at the first"
            f" impact{hint}"
        )
    partly(any(r.failed for r in responses))

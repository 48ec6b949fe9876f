"""`rocking draw`: structures to scale."""

from pathlib import Path

from . import options
from .command import command, group
from .printing import note, quiet, units, units_of

MOST = 12  # panels that a page shows


@command("rocking draw configs/arch.yaml -o arch.svg", quiet, units)
def draw(
    files: tuple[str, ...] = options.files(),
    output: Path = options.output("The figure: .png, .svg or .pdf.", required=True),
    looks: options.Looks = group(options.Looks),
    overwrite: bool = options.overwrite(),
) -> None:
    """Draw structures to scale, a panel each: outline, pivots, mass centre, R and
    alpha; dashed: the shape at alpha.

    Structures of like size are at one scale. Others have a scale each, with a bar of
    one length. A body of kind rigid has no outline: its mass centre and the circle of
    its radius of gyration are drawn.

    For an arch the figure also has the voussoirs, the hinges numbered from springing A,
    and the displaced linkage; for a cracked spire the crack; for a stack the pieces
    below the interface on which it rocks. Kind parameters has no geometry and is left
    out. Figures need matplotlib: pip install matplotlib.
    """
    from ..reports.figures.drawing import draw_structures
    from ..structures import build_structure

    options.check_target(output, overwrite)
    documents = options.documents_of(files, MOST, "a figure")
    list(options.introduced(map(build_structure, documents)))
    draw_structures(
        documents,
        output,
        units=units_of(),
        look=looks.look(),
        overwrite=overwrite,
        tell=note,
    )

"""`rocking init`: a commented document to begin with."""

import click

from ..structures.templates import TEMPLATES
from . import streams
from .command import argument, command


@command("rocking init arch > arch.yaml")
def init(
    kind: str = argument(type=click.Choice(list(TEMPLATES)), metavar="KIND"),
) -> None:
    """Print a commented example document for a kind of structure. It is valid as it is.

    KIND is block, point_mass, spire, arch, frame, prism, drum, rigid, stack, wall or
    mechanism, or parameters (stated numbers instead of a geometry), or
    wall_between_floors, a wall whose top is held; rocking help documents lists all
    keys.
    """
    from ..structures.templates import template

    streams.put(*template(kind).splitlines())

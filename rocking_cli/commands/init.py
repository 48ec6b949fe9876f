"""`rocking init`: a commented document to begin with."""

from __future__ import annotations

import click

from ..structures.kinds import KINDS
from . import streams


@click.command(epilog="Example: rocking init arch > arch.yaml")
@click.argument("kind", type=click.Choice(list(KINDS)), metavar="KIND")
def init(kind: str) -> None:
    """Print a commented document of a kind of structure, which is valid as it is.

    KIND is block, point_mass, spire, arch, frame, prism, drum, rigid, stack, wall or parameters; rocking help documents lists all keys.
    """
    from ..structures.templates import template

    for line in template(kind).splitlines():
        streams.put(line)

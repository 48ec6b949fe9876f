"""`rocking init`: a commented document to begin with, and the schema of documents."""

import click

from ..structures.templates import TEMPLATES
from . import streams
from .command import argument, command, flag

SCHEMA = "rocking.schema.json"  # beside the document
_FOR_EDITORS = f"# yaml-language-server: $schema={SCHEMA}"


@command("rocking init arch > arch.yaml")
def init(
    kind: str | None = argument(
        type=click.Choice(list(TEMPLATES)), metavar="KIND", required=False
    ),
    schema: bool = flag(
        "--schema", "Print a JSON Schema of structure documents, for editors."
    ),
) -> None:
    """Print a commented example document for a kind of structure. It is valid as it is.

    KIND is one of {kinds}: parameters states numbers instead of a geometry,
    wall_between_floors is a wall whose top is held. rocking help documents lists all
    keys. The first line of the document names rocking.schema.json, which `rocking init
    --schema > rocking.schema.json` writes beside it: editors then complete and check
    its keys.
    """
    if schema:
        if kind is not None:
            raise click.UsageError("--schema is that of all kinds: leave out KIND")
        from ..structures.schema import schema_text

        streams.put(*schema_text().splitlines())
        return
    if kind is None:
        kinds = ", ".join(TEMPLATES)
        raise click.UsageError(
            f"Missing argument 'KIND'. Choose from: {kinds}; or give --schema"
        )
    from ..structures.templates import template

    streams.put(_FOR_EDITORS, *template(kind).splitlines())


init.help = str(init.help).format(kinds=", ".join(TEMPLATES))

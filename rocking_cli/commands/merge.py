"""`rocking merge`: the shards of a sweep, put together."""

from __future__ import annotations

from pathlib import Path

import click

from . import options
from .parameter_types import InputPath

MOST = 20  # missing shards that are named


@click.command(epilog="Example: rocking merge part-1.h5 part-2.h5 -o whole.h5")
@click.argument("files", nargs=-1, type=InputPath(), required=True, metavar="FILE...")
@options.output
@options.overwrite
@options.strict
@options.quiet
@click.pass_context
def merge(context: click.Context, files: tuple[str, ...], output: Path, overwrite: bool, strict: bool, quiet: bool) -> None:
    """Put together what `rocking spectrum --shard i/n` computed in n parts; exit code 4 where chunks are missing."""
    from ..spectra.file.merging import merge as put_together

    merged = put_together(files, output, overwrite=overwrite, strict=strict)
    options.note(f"{output}: {merged.there} of {merged.whole} chunks", quiet)
    if merged.elsewhere:
        options.note(f"computed on machines that differ: {merged.elsewhere}; the last digits of cells may differ", quiet)
    if merged.missing:
        shown = ", ".join(merged.missing[:MOST]) + (f" and {len(merged.missing) - MOST} more" if len(merged.missing) > MOST else "")
        options.note(f"missing or not complete: shard {shown}", quiet=False)
    if merged.there < merged.whole:
        context.exit(4)

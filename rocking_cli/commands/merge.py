"""`rocking merge`: joins the shards of a sweep."""

from pathlib import Path

from . import options
from .check_remarks import listed
from .command import argument, command, partly
from .parameter_types import InputPath
from .printing import note, quiet

MOST = 20  # missing shards in the message


_SHARD = "rocking spectrum --eta 0.9 --grid A=0.5:8:200,Omega=1:6:200 --chunk 20000"


@command(
    f"{_SHARD} --shard 1/2 -o 1.h5 && {_SHARD} --shard 2/2 -o 2.h5 && rocking merge"
    " 1.h5 2.h5 -o whole.h5",
    quiet,
)
def merge(
    files: tuple[str, ...] = argument(
        nargs=-1, type=InputPath(), required=True, metavar="FILE..."
    ),
    output: Path = options.output("The HDF5 file to write.", required=True),
    overwrite: bool = options.overwrite(),
    strict: bool = options.strict(),
) -> None:
    """Join the n files of `rocking spectrum --shard i/n` into one; exit code 4 if
    chunks are missing.
    """
    from ..spectra.file.merging import merge as put_together

    merged = put_together(files, output, overwrite=overwrite, strict=strict)
    note(
        f"{output}: has {merged.chunks} of the {merged.all_chunks} chunks of the sweep"
    )
    if merged.machine_differences:
        note(
            f"computed on machines that differ: {merged.machine_differences}; the last"
            " digits of cells may differ"
        )
    if merged.missing:
        shown = listed(list(merged.missing), MOST)
        note(f"missing or not complete: shard {shown}", even_quiet=True)
    partly(merged.chunks < merged.all_chunks)

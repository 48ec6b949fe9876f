"""`rocking convert`: the cells of a spectra file as rows."""

from .command import argument, command
from .parameter_types import InputPath
from .printing import emit, note, printed
from .progress import ProgressLine


@command(
    "rocking spectrum --eta 0.9 --grid A=0.5:8:20,Omega=5 -o slice.h5 && rocking"
    " convert slice.h5 --csv | head -n 3",
    printed,
)
def convert(file: str = argument(type=InputPath())) -> None:
    """Stream the computed cells of a spectra file, or of a table of verdicts, one row
    for each cell (CSV unless --json).
    """
    from ..spectra.file.reader import SpectraFile

    with SpectraFile(file, any_kind=True) as spectrum:
        if not spectrum.done.any():
            note(f"{file}: none of its cells is computed yet")
        emit(
            spectrum.cells(ProgressLine("convert", "blocks")),
            (*spectrum.frame.dimensions, "outcome", "theta_ratio"),
            form="csv",
        )

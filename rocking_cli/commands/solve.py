"""`rocking solve`: the values of a key from which a structure stands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from . import demand, options
from .command import command, group, option, partly
from .parameter_types import VariedKey
from .printing import detail, emit, form, note, printed
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..responses.solving import Boundary

COLUMNS = ("structure", "key", "value", "side", "capacity_demand")


@dataclass(frozen=True)
class SolveOptions:
    """The key to vary, and what a structure must withstand."""

    vary: str = option(
        "--vary",
        "The key and its range, scanned at N values (default 17).",
        required=True,
        type=VariedKey(),
        metavar="KEY=START:STOP[:N]",
    )
    margin: float = option(
        "--margin",
        "Required capacity over demand.",
        type=click.FloatRange(0.0, 100.0, min_open=True),
        default=1.0,
    )
    share: float = option(
        "--share",
        "Share of motions to stand under.",
        type=click.FloatRange(0.0, 1.0, min_open=True),
        default=1.0,
    )


@command(
    "rocking solve configs/block.yaml --vary width=0.5:0.8:4 --a-g 0.4g --f-g 1",
    printed,
)
def solve(
    files: tuple[str, ...] = options.files(),
    wanted: SolveOptions = group(SolveOptions),
    asked: demand.DemandOptions = group(demand.DemandOptions),
    sign: str = demand.sign(),
    workers: int | None = options.workers(),
    figure: options.FigureFile = group(options.FigureFile),
) -> None:
    """Find the values of a key from which each structure stands under a motion with a
    margin.

    One row for each boundary in the range: the value, the side on which the structure
    stands, and capacity_demand of the document with this value; without a boundary, a
    row with an empty value whose side is "stands everywhere" or "stands nowhere", or
    such as "stands at 14 of 17 values" if the others have no structure or no verdict.
    Under records the margin holds for a share of them; of a range of frequencies (--f-g
    0.5:2) the worst one counts. Two boundaries between neighbouring values of the scan
    may be missed. The equation is the governing one, as in rocking check.
    """
    from ..responses.solving import SCAN, NoAnswer, boundaries
    from ..structures.family import parse_variation
    from .check_remarks import narrow_intervals

    figure.check()
    files, motions = asked.several(files)
    if asked.ends() and asked.building:
        raise click.UsageError(
            "--building does not go with a range of frequencies here; expected the key"
            " building of the document"
        )
    ends = [end.of(motions) for end in asked.ends()]
    shaken = ends[0] if ends else asked.of(motions)
    up_to = ends[1].shakes if ends else []
    documents = options.documents_of(files)
    list(options.introduced(options.built_if_whole(documents)))
    shakes = (shaken.reversed if sign == "-" else shaken).needed()
    varied = parse_variation(wanted.vary, SCAN)

    remarks: list[str] = []
    edges: list[Boundary] = []
    scans: dict[str, list[tuple[float, float]]] = {}

    def rows() -> Iterator[dict[str, Any]]:
        for document in documents:
            scan: list[tuple[float, float]] = []
            found, lines = boundaries(
                document,
                varied,
                shakes,
                margin=wanted.margin,
                share=wanted.share,
                opposite=shaken.reversed.shakes if sign == "both" else [],
                up_to=up_to[0][1] if up_to else None,
                workers=workers,
                progress=ProgressLine("solve", "values"),
                scanned_at=None if figure.output is None else _append_to(scan),
            )
            scans[found[0].structure if found else document.source] = scan
            edges.extend(found)
            source = f"{document.source}: " if len(documents) > 1 else ""
            remarks.extend(f"{source}{line}" for line in lines)
            partly(any(isinstance(line, NoAnswer) for line in lines))
            yield from map(_row, found)

    emit(rows(), COLUMNS)
    if figure.output is not None:
        from ..reports.figures.boundaries import capacities_over
        from ..reports.wording import demand_plainly

        title = demand_plainly([*shakes, *up_to], asked.vertical)
        at = [x for one in edges for x in one.shown.values() if x is not None]
        key = next(iter(edges[0].shown)) if edges else varied.key
        with figure.canvas() as drawn:
            capacities_over(drawn, scans, at, (key, title), wanted.margin)
    demand.note_demand([*shakes, *up_to])
    note(*remarks)
    detail(
        f"the scan has {len(varied.values)} values; two boundaries between neighbours"
        " of them may be missed",
        narrow_intervals(shakes),
    )


def _append_to(scan: list[tuple[float, float]]) -> Callable[[float, float], None]:
    """Return a function that appends points to a scan."""
    return lambda value, capacity: scan.append((value, capacity))


def _row(boundary: Boundary) -> dict[str, Any]:
    """Return a boundary as a row; a table has the value in the unit of the range."""
    from ..documents.quantities import headed

    row = boundary.row()
    name, key, value = (row.pop(column) for column in ("structure", "key", "value"))
    if form() is None:
        shown = {
            heading: None if x is None else f"{x:.6g}"
            for heading, x in boundary.shown.items()
        }
        return {"structure": name, **shown, **row}
    heading = headed("value", boundary.unit if form() == "csv" else "")
    return {"structure": name, "key": key, heading: value, **row}

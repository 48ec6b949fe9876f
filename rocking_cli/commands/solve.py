"""`rocking solve`: the values of a key from which a structure stands."""

from typing import Any

import click

from . import ground, options
from .command import command, group, option, partly
from .printing import emit, form, note, printed
from .progress import ProgressLine

COLUMNS = ("structure", "key", "value", "side", "capacity_demand")
_SCAN = 17  # values of a range that states no number


@command(
    "rocking solve configs/block.yaml --vary width=0.5:0.8:4 --a-g 0.4g --f-g 1",
    printed,
)
def solve(
    files: tuple[str, ...] = options.files(),
    vary: str = option(
        "--vary",
        "The key and its range, scanned at N values (default 17).",
        required=True,
        metavar="KEY=START:STOP[:N]",
    ),
    margin: float = option(
        "--margin",
        "Required capacity over demand.",
        type=click.FloatRange(0.0, 100.0, min_open=True),
        default=1.0,
    ),
    share: float = option(
        "--share",
        "Share of motions to stand under.",
        type=click.FloatRange(0.0, 1.0, min_open=True),
        default=1.0,
    ),
    asked: ground.Demand = group(ground.Demand),
    sign: str = ground.sign(),
    workers: int | None = options.workers(),
) -> None:
    """Find the values of a key from which each structure stands under a motion with a
    margin.

    One row for each boundary in the range: the value, the side on which the structure
    stands, and capacity_demand of the document with this value; without a boundary, a
    row with an empty value whose side is "stands everywhere" or "stands nowhere". Under
    records the margin holds for a share of them; of a range of frequencies (--f-g
    0.5:2) the worst one counts. Two boundaries between neighbouring values of the scan
    may be missed. The equation is the governing one, as in rocking check.
    """
    from ..documents.quantities import headed
    from ..responses.solving import boundaries
    from ..structures.family import parse_variation

    files, motions = asked.several(files)
    ends = [end.of(motions) for end in asked.ends()]
    shaken = ends[0] if ends else asked.of(motions)
    documents = options.documents_of(files)
    options.introduce(list(options.built_if_whole(documents)))
    shakes = (shaken.reversed if sign == "-" else shaken).needed()
    given: dict[str, Any] = {
        "margin": margin,
        "share": share,
        "opposite": shaken.reversed.shakes if sign == "both" else [],
    }
    given |= {
        "up_to": ends[1].shakes[0][1] if ends else None,
        "workers": workers,
        "progress": ProgressLine("solve", "values"),
    }
    varied = parse_variation(vary, _SCAN)
    rows: list[dict[str, Any]] = []
    remarks: list[str] = []
    for document in documents:
        found, lines = boundaries(document, varied, shakes, **given)
        for one in found:
            row = one.row()
            name, key, value = (
                row.pop(column) for column in ("structure", "key", "value")
            )
            if form() is None:
                at = {
                    heading: None if x is None else f"{x:.6g}"
                    for heading, x in one.shown.items()
                }
            else:
                at = {
                    "key": key,
                    headed("value", one.unit if form() == "csv" else ""): value,
                }
            rows.append({"structure": name, **at, **row})
        remarks += [
            f"{document.source}: {line}" if len(documents) > 1 else line
            for line in lines
        ]
        partly(any(line.startswith("no ") for line in lines))
    emit(rows, COLUMNS, keys=("structure", varied.key))
    ground.note_demand([*shakes, *(ends[1].shakes if ends else [])])
    note(
        *remarks,
        f"the scan has {len(varied.values)} values; two boundaries between neighbours"
        " of them may be missed",
    )

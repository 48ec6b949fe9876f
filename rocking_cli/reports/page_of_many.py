"""A page on many structures under a motion: their capacities as a histogram, those with
the least capacity, and a table by label. All rows stand in a CSV file beside it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..responses.verdict import CHECK_COLUMNS, Verdict
from .figures.canvas import Figure
from .page_parts import Asked, Labels, details, lead, page_row, rendered, write
from .page_sections import image
from .tables import csv_lines
from .wording import capacity_left

WORST = 20  # rows of the table of the least capacities
_BINS = 40  # of the histogram


def beside_of(target: Path) -> Path:
    """Return the name of the CSV file beside a page."""
    return target.with_name(f"{target.stem}-rows.csv")


def write_page_of_many(
    found: Sequence[Verdict],
    labels: Labels,
    target: Path,
    asked: Asked,
    by: str | None,
    overwrite: bool,
) -> None:
    """Write the page on many verdicts, and the CSV file of all of them beside it.

    by: the label of the table by label, None without one. Raises OutputError.
    """
    worst = sorted(found, key=capacity_left)[:WORST]
    if unknown := sum(v.capacity_above is not None for v in found):
        more = f"Nothing overturns {unknown:,} of them in the search."
        asked = replace(asked, remarks=[*asked.remarks, more])
    text = rendered(
        asked,
        title=asked.title or f"Rocking of {len(labels):,} structures",
        lead=lead(found, asked),
        heading=f"The {len(worst)} with the least capacity",
        verdicts=details(worst, labels),
        beside=f"All {len(found):,} rows stand in {beside_of(target).name}.",
        capacities=image(lambda figure: histogram(figure, found)),
        drawn="Number of structures over their capacity",
        by=[] if by is None else _by_label(found, by, labels),
    )
    rows = [_row_of(v, labels[v.structure]) for v in found]
    columns = dict.fromkeys([*CHECK_COLUMNS, *(key for row in rows for key in row)])
    lines = csv_lines({key: row.get(key) for key in columns} for row in rows)
    write(beside_of(target), "".join(f"{line}\n" for line in lines), overwrite)
    write(target, text, overwrite)


def _row_of(v: Verdict, labels: Mapping[str, str]) -> dict[str, object]:
    """Return a verdict as a row with labels; one with the name of a column is called
    label_NAME.
    """
    row = v.row()
    return row | {f"label_{k}" if k in row else k: x for k, x in labels.items()}


def _by_label(
    found: Sequence[Verdict], by: str, labels: Labels
) -> list[dict[str, object]]:
    """Return the rows of the table by label, those with the least capacity first."""
    classes: dict[str, list[Verdict]] = {}
    for v in found:
        classes.setdefault(labels[v.structure][by], []).append(v)
    rows = []
    for value, own in sorted(
        classes.items(), key=lambda one: min(map(capacity_left, one[1]))
    ):
        least = min(own, key=capacity_left)
        falls = sum(v.falls for v in own)
        below = sum((v.capacity_demand or 1.0) < 1.0 for v in own)
        cells = {
            by: value or "–",
            "verdicts": f"{len(own):,}",
            "fall": f"{falls:,}",
            "capacity below the demand": f"{below:,}",
            "least capacity over demand": least.capacity_demand,
            "of": least.structure,
        }
        rows.append(page_row(cells, falls > 0))
    return rows


def histogram(figure: Figure, found: Sequence[Verdict]) -> None:
    """Draw the number of verdicts over capacity_demand; those below 1 are red."""
    figure.set_size_inches(6.4, 2.8)
    axes = figure.add_subplot()
    known = [v.capacity_demand for v in found if v.capacity_demand is not None]
    capacity = np.array(known or [1.0])
    low, high = (np.log2(x(capacity, initial=1.0)) for x in (np.min, np.max))
    width = max(high - low, 0.1) / _BINS
    # a bin ends at 1, where the colour changes
    first, last = np.floor(low / width), np.ceil(high / width)
    edges = 2.0 ** (width * np.arange(first, last + 2.0))
    counts, _ = np.histogram(known, edges)
    colours = ["#D55E00" if edge <= 1.0 else "#0072B2" for edge in edges[1:]]
    axes.bar(edges[:-1], counts, np.diff(edges), align="edge", color=colours)
    axes.axvline(1.0, color="k", lw=1.0)
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.set(xlabel="capacity over demand", ylabel="number")

"""`rocking records`: the contents and intensity measures of recorded ground motions."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from . import ground, options
from .command import command, group
from .printing import emit, note, printed, warn

if TYPE_CHECKING:
    from ..motions.records import Record

COLUMNS = (
    "name", "format", "component", "npts", "dt", "duration", "pga", "pga_time", "pgv", "pgd", "arias", "cav", "d5_75", "d5_95",
    "header_pga", "header_difference", "unit",
)  # fmt: skip


@command("rocking records configs/motions/synthetic.at2", printed)
def records(files: tuple[str, ...] = options.files(), reading: ground.Reading = group(ground.Reading)) -> int:
    """Show what records hold, a row a component: sampling and intensity measures in s, m/s2, m/s and m.

    FILE is a record of any known format, packed with gzip or not, - for standard input, a directory, or a list of files, one a line.
    --component selects horizontal, all (default), or one by name or number. Files of a directory that cannot be read are left out and
    named (exit code 4).
    The measures are integrals of the samples joined by straight lines, without any correction; header_pga is the peak in the header of
    the file, header_difference the relative excess of the peak of the samples over it, unit the unit of the file.
    """
    from ..motions.reading import read_set
    from ..motions.records.record import ALL, chosen

    if not files:
        raise click.UsageError("no record: give FILE, or - for standard input")
    notes: list[str] = []
    unread: list[str] = []

    def rows(found: list[Record]) -> list[dict[str, Any]]:
        records = chosen(found, reading.component or ALL)
        notes.extend(f"{record.source}: {remark}" for record in records for remark in record.remarks)
        return [_row(record) for record in records]

    taken = list(read_set(files, rows, unit=reading.unit, dt=reading.motion_dt, tell=notes.append, unread=unread.append))
    emit(taken, COLUMNS)
    for line in dict.fromkeys(notes):
        note(line)
    for line in unread:
        warn(line)
    return 4 if unread else 0


def _row(record: Record) -> dict[str, Any]:
    from ..motions.intensity import intensity

    measured = intensity(record)
    row = {key: getattr(record, key) for key in ("name", "format", "component", "npts", "dt", "duration")} | asdict(measured)
    difference = None if not record.header_pga else measured.pga / record.header_pga - 1.0
    return row | {"header_pga": record.header_pga, "header_difference": difference, "unit": record.unit}

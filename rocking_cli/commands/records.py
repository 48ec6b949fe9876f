"""`rocking records`: what recorded ground motions hold, and their intensity measures."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from . import ground, options

if TYPE_CHECKING:
    from ..motions.records import Record

COLUMNS = (
    "name", "format", "component", "npts", "dt", "duration", "pga", "pga_time", "pgv", "pgd", "arias", "cav", "d5_75", "d5_95",
    "header_pga", "header_difference", "unit",
)  # fmt: skip


@click.command(epilog="Example: rocking records configs/motions/synthetic.at2")
@options.files
@ground.component
@ground.unit
@ground.dt()
@options.output_form
@options.quiet
def records(files: tuple[str, ...], component: str | None, unit: str | None, dt: str | None, form: str | None, quiet: bool) -> None:
    """Show what records hold, a row a component: sampling and intensity measures in s, m/s2, m/s and m.

    FILE is a record of any known format, packed with gzip or not, - for standard input, a directory, or a list of files, one a line.
    Measures are of the samples joined by straight lines, without any correction; header_pga is the peak that the file itself states,
    header_difference by what part of it the peak of the samples exceeds it, unit that of the file.
    """
    from ..errors import DocumentError, NoAcceleration
    from ..motions.records import pick, read_bytes, record_files, records_of, unknown

    if not files:
        raise click.UsageError("no record: give FILE, or - for standard input")
    step = None if dt is None else options.time("--dt", dt)
    rows: list[dict[str, Any]] = []
    notes: list[str] = []
    for path, named in record_files(files):
        source, raw = read_bytes(path)
        try:
            found = records_of(source, raw, unit=unit, dt=step, named=named)
        except NoAcceleration as error:
            if named:
                raise
            notes.append(f"{error}; left out")
            continue
        if found is None and named:
            raise DocumentError(unknown(source, raw))
        if found is None:
            notes.append(f"{source}: left out, no record format")
            continue
        for record in found if component is None else [pick(found, component)]:
            rows.append(_row(record))
            notes += [f"{source}: {remark}" for remark in record.remarks]
    options.emit(rows, form, COLUMNS)
    for line in dict.fromkeys(notes):
        options.note(line, quiet)


def _row(record: Record) -> dict[str, Any]:
    from ..motions.intensity import intensity

    measured = intensity(record)
    row = {key: getattr(record, key) for key in ("name", "format", "component", "npts", "dt", "duration")} | asdict(measured)
    difference = None if not record.header_pga else measured.pga / record.header_pga - 1.0
    return row | {"header_pga": record.header_pga, "header_difference": difference, "unit": record.unit}

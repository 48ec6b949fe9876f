"""`rocking records`: the contents and intensity measures of recorded ground motions."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import ground, options
from .command import command, flag, group, option, refuse
from .parameter_types import NUMBER
from .printing import emit, note, printed

if TYPE_CHECKING:
    from ..motions.intensity_measures import Measure
    from ..motions.records import Record

# the columns that say which row it is, of a spectrum with T
KEYS = ("name", "component")
SPECTRUM_COLUMNS = ("name", "component", "damping", "T", "S_a", "S_d")
COLUMNS = (
    "name",
    "format",
    "component",
    "npts",
    "dt",
    "duration",
    "pga",
    "pga_time",
    "pgv",
    "pgd",
    "arias",
    "cav",
    "d5_75",
    "d5_95",
    "header_pga",
    "header_difference",
    "unit",
)


@dataclass(frozen=True)
class RecordsOptions:
    """What to print of the records."""

    export_spectrum: bool = flag(
        "--export-spectrum", "Print the elastic response spectrum instead."
    )
    periods: str | None = option(
        "--periods",
        "Periods of the spectrum (default 0.02:5:100:log s).",
        metavar="START:STOP:N[:log]",
    )
    damping: float | None = option(
        "--damping",
        "Damping ratio of the spectrum (default 0.05 for 5 %).",
        type=NUMBER,
    )
    building: tuple[str, ...] = ground.building()
    output: Path | None = options.output(
        "Write the one record as PEER AT2, or draw the rows: .at2, .png, .svg or .pdf."
    )
    overwrite: bool = options.overwrite()

    @property
    def record(self) -> Path | None:
        """The record to write, None for a figure and without an output."""
        drawn = self.output is not None and self.output.suffix in options.FIGURES
        return None if drawn else self.output

    @property
    def figure(self) -> options.FigureFile:
        """The figure to draw."""
        drawn = None if self.record is not None else self.output
        return options.FigureFile(drawn, self.overwrite)


@command("rocking records configs/motions/synthetic.at2", printed)
def records(
    files: tuple[str, ...] = options.files(),
    reading: ground.Reading = group(ground.Reading),
    wanted: RecordsOptions = group(RecordsOptions),
) -> None:
    """Show what records hold, a row a component: sampling and intensity measures in s,
    m/s2, m/s and m.

    FILE is a record of any known format, packed with gzip or not, - for standard input,
    a directory, or a list of files, one a line. --component selects horizontal, all
    (default), or one by name or number. Files of a directory that cannot be read are
    left out and named (exit code 4). header_pga is the peak in the header of the file,
    header_difference the relative excess of the peak of the samples over it, unit the
    unit of the file. --export-spectrum: the largest displacement S_d of an oscillator
    of period T, also between samples and after the record, and S_a = (2 pi/T)^2 S_d.
    --building: the absolute acceleration of a floor in place of the record, with
    floor_chord, the share of its peak that straight lines between its samples may miss.
    """
    from ..motions.buildings import floor_record, parse_building
    from ..motions.reading import read_set
    from ..motions.records import Given
    from ..motions.records.record import ALL, chosen
    from ..reports.units import dimension_of_measure

    figure = wanted.figure
    if wanted.output is None:
        figure.check()
    else:
        suffixes = (".at2", *options.FIGURES) if wanted.record else options.FIGURES
        options.check_target(wanted.output, wanted.overwrite, suffixes)
    if not files:
        raise click.UsageError("no record: give FILE, or - for standard input")
    if not wanted.export_spectrum:
        refuse("goes with --export-spectrum", "periods", "damping")
    house = parse_building(wanted.building)
    notes: list[str] = []
    unread: list[str] = []
    taken_records: list[Record] = []
    chords: dict[int, float] = {}

    def rows(found: list[Record]) -> list[dict[str, Any]]:
        records = chosen(found, reading.component or ALL)
        if house is not None:
            for record in records:
                notes.extend(ground.ends_abruptly(record.label, record.acceleration))
            floors = [floor_record(record, house) for record in records]
            records = [record for record, _ in floors]
            chords.update({id(record): chord for record, chord in floors})
        taken_records.extend(records)
        for record in records:
            notes.extend(f"{record.source}: {remark}" for remark in record.remarks)
        if wanted.export_spectrum:
            return [row for record in records for row in _spectrum(record, wanted)]
        return [_row(record, chords.get(id(record))) for record in records]

    with ground.named(dt="motion_dt"):
        taken = list(
            read_set(files, rows, Given.of(reading.stated), notes.append, unread.append)
        )
    if wanted.record is not None:
        _write(wanted.record, taken_records, wanted.overwrite)
    if wanted.export_spectrum:
        figure.emit(taken, SPECTRUM_COLUMNS)
    else:
        dimensions = {x.name: dimension_of_measure(x.name) for x in _further_measures()}
        emit(taken, COLUMNS, dimensions=dimensions)
        figure.draw(taken_records)
    note(*dict.fromkeys(notes))
    for line in unread:
        ground.leave_out(line)


def _spectrum(record: Record, wanted: RecordsOptions) -> list[dict[str, Any]]:
    """Return the rows of the response spectrum of a record. Raises UsageError."""
    from ..motions.grid import parse_span
    from ..motions.response_spectra import DAMPING, displacement_spectrum

    periods = parse_span("--periods", wanted.periods or "0.02:5:100:log", "time")
    damping = DAMPING if wanted.damping is None else wanted.damping
    displacement = displacement_spectrum(record, periods, damping)
    names = {"name": record.name, "component": record.component, "damping": damping}
    return [
        names | {"T": T, "S_a": (2.0 * math.pi / T) ** 2 * S_d, "S_d": S_d}
        for T, S_d in zip(periods.tolist(), displacement.tolist(), strict=True)
    ]


def _write(output: Path, records: list[Record], overwrite: bool) -> None:
    """Write the one record of a call. Raises click.UsageError for several."""
    from ..motions.records.writing import at2_text
    from ..publishing import published

    if len(records) != 1:
        raise click.UsageError(
            f"-o: found {len(records)} records; expected one (--component chooses it)"
        )
    with published(output, overwrite) as file:
        file.write(at2_text(records[0]).encode("ascii"))


def _further_measures() -> list[Measure]:
    """Return the measures of the registry that a record has and no column shows yet."""
    from ..motions.intensity_measures import MEASURES

    return [
        measure
        for measure in MEASURES.values()
        if measure.of_structure is None and measure.name.casefold() not in COLUMNS
    ]


def _row(record: Record, chord: float | None = None) -> dict[str, Any]:
    """Return the row of a record; chord: `floor_chord` of a floor."""
    from ..motions.intensity import intensity

    measured = intensity(record)
    row = {
        key: getattr(record, key)
        for key in ("name", "format", "component", "npts", "dt", "duration")
    } | asdict(measured)
    difference = (
        None if not record.header_pga else measured.pga / record.header_pga - 1.0
    )
    return row | {
        "header_pga": record.header_pga,
        "header_difference": difference,
        "unit": record.unit,
        **({} if chord is None else {"floor_chord": chord}),
        **{one.name: one.value_of_record(record) for one in _further_measures()},
    }

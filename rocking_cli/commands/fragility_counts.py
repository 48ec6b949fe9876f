"""`rocking fragility --counts`: the fit of numbers that exist already."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from . import options
from .command import given, refuse
from .fragility_options import FragilityOptions
from .fragility_rows import emit_fits
from .printing import note

if TYPE_CHECKING:
    from ..fragility.counts import Counts
    from ..fragility.hazard import HazardCurve

_WITH_COUNTS = (
    "counts",
    "im",
    "limits",
    "curve",
    "samples",
    "seed",
    "workers",
    "hazard",
    "site",
    "standing",
    "export",
    "output",
    "overwrite",
)


def fit_the_counts(wanted: FragilityOptions, overwrite: bool) -> None:
    """Fit the counts of --counts, and print the fit, with the annual rate of --hazard
    and the file of --export.
    """
    from ..fragility.bootstrap import Resampling
    from ..fragility.counts import fit_counts
    from ..fragility.fitted_curve import word_of

    _refuse_others()
    limit = word_of(wanted.limit_of_counts()) if given("limits") else "counted"
    _refuse_contradictions(wanted, limit)
    counts, hazard = _read(wanted, overwrite)

    how = Resampling(wanted.samples, wanted.seed)
    fit = fit_counts(counts, how, hazard=hazard, limit=limit)
    remarks = [f"{counts.source}: {counts.remark}"] if counts.remark else []
    if counts.measure is not None and wanted.export and wanted.output is not None:
        from ..fragility.exports import write

        remarks += write([fit], wanted.output, wanted.export, counts.measure, overwrite)

    emit_fits([fit], [], wanted, counts.unit)
    if hazard is not None and fit.rate is not None:
        remarks += [f"{fit.structure}: {line}" for line in fit.rate.remarks(hazard)]
    note(*remarks)


def _refuse_others() -> None:
    """Raise click.UsageError for an option that has no effect on given counts."""
    every = click.get_current_context().params.keys()
    refuse("does not go with --counts", *(every - set(_WITH_COUNTS)))


def _refuse_contradictions(wanted: FragilityOptions, limit: str) -> None:
    """Raise click.UsageError for options that need others; limit: the limit state."""
    if wanted.hazard is None:
        refuse("goes with --hazard", "site", "standing")
    else:
        wanted.check_standing(limit == "overturning")
    if (wanted.export is None) != (wanted.output is None):
        raise click.UsageError(
            "--export goes with -o FILE, and with --counts -o FILE goes with --export"
        )


def _read(
    wanted: FragilityOptions, overwrite: bool
) -> tuple[Counts, HazardCurve | None]:
    """Return (the counts, the hazard curve of the same measure), and refuse a file of
    --export that cannot be written.
    """
    from ..fragility.counts import read_counts
    from ..fragility.hazard_files import read_hazard

    counts = read_counts(
        str(wanted.counts),
        wanted.im if given("im") else None,
        needs_measure=wanted.hazard is not None or wanted.export is not None,
    )
    if counts.measure is None:
        return counts, None
    if wanted.export is not None and wanted.output is not None:
        from ..fragility.exports import check_export

        check_export(wanted.output, wanted.export, counts.measure, overwrite)
        options.refuse_own_input(wanted.output)
    if wanted.hazard is None:
        return counts, None
    return counts, read_hazard(wanted.hazard, counts.measure.name, wanted.site)

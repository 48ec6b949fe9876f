"""The summary at the end of a sweep, in sentences."""

from collections.abc import Iterator

from ..dynamics.method import LINEAR
from ..dynamics.outcome import Difference, Outcome
from ..errors import counted
from ..spectra.results import Summary


def summary_lines(summary: Summary, output: str) -> Iterator[str]:
    """Yield the sentences that decide: size, outcomes, run time and errors, and what is
    not to be relied upon.
    """
    s = summary
    records = f" under {counted(s.records, 'record')}" if s.records else ""
    outcomes = ", ".join(f"{n} {flag}" for flag, n in s.outcomes.items() if n)
    yield (
        f"{output}: {counted(s.cells, 'cell')},"
        f" {counted(s.structures, 'structure')}{records}: {outcomes}"
    )
    yield (
        f"run time: {s.run_time:.3g} s, {1e6 * s.time_per_cell:.3g} us a cell,"
        f" {counted(s.workers, 'worker')}"
    )
    yield from _error_lines(s)
    if s.records and s.model == LINEAR.model:
        yield "the linear equation is not safe under records; `model` nonlinear decides"
    if s.machine_differences:
        yield (
            f"computed on machines that differ: {s.machine_differences}; the last"
            " digits of cells may differ from those of one machine"
        )
    if s.misjudged or s.beyond_tolerance:
        cells = f"{s.misjudged + s.beyond_tolerance} of these cells"
        yield (
            f"warning: the two paths differ by more than the error bound at {cells}; do"
            " not rely on this sweep"
        )
    yield from _equation_lines(s)


def summary_details(summary: Summary) -> Iterator[str]:
    """Yield the other sentences: what was not marched, and why."""
    s, w = summary, summary.work
    if s.resumed_cells:
        yield (
            f"resumed: {s.resumed_cells} cells were there before; times, checks and"
            " skipped work are those of this run"
        )
    if s.weighed or s.outcomes[Outcome.LOST_CONTACT.flag]:
        yield (
            "lost contact: g + z_g'' <= 0, or Fz <= 0 under a rigid body that rocks;"
            " the Fz of other mechanisms is not computed"
        )
    yield (
        f"skipped: {w.no_uplift} cells below uplift, {w.free_phase} free motions after"
        f" the shaking, {w.certain_overturning} certain overturnings, {w.rests_skipped}"
        f" rests, the last part of {w.sequences_closed} sequences of impacts,"
        f" {s.shared_cells} cells shared between structures"
    )


def _error_lines(s: Summary) -> Iterator[str]:
    """Yield the sentences on the bound of the error, and on the cells that were
    computed again.
    """
    yield (
        f"error bound: {s.error_bound:.1e} in theta/alpha, median"
        f" {s.error_bound_median:.1e}, {counted(s.cells_above_ten_medians, 'cell')}"
        " above ten times the median"
    )
    if not s.checked_cells:
        yield "largest difference: not checked"
        return
    agree = (
        "every outcome equal" if not s.misjudged else f"{s.misjudged} OUTCOMES DIFFER"
    )
    sensitive = (
        f" ({s.sensitive_cells} for their sensitivity)" if s.sensitive_cells else ""
    )
    many = (
        f"{counted(s.checked_cells, 'cell')}{sensitive} computed again by"
        f" {s.checked_by}"
    )
    yield (
        f"largest difference: {s.largest_difference:.1e} in theta/alpha at {many} in"
        f" {s.check_time:.2g} s, {agree}"
    )


def _equation_lines(s: Summary) -> Iterator[str]:
    """Yield the sentences that compare the linear equation with the nonlinear one."""
    if s.compared:
        yield (
            f"{s.differing} of {s.compared} checked cells have another outcome by the"
            " nonlinear equation"
        )
    if s.validity is not None:
        sampled = (
            f"{s.validity.differ} of {s.validity.sampled} sampled cells differ,"
            f" {s.validity.unsafe} unsafe"
        )
        more = "; `model` both compares every cell" if s.validity.differ else ""
        yield f"nonlinear: {sampled}{more}"
    if s.differences:
        unsafe, alarms = (
            s.differences[d.flag]
            for d in (Difference.LINEAR_UNSAFE, Difference.LINEAR_FALSE_ALARM)
        )
        fell = sum(n for flag, n in s.outcomes.items() if Outcome[flag.upper()].falls)
        yield (
            f"the linear equation is unsafe in {unsafe} of the {fell} cells that"
            f" overturn or lose contact, and falls in {alarms} that stand"
        )

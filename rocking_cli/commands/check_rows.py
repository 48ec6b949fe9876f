"""The rows of `rocking check`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ..reports.tables import Above
from .printing import chosen_columns, form

if TYPE_CHECKING:
    from ..responses.verdict import Verdict
    from .check import CheckOptions
    from .check_demands import Demands


# columns that a table shows, of those that a call has asked for
ASKED = (
    *("worst_f_g", "largest_f_g", "azimuth", "largest_azimuth"),
    *("slide_max", "tie_state", "floor_pga", "share_falls"),
    *("code_linear_ratio", "code_slv_ratio", "code_slc_ratio"),
)


def known_columns(
    demands: Demands, wanted: CheckOptions, by_code: bool, drawn: bool
) -> list[str]:
    """Return the columns that the rows of a call may have, labels apart."""
    from ..responses.verdict import CHECK_COLUMNS, FLOOR_COLUMNS

    varied = [key.partition(" [")[0] for row in demands.varied.values() for key in row]
    found = [
        *varied,
        *CHECK_COLUMNS,
        *later_columns(demands, wanted.limit is not None),
    ]
    found += ("lost_in_fall", *FLOOR_COLUMNS)
    if demands.azimuths is not None:
        found += ("azimuth", "largest_azimuth")
    if demands.up_to is not None:
        found += ("worst_f_g", "worst_f_g_end", "largest_f_g")
    if by_code:
        from ..responses.code_check import CODE_COLUMNS

        found += CODE_COLUMNS
    if drawn:
        from ..responses.uncertainty import drawn_columns

        found += drawn_columns(wanted.limit is not None)
    return found


def unseen_columns(known: Iterable[str], varied: Iterable[str]) -> list[str]:
    """Return the columns that a table shows only if --columns names them: of what a
    call knows, those that decide nothing.
    """
    from ..responses.verdict import DECISIVE

    shown = {*DECISIVE, *ASKED, *varied}
    return [name for name in known if name not in shown]


def row_of(
    verdict: Verdict, more: dict[str, Any], later: tuple[str, ...]
) -> dict[str, Any]:
    """Return the row of a verdict; more: the columns of --code and --draws; later: as
    `later_columns` returns them.
    """
    row = verdict.row() | more
    if form() is None and (limit := verdict.capacity_above) is not None:
        row["capacity_demand"] = Above(limit)
    if form() is None and not chosen_columns() and verdict.outcome.overturned:
        row["outcome"] = "overturned"
    if form() == "csv":  # its header is that of the first row
        row |= {key: row.get(key) for key in later}
    return row


def later_columns(demands: Demands, searched: bool) -> tuple[str, ...]:
    """The columns that a later row may have and the first one lacks."""
    from ..envelopes.capacity import falls_may_be_narrow
    from ..responses.verdict import SLIDE_COLUMNS, TIED_COLUMNS
    from ..structures.friction import sliders

    tied = any(s.restraints for s in demands.structures)
    linked = any(s.mechanism is not None for s in demands.structures)
    narrow = searched and any(
        falls_may_be_narrow(motion) for motion, _ in demands.shakes
    )
    slid = bool(sliders(demands.structures))
    other = ("opens",) * linked + ("falls_nearby",) * narrow
    return SLIDE_COLUMNS * slid + TIED_COLUMNS * tied + other

"""The rows of `rocking check`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..reports.tables import Above
from .printing import form

if TYPE_CHECKING:
    from ..responses.verdict import Verdict
    from .check_demands import Demands


# columns that a table shows only if --columns names them
UNSEEN = ("searched_to", "omega_g")


def row_of(
    verdict: Verdict, demands: Demands, more: dict[str, Any], searched: bool
) -> dict[str, Any]:
    """Return the row of a verdict; more: the columns of --code and --draws."""
    row = verdict.row() | more
    if form() is None and (limit := verdict.capacity_above) is not None:
        row["capacity_demand"] = Above(limit)
    if form() == "csv":  # its header is that of the first row
        row |= {key: row.get(key) for key in _later_columns(demands, searched)}
    return row


def _later_columns(demands: Demands, searched: bool) -> tuple[str, ...]:
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

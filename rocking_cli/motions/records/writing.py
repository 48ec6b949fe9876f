"""Records as text."""

from .record import Record
from .units import ACCELERATIONS

_COLUMNS = 5  # values on a line


def at2_text(record: Record) -> str:
    """Return a record as PEER AT2, in g, with all digits of its samples."""
    name = record.label.encode("ascii", "replace").decode()
    lines = [
        "PEER AT2 FORMAT",
        name,
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {record.npts}, DT= {record.dt!r} SEC",
    ]
    values = [f"{x: .16E}" for x in (record.acceleration / ACCELERATIONS["g"]).tolist()]
    rows = range(0, len(values), _COLUMNS)
    lines += [" ".join(values[i : i + _COLUMNS]) for i in rows]
    return "\n".join(lines) + "\n"

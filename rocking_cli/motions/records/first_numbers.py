"""Numbers above the samples of a plain file: their count, step or rate."""

import numpy as np

from ...errors import counted
from .claims import Claims, agree
from .printed_numbers import finite_number
from .rows import NumberRows, as_printed, rows_above_samples
from .text import RecordText
from .titles import Title, numbers_in, unmarked


def without_first_numbers(
    text: RecordText, claims: Claims, rows: NumberRows, above: list[Title]
) -> tuple[NumberRows, str]:
    """(the rows below those that hold a count, step or rate, a remark that names
    these).

    Raises DocumentError for a first number that may be one and that nothing confirms.
    """
    count = rows_above_samples(rows)
    kept = rows.below(count)
    words = [
        (x, title.line) for title in above for x in numbers_in(unmarked(title.text))
    ]
    first = int(rows.counts[:count].sum())
    if first > len(rows.words):
        raise text.fault(
            f"found {first} numbers on {counted(count, 'line')} above lines of"
            f" {rows.columns}; expected the number of values, the time step or the"
            " rate",
            int(rows.lines[0]),
        )
    lines = np.repeat(rows.lines[:count], rows.counts[:count])
    words += [
        (as_printed(x), int(n)) for x, n in zip(rows.words[:first], lines, strict=True)
    ]
    total = {kept.values.size, kept.counts.size}
    stated = claims.step if claims.step is not None else text.given.dt
    if stated is None and kept.columns > 1 and kept.counts.size > 2:
        times = kept.values[:: kept.columns]
        stated = float(np.median(np.diff(times[: kept.counts.size])))
    said: list[str] = []
    for word, line in words:
        value = finite_number(word.replace(",", ".").encode()) or 0.0
        if value in total and value > 1.0:
            claims.count = claims.count or int(value)
            claims.quoted.setdefault("count", word)
            said.append(f"{word}, the number of values")
        elif stated and agree(value, stated):
            said.append(f"{word}, the time step")
        elif stated and value and agree(1.0 / value, stated):
            said.append(f"{word}, the sampling rate")
        else:
            raise text.fault(_may_be(word, value, kept), line)
    return kept, f"above the samples stand {' and '.join(said)}" if said else ""


def _may_be(word: str, value: float, rows: NumberRows) -> str:
    """Return the sentence that refuses a number above the others: what it may be, and
    what the user can state.
    """
    below = f"{rows.values.size} values below it"
    if value >= 1.0:
        what = (
            f"the sampling rate in Hz (`dt` {1.0 / value:.6g}) or the number of values"
        )
    else:
        what = f"the time step in s (`dt` {value:g})"
    return (
        f"found {word} above the others; it may be {what}, or a sample ({below}): "
        "state the step as `dt`, or take the line away or print it like the others"
    )

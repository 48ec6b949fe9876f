"""Columns of times: whether they rise evenly, and by which step."""

import numpy as np

from ...arrays import Array
from .text import RecordText


def is_even(values: Array) -> bool:
    """True if values rise by equal steps, as times do."""
    steps = np.diff(values)
    return bool(steps.size and (steps > 0.0).all() and np.ptp(steps) < 0.01 * steps[0])


def even_step(
    time: Array,
    text: RecordText,
    line: int,
    in_a_line: int = 1,
    lines: Array | None = None,
) -> float:
    """Return the step of times that rise evenly. Raises DocumentError if they do not.

    line: the line of the first time; lines: that of each, or None for lines that follow
    each other with so many times each.
    """
    if time.size < 2:
        raise text.fault(f"found {time.size} values; expected at least two", line)
    step = float(f"{(time[-1] - time[0]) / (time.size - 1):.10g}")
    off = np.abs(time - (time[0] + step * np.arange(time.size))) > 0.1 * abs(step)
    rising = np.diff(time)
    if off.any() or not step > 0.0 or np.any(rising <= 0.0):
        usual = float(np.median(rising))
        apart = np.abs(rising - usual) > 0.5 * abs(usual)  # from one time to the next
        bad = int(np.argmax(apart)) + 1 if apart.any() else int(np.argmax(off))
        place = line + bad // in_a_line if lines is None else int(lines[bad])
        before = f" after {time[bad - 1]:g} s" if bad else ""
        raise text.fault(
            f"times that do not rise in even steps, such as {time[bad]:g} s{before}",
            place,
        )
    return step

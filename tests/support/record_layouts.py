"""Numbers of our own in the layouts of record files, for the tests of their readers."""

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rocking_cli.errors import DocumentError
from rocking_cli.motions.records import Record, read_records
from rocking_cli.motions.records.record import accepted


def wave(count: int, peak: float = 1.0) -> np.ndarray:
    """A swelling and fading sum of sines whose largest absolute value, `peak`, is taken
    once.
    """
    t = np.arange(count) / count
    raw = np.sin(math.pi * t) ** 2 * (np.sin(37.0 * t) + 0.6 * np.sin(91.0 * t + 0.4))
    return peak * raw / np.abs(raw).max()


def rows(values: Iterable[float], per_line: int, form: str) -> str:
    """Numbers printed by a format such as {:10.6f}, so many on a line,
    each line ended.
    """
    printed = [form.format(x) for x in values]
    return "".join(
        "".join(printed[i : i + per_line]) + "\n"
        for i in range(0, len(printed), per_line)
    )


def as_printed(values: Sequence[float] | np.ndarray, form: str) -> np.ndarray:
    """The numbers that a reader can find again after printing."""
    return np.array([float(form.format(x)) for x in values])


def plain_record(samples: Sequence[float] | np.ndarray, dt: float) -> Record:
    """Samples [m/s2] as the record `r`, of component N."""
    return Record(
        "r", "text", "N", dt, np.array(samples, dtype=float), None, "m/s2", "r", ""
    )


def at2(samples: Sequence[float] | np.ndarray, dt: float = 0.01) -> str:
    """A file of PEER's layout, whose name states no component; samples in g."""
    head = (
        f"OF OUR OWN\n\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= {len(samples)},"
        f" DT= {dt} SEC\n"
    )
    return head + rows(samples, 5, "{:15.7E}")


def of_a_station(*columns: np.ndarray, dt: float = 0.02) -> str:
    """A file of AFAD's layout with the components N-S, E-W and U-D [gal]."""
    keys = f"NUMBER OF DATA: {len(columns[0])}\nSAMPLING INTERVAL (SEC): {dt}\n"
    lines = "".join(
        rows(values, 3, "{:12.5f}") for values in zip(*columns, strict=True)
    )
    return f"STRONG GROUND MOTION RECORDS OF TURKIYE\n{keys}N-S E-W U-D\n{lines}"


def with_a_line_missing_or_twice(text: str) -> Iterator[tuple[int, str]]:
    """The number of a line of numbers, from 1, and the text without it or with it
    twice; of every such line.
    """
    lines = text.splitlines(keepends=True)
    for i, line in enumerate(lines):
        if line.strip() and not set(line.strip()) - set(" 0123456789.-+eE*"):
            yield i + 1, "".join(lines[:i] + lines[i + 1 :])
            yield i + 1, "".join(lines[: i + 1] + lines[i:])


def refusal(path: Path, text: str | None = None, **given: Any) -> str:
    """The line in which a file is refused, with this text where one is given; given: as
    `read_records` takes it.
    """
    if text is not None:
        path.write_text(text)
    with pytest.raises(DocumentError) as error:
        accepted(read_records(path, **given))
    assert "\n" not in str(error.value)
    return str(error.value)

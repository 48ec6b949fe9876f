"""Families of structures: their parameters over the varied values (Figs. 4 and 6)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import UsageError
from ..rows import Rows, column, groups
from ..units import HEADING, Units
from .canvas import legend, look
from .labels import label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOVED = 0.02  # rad; a hinge that moves less between two members is still the same hinge
_LEAP = 4.0  # times the median step
_X = "over"  # a column for the abscissa


def family(figure: Figure, rows: Rows, units: Units, over: str | None = None) -> list[Axes]:
    """Draw p, alpha, eta, lambda (and a_scale) over the first varied key, or over `KEY/KEY`; one line for each value of the others.

    Lines have a gap where the hinges change their places, and where members have no solution. Raises UsageError.
    """
    head = list(rows[0])
    varied = head[: head.index("name")] if "name" in head else []
    if not varied:
        raise UsageError("a family is drawn over the keys that were varied; this CSV holds no column of one")
    x, xlabel, others = _abscissa(rows, varied, over)
    for row, value in zip(rows, x, strict=True):
        row[_X] = repr(float(value))
    keys = ["p", "alpha", "eta", "lambda", *(["a_scale"] if np.any(column(rows, "a_scale") != 1.0) else [])]
    figure.set_size_inches(10.5 if len(keys) > 4 else 7.2, 5.2)
    panels = list(figure.subplots(2, (len(keys) + 1) // 2, sharex=True).ravel())
    for one, key in zip(panels, keys, strict=False):
        for i, (group, some) in enumerate(groups(rows, *others).items()):
            text = ", ".join(_valued(k, v) for k, v in zip(others, group, strict=True)) or "_"
            one.plot(*_broken(some, column(some, key) / units.column(key)[2]), label=text, **look(i))
        one.set_ylabel(label(key, units))
    for one in panels[len(keys) // 2 : len(keys)]:
        one.set_xlabel(xlabel)
        one.tick_params(labelbottom=True)
    if len(keys) < len(panels):
        handles, texts = panels[0].get_legend_handles_labels()
        if handles:
            panels[-1].legend(handles, texts, loc="center")
        panels[-1].axis("off")
    else:
        legend(panels[0])
    return panels[: len(keys)]


def _abscissa(rows: Rows, varied: list[str], over: str | None) -> tuple[np.ndarray, str, list[str]]:
    """(values, label, other columns) of the abscissa; the other columns are constant along a line. Raises UsageError."""
    names = {_key(heading): heading for heading in varied}
    if over is None:
        return column(rows, varied[0]), varied[0].replace("_", " "), varied[1:]
    keys = over.split("/")
    if len(keys) > 2 or any(key not in names for key in keys):
        raise UsageError(f"`over`: found {over!r}; expected {', '.join(names)}, or one over another, such as KEY/KEY")
    values = [column(rows, names[key]) for key in keys]
    if len(keys) == 1:
        return values[0], names[over].replace("_", " "), [heading for heading in varied if heading != names[over]]
    units = [(HEADING.fullmatch(names[key]) or {"unit": ""})["unit"] for key in keys]
    if units[0] != units[1]:
        raise UsageError(f"`over`: {keys[0]} is in {units[0]} and {keys[1]} in {units[1]}; expected one unit for both")
    return values[0] / values[1], f"{over.replace('_', ' ').replace('/', ' / ')} [-]", [names[keys[1]]] + [
        heading for heading in varied if heading not in (names[keys[0]], names[keys[1]])
    ]  # fmt: skip


def _broken(some: Rows, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(x, y) of a line, with NaN where the mechanism changes or a member is missing."""
    x = column(some, _X)
    order = np.argsort(x)
    x, y = x[order], y[order]
    gaps = np.zeros(max(0, x.size - 1), dtype=bool)
    hinges = [key for key in some[0] if key.startswith("hinges_") and key.endswith("_angle")]
    if hinges and x.size > 1:
        steps = np.max(np.abs(np.diff(np.array([column(some, key)[order] for key in hinges]), axis=1)), axis=0)
        gaps |= (steps > _MOVED) & (steps > _LEAP * np.nanmedian(steps))
    if x.size > 2:
        widths = np.diff(x)
        gaps |= widths > 1.5 * np.median(widths)
    at = np.flatnonzero(gaps) + 1
    return np.insert(x, at, np.nan), np.insert(y, at, np.nan)


def _key(heading: str) -> str:
    return heading.partition(" [")[0]


def _valued(heading: str, value: str) -> str:
    """A column heading and a value as text: `height = 8 m` from `height [m]` and 8."""
    key, _, unit = heading.partition(" [")
    return f"{key.replace('_', ' ')} = {float(value):.4g} {unit.removesuffix(']')}".rstrip()

"""Recorded ground motions: acceleration, velocity and displacement in time, and elastic
response spectra.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..rows import Rows, column, groups
from ..units import Units
from .canvas import (
    PLAIN,
    Axes,
    Figure,
    column_in,
    label,
    legend,
    line_style,
    literal,
    series,
)

if TYPE_CHECKING:
    from ...motions.records.record import Record


def traces(
    figure: Figure,
    records: Sequence["Record"],
    units: Units,
    alone: Axes | None = None,
) -> list[Axes]:
    """Draw acceleration, velocity and displacement of records over time, a colour for
    each component. The ground begins at rest. alone: Axes for the acceleration only.
    """
    if alone is None:
        figure.set_size_inches(6.4, 5.0)
        axes = list(figure.subplots(3, 1, sharex=True))
    else:
        axes = [alone]
    for i, record in enumerate(records):
        t = record.dt * np.arange(record.npts)
        for one, key, course in zip(axes, _COURSES, _courses(record), strict=False):
            y = course / units.of(key)[1]
            style = {**line_style(i), "ls": "-", "lw": 0.8}
            one.plot(t, y, label=literal(record.label), **style)
    for one, (key, name) in zip(axes, _COURSES.items(), strict=False):
        unit = units.of(key)[0]
        one.set_ylabel(f"{name}\n[{PLAIN.get(unit, unit)}]")
    axes[-1].set_xlabel(label("t", units))
    if alone is None:
        words = "integrated as it is, without baseline correction"
        axes[-1].set_title(words, fontsize="x-small", loc="right")
    if len(records) == 1:
        peak = float(np.max(np.abs(records[0].acceleration)))
        unit, factor = units.of("acceleration")
        words = f"{records[0].label}, PGA {peak / factor:.3g} {PLAIN.get(unit, unit)}"
        axes[0].set_title(literal(words))
    legend(axes[0])
    return axes


def _courses(record: "Record") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return acceleration, velocity and displacement of a record, (npts,) each."""
    from scipy.integrate import cumulative_trapezoid

    acceleration = np.asarray(record.acceleration)
    velocity = cumulative_trapezoid(acceleration, dx=record.dt, initial=0.0)
    displacement = cumulative_trapezoid(velocity, dx=record.dt, initial=0.0)
    return acceleration, velocity, displacement


_COURSES = {
    "acceleration": "acceleration",
    "velocity": "velocity",
    "length": "displacement",
}  # dimension and name of the panels


def elastic_spectra(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw S_a and S_d over the period, a line for each component."""
    figure.set_size_inches(8.4, 3.6)
    axes = list(figure.subplots(1, 2))
    for some, style in series(rows, "name", "component", "damping"):
        style["label"] = literal(_named(some))
        for one, key in zip(axes, ("S_a", "S_d"), strict=True):
            one.plot(column(some, "T"), column_in(some, key, units), **style)
    for one, key in zip(axes, ("S_a", "S_d"), strict=True):
        unit = units.column(key)[1]
        one.set(
            xlabel="period $T$ [s]",
            ylabel=f"$S_{key[-1]}$ [{PLAIN.get(unit, unit)}]",
        )
        one.set_xlim(left=0.0)
        one.set_ylim(bottom=0.0)
    damping = {100.0 * float(text[0]) for text in groups(rows, "damping")}
    name = f"{_named(rows)}, " if len(groups(rows, "name", "component")) == 1 else ""
    shown = ", ".join(f"{x:g} %" for x in sorted(damping))
    figure.suptitle(literal(f"{name}elastic spectrum, damping {shown}"), fontsize=9)
    legend(axes[0])
    return axes


def _named(rows: Rows) -> str:
    """Return the name and the component of the first row."""
    return " ".join(filter(None, (rows[0]["name"], rows[0]["component"])))

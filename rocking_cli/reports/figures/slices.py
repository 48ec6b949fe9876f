"""Rocking spectra: theta_max/alpha along one axis of a spectra file (Fig. 2 right), and
its quantiles over a set of records.

In a quantile a cell that overturns or loses contact counts as infinite, so a line ends
where its quantile is infinite. The quantiles are observed values, without
interpolation.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...dynamics.method import LINEAR
from ...dynamics.outcome import Outcome, falls
from ...errors import UsageError
from ...motions.grid import parse_axes
from ...spectra.file.reader import SpectraFile
from ..units import Units
from .canvas import (
    PANEL,
    SYMBOLS,
    Axes,
    Figure,
    label,
    legend,
    line_style,
    literal,
    motion_in_words,
    titled,
    valued,
)

SHARES = (0.16, 0.5, 0.84)


@dataclass(frozen=True)
class Slice:
    """A line of cells at one place of the other axis."""

    where: str  # name of the other axis
    coordinate: float  # on the other axis [SI]
    along: str  # name of the axis of the line
    x: np.ndarray  # values of the axis of the line [SI], (n,)
    names: tuple[str, ...]  # names of the structures or records
    # theta_max/alpha of each structure or record [-], (n,)
    theta: tuple[np.ndarray, ...]
    outcome: tuple[np.ndarray, ...]  # codes of each structure or record, (n,)
    title: str  # text above the figure
    # restitution of each structure if Eq. 2.7 holds: plain bodies under one cycle of a
    # sine by the linear equation, over A
    etas: tuple[float, ...] = ()


def slice_of(file: SpectraFile, cut: str) -> Slice:
    """Return the slice of the cells nearest to `NAME=VALUE`; NAME is an axis of the
    file, or f_g, T_g or p. Raises UsageError.
    """
    rows, columns = list(file.frame.dimensions.items())[1:]
    where, at = _nearest(file, cut)
    along, x = columns if where == rows[0] else rows
    if isinstance(x, list):
        raise UsageError(
            f"`slice`: found {cut!r}; expected an axis in a file whose other axis has"
            " numbers"
        )
    line = slice(at, at + 1)
    cells = (line, slice(None)) if where == rows[0] else (slice(None), line)
    names = _names(file)
    blocks = [file.block(i, *cells) for i in range(len(names))]
    motion = (
        ""
        if file.frame.of_records
        else f"{literal(motion_in_words(file.scene['motion'][0]))}, "
    )
    return Slice(
        where,
        float(np.asarray(file.frame.dimensions[where])[at]),
        along,
        np.asarray(x),
        names,
        tuple(block["theta_ratio"].ravel() for block in blocks),
        tuple(block["outcome"].ravel() for block in blocks),
        f"{motion}{file.scene['model']} equation",
        _etas(file) if along == "A" else (),
    )


def _nearest(file: SpectraFile, cut: str) -> tuple[str, int]:
    """Return (name of the axis, index of the value nearest to the cut). Raises
    UsageError for a value outside of the axis.
    """
    axes = {
        name: np.asarray(values)
        for name, values in list(file.frame.dimensions.items())[1:]
        if not isinstance(values, list)
    }
    try:
        cuts = parse_axes(cut, records=file.frame.of_records)
    except UsageError:
        cuts = {}
    for name, axis in cuts.items() if len(cuts) == 1 else ():
        if name in axes and len(axis.values) == 1:
            asked, values = axis.values[0], axes[name]
            # the rounding of a printed end
            if values[0] * (1.0 - 1e-5) <= asked <= values[-1] * (1.0 + 1e-5):
                return name, int(np.abs(values - asked).argmin())
    wanted = " or ".join(_accepted(name, values) for name, values in axes.items())
    raise UsageError(f"`slice`: found {cut!r}; expected {wanted}")


def _names(file: SpectraFile) -> tuple[str, ...]:
    """Return the name of each structure or record."""
    first, places = next(iter(file.frame.dimensions.items()))
    if first == "structure":
        return tuple(titled(s) for s in file.structures)
    return tuple(literal(str(record)) for record in places)


def _etas(file: SpectraFile) -> tuple[float, ...]:
    """Return the restitutions if Eq. 2.7 holds for the file, else nothing."""
    from ...motions import sine

    known = (
        file.scene["model"] == LINEAR.model
        and "vertical" not in file.scene
        and all(s.plain for s in file.structures)
    )
    return (
        tuple(s.eta for s in file.structures)
        if known and file.motion().pieces == sine().pieces
        else ()
    )


def _accepted(name: str, values: np.ndarray) -> str:
    """Return the values that a cut along an axis may have, in words."""
    text = f"{name}={values[0]:.6g} to {values[-1]:.6g}"
    if name == "omega_g":
        low, high = values[[0, -1]] / (2.0 * math.pi)
        text += (
            f" (f_g={low:.6g} to {high:.6g}, T_g={1.0 / high:.6g} to {1.0 / low:.6g})"
        )
    return text


def of_record(file: SpectraFile, place: int) -> Slice:
    """Return the responses of the structures to one record as a slice of a file over
    record, structure and amplitude.
    """
    (_, records), (_, structures), (along, x) = file.frame.dimensions.items()
    block = file.block(place, slice(None))
    title = f"{literal(str(records[place]))}, {file.scene['model']} equation"
    names = tuple(literal(str(s)) for s in structures)
    return Slice(
        "record",
        float(place),
        along,
        np.asarray(x),
        names,
        tuple(block["theta_ratio"]),
        tuple(block["outcome"]),
        title,
    )


def plane(
    file: SpectraFile, place: int
) -> tuple[tuple[str, np.ndarray], tuple[str, np.ndarray], dict[str, np.ndarray]]:
    """Return ((name, values) across, (name, values) upwards, arrays of cells) of a
    structure or record.
    """
    both = [
        (name, np.asarray(values))
        for name, values in list(file.frame.dimensions.items())[1:]
    ]
    block = file.block(place, slice(None))
    if file.frame.of_records:  # T and alpha
        return both[1], both[0], block
    return both[0], both[1], {name: cells.T for name, cells in block.items()}


def spectrum_lines(axes: Axes, found: Slice, units: Units) -> None:
    """Draw a line for each structure or record, and bars where it falls. Raises
    UsageError without a computed cell.
    """
    if not any(np.any(outcome != Outcome.NOT_COMPUTED) for outcome in found.outcome):
        raise UsageError("holds no computed cell on this line, nothing to draw")
    x = found.x / units.column(found.along)[2]
    for i, (name, theta, outcome) in enumerate(
        zip(found.names, found.theta, found.outcome, strict=True)
    ):
        style: dict[str, Any] = line_style(i)
        axes.plot(x, theta, label=name, marker="." if x.size == 1 else None, **style)
        if found.etas:
            from ...envelopes.closed_form import peak_after_impact

            peaks = [
                (
                    peak_after_impact(a, found.coordinate, found.etas[i])
                    if a >= 1.0
                    else math.nan
                )
                for a in found.x.tolist()
            ]
            axes.plot(
                x,
                peaks,
                color=style["color"],
                lw=0.8,
                ls=(0, (1, 1)),
                label="Eq. 2.7, after the first impact" if i == 0 else None,
            )
        if bars := _spans(x, falls(outcome)):
            axes.broken_barh(
                bars,
                (1.01 + 0.02 * i, 0.014),
                transform=axes.get_xaxis_transform(),
                color=style["color"],
                clip_on=False,
            )
    raised = 6.0 + 4.5 * len(found.names)
    where = (
        ""
        if found.where == "record"
        else f", {valued(found.where, found.coordinate, units)}"
    )
    lost = any(np.any(o == Outcome.LOST_CONTACT) for o in found.outcome)
    bars_are = f"overturned{' or lost contact' if lost else ''}"
    axes.set_title(
        f"{found.title}{where}\nbars: {bars_are}",
        pad=raised if any(falls(o).any() for o in found.outcome) else 6.0,
    )
    axes.set(xlabel=label(found.along, units), ylabel=label("theta_max_ratio", units))
    if len(found.names) == 1:
        axes.set_title(f"{found.names[0]}\n{axes.get_title()}", pad=raised)
    legend(axes)


def _spans(x: np.ndarray, where: np.ndarray) -> list[tuple[float, float]]:
    """Return (start, width) of the intervals in which `where` is true, which end
    halfway to the next point outside.
    """
    edges = np.concatenate([x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]])
    steps = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    return [
        (float(edges[a]), float(edges[b] - edges[a]))
        for a, b in zip(steps[::2], steps[1::2], strict=True)
    ]


def record_quantiles(file: SpectraFile) -> np.ndarray:
    """Return the quantiles SHARES of theta_max/alpha over the records, (shares, alpha,
    T); inf if too many overturn, NaN without cells.
    """
    theta = file.array("theta_ratio")
    theta[falls(file.array("outcome"))] = np.inf
    # NaN (failed or not computed) is sorted to the end
    ordered = np.sort(theta, axis=0)
    known = (~np.isnan(theta)).sum(axis=0)
    rank = [
        np.clip(np.ceil(share * known).astype(int) - 1, 0, None) for share in SHARES
    ]
    return np.stack([np.take_along_axis(ordered, r[None], axis=0)[0] for r in rank])


def record_spectra(figure: Figure, file: SpectraFile, units: Units) -> list[Axes]:
    """Draw the quantiles over T for each alpha, and contours of the median over tan
    alpha and p if there are several of both.
    """
    alpha, period = (np.asarray(file.frame.dimensions[name]) for name in ("alpha", "T"))
    found = record_quantiles(file)
    finite = np.where(np.isfinite(found), found, np.nan)
    contours = alpha.size > 1 and period.size > 1
    count = file.frame.shape[0]
    if contours:
        figure.set_size_inches(2.0 * PANEL[0], PANEL[1])
    first, *others = figure.subplots(1, 2 if contours else 1, squeeze=False)[0]
    for i, a in enumerate(alpha):
        first.plot(
            period,
            finite[1, i],
            label=valued("alpha", float(a), units),
            **line_style(i),
        )
        if count > 1:  # an infinite upper quantile is drawn at the top
            low = finite[0, i]
            high = np.where(
                np.isinf(found[2, i]),
                max(1.0, float(np.nanmax(finite, initial=0.0))),
                finite[2, i],
            )
            first.fill_between(
                period, low, high, color=line_style(i)["color"], alpha=0.15, lw=0.0
            )
    many = (
        f"median and 16 to 84 % of {count} records"
        if count > 1
        else literal(str(file.frame.dimensions["record"][0]))
    )
    first.set(
        xlabel=label("T", units),
        ylabel=label("theta_max_ratio", units),
        title=f"{many}, {file.scene['model']} equation",
    )
    first.set_ylim(bottom=0.0)
    legend(first)
    for axes in others:
        _contours(axes, alpha, period, found[1])
    return [first, *others]


def _contours(
    axes: Axes, alpha: np.ndarray, period: np.ndarray, median: np.ndarray
) -> None:
    """Draw the median over tan alpha and p; grey where half of the records overturn."""
    x, y = np.tan(alpha), 2.0 * np.pi / period[::-1]
    axes.set_facecolor("0.8")
    levels = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
    drawn = axes.contourf(
        x,
        y,
        np.ma.masked_invalid(median[:, ::-1].T),
        levels=levels,
        extend="max",
        cmap="viridis",
    )
    axes.figure.colorbar(
        drawn,
        ax=axes,
        label=f"median of {SYMBOLS['theta_max_ratio']}; grey: half of them fall",
    )
    axes.set(xlabel=r"$\tan\alpha$ [-]", ylabel="$p$ [rad/s]")

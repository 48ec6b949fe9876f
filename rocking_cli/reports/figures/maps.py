"""Overturning maps: the outcome of every cell of a spectra file, with its closed-form
curves.
"""

from typing import Any

import numpy as np

from ...dynamics.method import LINEAR
from ...dynamics.outcome import Outcome
from ...errors import UsageError
from ...spectra.file.reader import SpectraFile
from ..units import Units
from .canvas import DASHES, Axes, label, literal, motion_in_words, titled
from .colours import COLOURS, DIFFERENCES
from .slices import plane

# place of the name on a curve
_ALONG = {
    "initiation": 0.7,
    "no_impact": 0.9,
    "after_impact_upper": 0.75,
    "after_impact_lower": 0.5,
}


def outcome_map(axes: Axes, file: SpectraFile, place: int, units: Units) -> list[Any]:
    """Draw the map of structure or record `place`; return legend entries. Raises
    UsageError if no cell is computed or an axis has names.
    """
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    names, *both = file.frame.dimensions.values()
    if any(isinstance(values, list) for values in both):
        raise UsageError(
            f"{file.path}: found structures on an axis; expected two axes of numbers"
            " for a map"
        )
    across, up, block = plane(file, place)
    shown = block["outcome"]
    if not np.any(shown != Outcome.NOT_COMPUTED):
        raise UsageError(
            f"{file.path}: holds no computed cell of {names[place]}, nothing to draw"
        )
    x, y = (values / units.column(name)[2] for name, values in (across, up))
    colours = [COLOURS[o] for o in Outcome]
    norm = BoundaryNorm(np.arange(-0.5, len(colours)), len(colours))
    axes.pcolormesh(
        x,
        y,
        shown,
        cmap=ListedColormap(colours),
        norm=norm,
        shading="nearest",
        rasterized=True,
    )
    entries: list[Any] = [
        Patch(facecolor=COLOURS[o], edgecolor="0.5", label=o.sentence)
        for o in Outcome
        if np.any(shown == o)
    ]
    if "difference" in block:
        entries += _differences(axes, x, y, block["difference"])
    if x.size > 1 and y.size > 1:
        axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    if not file.frame.of_records:
        _closed_form(axes, file, place, units)
    axes.set(
        xlabel=label(across[0], units),
        ylabel=label(up[0], units),
        title=_title(file, place),
    )
    return entries


def _differences(
    axes: Axes, x: np.ndarray, y: np.ndarray, codes: np.ndarray
) -> list[Any]:
    """Draw the cells for which the linear equation differs, and return legend entries;
    codes: `Difference`, (up, across).
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    entries = []
    for one, colour in DIFFERENCES.items():
        there = np.ma.masked_not_equal(codes, int(one))
        if there.count():
            axes.pcolormesh(
                x,
                y,
                there,
                cmap=ListedColormap([colour]),
                shading="nearest",
                rasterized=True,
                gid=one.flag,
            )
            entries.append(Patch(facecolor=colour, edgecolor="0.5", label=one.sentence))
    return entries


def _title(file: SpectraFile, place: int) -> str:
    """Return the title of the map of one structure or record."""
    model = file.scene["model"]
    if file.frame.of_records:
        return (
            f"{literal(str(next(iter(file.frame.dimensions.values()))[place]))},"
            f" {model} equation"
        )
    s = file.structures[place]
    return (
        f"{titled(s)}\n"
        f"{literal(motion_in_words(file.scene['motion'][0]))}, {model} equation"
    )


def _closed_form(axes: Axes, file: SpectraFile, place: int, units: Units) -> None:
    """Draw the curves i-iv of Fig. 2 for the linear equation, a plain body and a pulse
    with closed forms.
    """
    s, grid = file.structures[place], file.grid
    if file.scene["model"] != LINEAR.model or not s.plain:
        return
    pulse_name = _pulse_of(file)
    if pulse_name is None:
        return
    low, high = grid.frequency.values[[0, -1]] / (1.0 if grid.dimensionless else s.p)
    curves = _curves(float(low), float(high), s.eta, pulse_name)
    for (curve, points), dash in zip(curves.items(), DASHES, strict=False):
        omega = np.array(sorted(points))
        amplitude = np.array([points[w] for w in omega])
        if not grid.dimensionless:
            omega, amplitude = omega * s.p, s.ground_acceleration(amplitude)
        x = omega / units.column(grid.frequency.name)[2]
        y = amplitude / units.column(grid.amplitude.name)[2]
        words = curve.replace("_", " ")
        axes.plot(x, y, color="k", ls=dash, lw=1.2, label=f"closed form: {words}")
        _named(axes, words, x, y, _ALONG.get(curve, 0.5))


def _pulse_of(file: SpectraFile) -> str | None:
    """Return the name of the pulse of a file, None if it has no closed forms."""
    from ...envelopes.closed_form import PULSES
    from ...motions import pulse

    if "vertical" in file.scene:
        return None
    pieces = file.motion().pieces
    return next((name for name in PULSES if pulse(name).pieces == pieces), None)


def _curves(
    low: float, high: float, eta: float, pulse_name: str
) -> dict[str, dict[float, float]]:
    """Return A by Omega for each curve, between two frequencies Omega."""
    from ...envelopes.closed_form import closed_form_curves

    curves: dict[str, dict[float, float]] = {}

    def add(omegas: np.ndarray) -> None:
        for point in closed_form_curves(omegas, eta, pulse_name):
            curves.setdefault(point.curve, {})[point.omega] = point.amplitude

    omegas = np.linspace(low, high, 80)
    add(omegas)

    # A curve ends with an upright tangent where the number of curves changes: there the
    # points are closer, most of all at the side with fewer curves.
    count = [sum(w in points for points in curves.values()) for w in omegas.tolist()]
    for i in np.flatnonzero(np.diff(count)):
        spacing = np.linspace(0.0, 1.0, 40) ** 2
        along = spacing if count[i + 1] > count[i] else 1.0 - spacing
        add(omegas[i] + (omegas[i + 1] - omegas[i]) * along)
    return curves


def _named(axes: Axes, text: str, x: np.ndarray, y: np.ndarray, along: float) -> None:
    """Write the name of a curve on its visible part."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    inside = np.flatnonzero((x >= left) & (x <= right) & (y >= bottom) & (y <= top))
    if inside.size:
        at = inside[int(along * (inside.size - 1))]
        axes.annotate(
            text,
            (x[at], y[at]),
            ha="center",
            va="center",
            fontsize="x-small",
            bbox={"facecolor": "w", "edgecolor": "none", "alpha": 0.75, "pad": 0.6},
        )

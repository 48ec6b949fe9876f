"""Figures of what the commands write: spectra files, and the CSV of envelopes, responses, comparisons, families and accuracy.

Colours are those of Okabe and Ito, which the colour-blind tell apart, and lines differ in dash as well, for print. No display is
needed. matplotlib is the extra `plot`.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..dynamics.method import LINEAR
from ..dynamics.outcome import Difference, Outcome
from ..errors import OutputError, UsageError
from ..spectra.grid import LONG_NAMES, UNITS
from ..spectra.reader import SpectraFile
from .units import si_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Rows = list[dict[str, str]]

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
STYLE: dict[Any, Any] = {
    "font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "grid.linewidth": 0.5, "axes.axisbelow": True,
    "legend.fontsize": 8, "legend.framealpha": 0.9, "savefig.dpi": 200, "figure.constrained_layout.use": True,
}  # fmt: skip
_LABELS = {
    "t": "time t [s]", "theta": "rotation θ [rad]", "tau": "p t [-]", "theta_ratio": "θ/α [-]", "p": "p [rad/s]", "alpha": "α [rad]",
    "eta": "η [-]", "lambda": "λ [-]", "a_scale": "a_scale [-]",
}  # fmt: skip


_IM_LABELS = {
    "PGA": "PGA [m/s²]", "PGV": "PGV [m/s]", "PGD": "PGD [m]", "Arias": "Arias intensity [m/s]", "CAV": "CAV [m/s]",
    "nPGA": "PGA/(λ g) [-]", "nPGV": "p PGV/(g tan α) [-]", "nPGD": "p² PGD/(g tan α) [-]",
}  # fmt: skip


def draw(source: Path, target: Path, *, structure: str | None = None, cut: str | None = None, log: str = "") -> None:
    """Draw what a file holds into a PNG, SVG or PDF; cut: `Omega=5` or `A=3`, a slice of a spectra file; log: x, y or xy.

    Raises UsageError for a file that is none of those, OutputError without matplotlib or where the figure cannot be written.
    """
    with canvas(target) as figure:
        if is_spectra_file(source):
            with SpectraFile(source) as file:
                axes = [_slice(figure, file, cut) if cut else _map(figure, file, structure)]
        else:
            axes = _table(figure, source, _rows(source))
        for one in axes:
            if "x" in log:
                one.set_xscale("log")
            if "y" in log:
                one.set_yscale("log")


@contextmanager
def canvas(target: Path) -> Iterator[Figure]:
    """An empty figure in the house's style, which is written to `target` at the end. Raises OutputError without matplotlib or where the
    figure cannot be written."""
    try:
        import matplotlib as mpl
        from matplotlib.figure import Figure
    except ImportError:
        raise OutputError("figures need matplotlib: pip install 'rocking[plot]'; `text` needs nothing") from None
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 4.0))
        yield figure
        try:
            figure.savefig(target)
        except (OSError, ValueError) as error:
            raise OutputError(f"{target}: cannot be written: {error}") from None


def literal(text: str) -> str:
    """A name as it is: a dollar sign in it begins no formula."""
    return text.replace("$", r"\$")


def is_spectra_file(source: Path) -> bool:
    """By its name; anything else is read as CSV."""
    return source.suffix.lower() in (".h5", ".hdf5", ".nc", ".part")


def _label(axis: str) -> str:
    unit = {"1": "-", "m s-2": "m/s²", "rad s-1": "rad/s"}[UNITS[axis]]
    return {"A": "A = a_scale a_g/(α g)", "Omega": "Ω = ω_g/p"}.get(axis, LONG_NAMES[axis]) + f" [{unit}]"


def _map(figure: Figure, file: SpectraFile, name: str | None) -> Axes:
    """Overturning map of one structure, with the closed-form curves where there are some."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    index = file.index(name or file.structures[0].name)
    s, axes = file.structures[index], figure.add_subplot()
    frequency, amplitude = file.grid.frequency, file.grid.amplitude
    block = file.block(index, slice(None))
    outcome = block["outcome"]
    colours = [o.colour for o in Outcome]
    norm = BoundaryNorm(np.arange(-0.5, len(colours)), len(colours))
    axes.pcolormesh(
        frequency.values, amplitude.values, outcome.T, cmap=ListedColormap(colours), norm=norm, shading="nearest", rasterized=True
    )
    entries: list[Any] = [Patch(facecolor=o.colour, edgecolor="0.5", label=o.sentence) for o in Outcome if np.any(outcome == o)]
    if "difference" in block:
        entries += _differences(axes, frequency.values, amplitude.values, block["difference"])
    entries += _closed_form(axes, file, index)
    axes.set(xlabel=_label(frequency.name), ylabel=_label(amplitude.name), title=f"{s.name}, η = {s.eta:.4g}: {file.scene['motion'][0]}")
    if frequency.values.size > 1 and amplitude.values.size > 1:
        axes.set(xlim=(frequency.values[0], frequency.values[-1]), ylim=(amplitude.values[0], amplitude.values[-1]))
    axes.legend(handles=entries, loc="upper left")
    return axes


def _differences(axes: Axes, x: np.ndarray, y: np.ndarray, codes: np.ndarray) -> list[Any]:
    """Over the map the cells that the linear equation judges otherwise, and their entries of the legend."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    entries = []
    for one in Difference:
        if one.colour is not None:
            there = np.ma.masked_not_equal(codes.T, int(one))
            axes.pcolormesh(x, y, there, cmap=ListedColormap([one.colour]), shading="nearest", rasterized=True, gid=one.flag)
            entries.append(Patch(facecolor=one.colour, edgecolor="0.5", label=f"{one.sentence} ({there.count()} cells)"))
    return entries


def _closed_form(axes: Axes, file: SpectraFile, index: int) -> list[Any]:
    """Curves i-iv of Fig. 2 over the map of a linear spectrum, of a body that they hold for."""
    from ..motions import pulse
    from ..spectra.closed_form import PULSES, closed_form_curves

    s, pieces = file.structures[index], file.motion().pieces
    name = next((p for p in PULSES if pulse(p).pieces == pieces), None)
    if name is None or file.scene["model"] != LINEAR.model or not s.plain:
        return []
    dimensionless = file.grid.dimensionless
    omega = np.linspace(file.grid.frequency.values[0], file.grid.frequency.values[-1], 80) / (1.0 if dimensionless else s.p)
    lines: dict[str, list[tuple[float, float]]] = {}
    for point in closed_form_curves(omega, s.eta, name):
        x, y = (point.omega, point.amplitude) if dimensionless else (point.omega * s.p, float(s.ground_acceleration(point.amplitude)))
        lines.setdefault(point.curve, []).append((x, y))
    drawn = []
    for (curve, points), dash in zip(lines.items(), DASHES, strict=False):
        (line,) = axes.plot(*np.array(points).T, color="k", ls=dash, lw=1.2, label=f"closed form: {curve.replace('_', ' ')}")
        drawn.append(line)
    return drawn


def slice_of(file: SpectraFile, cut: str) -> tuple[str, float, str, np.ndarray, list[np.ndarray]]:
    """(axis cut, grid value, other axis, its values, theta_ratio of each structure) of `NAME=VALUE`. Raises UsageError."""
    key, _, text = (x.strip() for x in cut.partition("="))
    axes = {axis.name: axis.values for axis in (file.grid.frequency, file.grid.amplitude)}
    try:
        at = int(np.abs(axes[key] - float(text)).argmin())
        if not axes[key][0] <= float(text) <= axes[key][-1]:
            raise ValueError
    except (KeyError, ValueError):
        wanted = " or ".join(f"{k}={v[0]:g} to {v[-1]:g}" for k, v in axes.items())
        raise UsageError(f"`slice`: found {cut!r}; accepted is {wanted}") from None
    frequency = key == file.grid.frequency.name
    (other,) = (name for name in axes if name != key)
    rows, columns = (slice(at, at + 1), slice(None)) if frequency else (slice(None), slice(at, at + 1))
    found = [file.block(i, rows, columns)["theta_ratio"].ravel() for i in range(len(file.structures))]
    return key, float(axes[key][at]), other, axes[other], found


def _slice(figure: Figure, file: SpectraFile, cut: str) -> Axes:
    """Rocking spectra (Fig. 2 right): theta_max/alpha of every structure along one axis; gaps are overturning."""
    key, value, other, x, found = slice_of(file, cut)
    axes = figure.add_subplot()
    for i, (s, theta) in enumerate(zip(file.structures, found, strict=True)):
        axes.plot(x, theta, color=COLOURS[i % 7], ls=DASHES[i % 5], label=f"{s.name}, η = {s.eta:.3g}")
    axes.set(xlabel=_label(other), ylabel="θ_max/α [-]", title=f"{file.scene['motion'][0]}, {key} = {value:.4g}; gaps: overturned")
    axes.legend()
    return axes


def _rows(source: Path) -> Rows:
    try:
        with open(source, encoding="utf-8", newline="") as handle:
            rows = [_in_si(row) for row in csv.DictReader(handle, strict=True)]
    except OSError as error:
        raise UsageError(f"{source}: cannot be read: {error.strerror or error}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"{source}: neither a spectra file nor CSV ({error})") from None
    if not rows:
        raise UsageError(f"{source}: holds no rows")
    return rows


def _in_si(row: dict[str, str]) -> dict[str, str]:
    """A row as `rocking` prints it without --units, under plain names; what is no number stays as it is."""
    found = {}
    for heading, text in row.items():
        column, factor = si_of(heading or "")
        if factor != 1.0 and text:
            with suppress(ValueError):
                text = repr(float(text) * factor)
        found[column] = text
    return found


def _table(figure: Figure, source: Path, rows: Rows) -> list[Axes]:
    columns = set(rows[0])
    if "event" in columns:
        raise UsageError(f"{source}: holds events; accepted is the time history, which rocking response prints without them")
    kinds: tuple[tuple[set[str], Callable[[Figure, Rows], list[Axes]]], ...] = (
        ({"Omega", "A_from", "A_to", "mode"}, _envelope),
        ({"curve", "Omega", "A"}, _curves),
        ({"structure", "tau", "theta_ratio", "t", "theta"}, _comparison),
        ({"method", "time_per_cell", "error_max"}, _accuracy),
        ({"im", "limit_state", "probability", "fraction"}, _fragility),
        ({"t"}, _response),
        ({"tau"}, _response),
        ({"p", "alpha", "eta", "lambda"}, _family),
    )
    for wanted, kind in kinds:
        if wanted <= columns:
            try:
                return kind(figure, rows)
            except (ValueError, TypeError, KeyError) as error:
                raise UsageError(f"{source}: cannot be drawn: {error}") from None
    raise UsageError(f"{source}: its columns ({', '.join(sorted(columns))[:80]}) are none that a command of this program writes")


def _column(rows: Iterable[dict[str, str]], key: str) -> np.ndarray:
    return np.array([float(r[key]) if r[key] else np.nan for r in rows])


def _groups(rows: Rows, *keys: str) -> dict[tuple[str, ...], Rows]:
    groups: dict[tuple[str, ...], Rows] = {}
    for row in rows:
        groups.setdefault(tuple(row[k] for k in keys if k in row), []).append(row)
    return groups


def _envelope(figure: Figure, rows: Rows) -> list[Axes]:
    axes = figure.add_subplot()
    top = max(np.nanmax(_column(rows, "A_from")), np.nanmax(np.append(_column(rows, "A_to"), 0.0))) * 1.1
    modes = {o.mode: o for o in Outcome}
    for (mode,), some in _groups(rows, "mode").items():
        drawn = modes.get(mode, Outcome.FAILED)
        low, high = _column(some, "A_from"), _column(some, "A_to")
        axes.vlines(_column(some, "Omega"), low, np.where(np.isnan(high), top, high), color=drawn.colour, lw=2.0, alpha=0.6)
        axes.plot(_column(some, "Omega"), low, ".", color=drawn.colour, ms=3, label=drawn.sentence)
    axes.set(xlabel=_label("Omega"), ylabel=_label("A"), ylim=(0.0, top))
    axes.legend()
    return [axes]


def _curves(figure: Figure, rows: Rows) -> list[Axes]:
    axes = figure.add_subplot()
    for i, (key, some) in enumerate(_groups(rows, "structure", "curve").items()):
        axes.plot(_column(some, "Omega"), _column(some, "A"), color=COLOURS[i % 7], ls=DASHES[i % 5], label=" ".join(key).replace("_", " "))
    axes.set(xlabel=_label("Omega"), ylabel=_label("A"))
    axes.legend()
    return [axes]


def _comparison(figure: Figure, rows: Rows) -> list[Axes]:
    """Dimensional responses beside the dimensionless ones, which collapse (Fig. 8)."""
    figure.set_size_inches(8.0, 3.6)
    axes = list(figure.subplots(1, 2))
    for i, (key, some) in enumerate(_groups(rows, "structure", "model").items()):
        look = {"color": COLOURS[i % 7], "ls": DASHES[i % 5], "lw": 2.4 - 0.5 * min(i, 3), "label": ", ".join(key)}
        axes[0].plot(_column(some, "t"), _column(some, "theta"), **look)
        axes[1].plot(_column(some, "tau"), _column(some, "theta_ratio"), **look)
    axes[0].set(xlabel=_LABELS["t"], ylabel=_LABELS["theta"])
    axes[1].set(xlabel=_LABELS["tau"], ylabel=_LABELS["theta_ratio"])
    axes[0].legend()
    return axes


def _response(figure: Figure, rows: Rows) -> list[Axes]:
    x, y, ground = ("t", "theta", "ground_acceleration") if "t" in rows[0] else ("tau", "theta_ratio", "A")
    axes, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    drawn = [c for c in rows[0] if c == y or (c.startswith(f"{y}_") and not c.startswith((f"{y}_dot", f"{y}_rate")))]
    for i, column in enumerate(drawn):
        axes.plot(_column(rows, x), _column(rows, column), color=COLOURS[i], ls=DASHES[i], label=column.removeprefix(y).strip("_") or y)
    axes.set_ylabel(_LABELS[y])
    if len(drawn) > 1:
        axes.legend()
    below.plot(_column(rows, x), _column(rows, ground), color="0.3", lw=1.0)
    below.set(xlabel=_LABELS[x], ylabel="ẍ_g [m/s²]" if x == "t" else "A s [-]")
    return [axes]


def _family(figure: Figure, rows: Rows) -> list[Axes]:
    """Parameters over the first varied key, one line for each value of the second (Figs. 4 and 6)."""
    head = list(rows[0])
    varied = head[: head.index("name")] if "name" in head else []
    if not varied:
        raise UsageError("a family is drawn over the keys that were varied; this CSV holds no column of one")
    figure.set_size_inches(7.2, 5.2)
    axes = list(figure.subplots(2, 2, sharex=True).ravel())
    for one, key in zip(axes, ("p", "alpha", "eta", "lambda"), strict=True):
        for i, (group, some) in enumerate(_groups(rows, *varied[1:]).items()):
            label = ", ".join(_valued(k, v) for k, v in zip(varied[1:], group, strict=True))
            one.plot(_column(some, varied[0]), _column(some, key), color=COLOURS[i % 7], ls=DASHES[i % 5], label=label)
        one.set_ylabel(_LABELS[key])
    for one in axes[2:]:
        one.set_xlabel(varied[0].replace("_", " "))
    if len(varied) > 1:
        axes[0].legend()
    return axes


def _valued(heading: str, value: str) -> str:
    """`height = 8 m` of a column `height [m]`."""
    key, _, unit = heading.partition(" [")
    return f"{key.replace('_', ' ')} = {float(value):.4g} {unit.removesuffix(']')}".rstrip()


def _fragility(figure: Figure, rows: Rows) -> list[Axes]:
    """Fragility curves with their bands and the fractions that they were fitted to; exact shares as steps."""
    axes = figure.add_subplot()
    for i, (group, some) in enumerate(_groups(rows, "structure", "limit_state", "method").items()):
        x, p = _column(some, "x"), _column(some, "probability")
        style: dict[str, Any] = {"color": COLOURS[i % 7], "ls": DASHES[i % 5], "label": ", ".join(group)}
        if np.all(np.isnan(p)):
            axes.step(np.append(0.0, x), np.append(0.0, _column(some, "fraction")), where="post", lw=1.0, **style)
            continue
        axes.plot(x, p, **style)
        axes.fill_between(x, _column(some, "low"), _column(some, "high"), color=COLOURS[i % 7], alpha=0.15, lw=0.0)
        axes.plot(x, _column(some, "fraction"), ls="", marker="osv^D"[i % 5], ms=4.0, color=COLOURS[i % 7])
    im = rows[0]["im"]
    axes.set(xlabel=_IM_LABELS.get(im, im), ylabel="probability [-]", ylim=(0.0, 1.0))
    axes.set_xlim(left=0.0)
    axes.legend()
    return [axes]


def _accuracy(figure: Figure, rows: Rows) -> list[Axes]:
    axes = figure.add_subplot()
    for i, ((method,), some) in enumerate(_groups(rows, "method").items()):
        error = np.maximum(_column(some, "error_max"), 1e-17)
        axes.plot(1e6 * _column(some, "time_per_cell"), error, color=COLOURS[i % 7], ls=DASHES[i % 5], marker="osv^D"[i % 5], label=method)
    axes.set(xscale="log", yscale="log", xlabel="run time a cell [µs]", ylabel="largest error of θ/α [-]")
    axes.legend()
    return [axes]


def text_map(file: SpectraFile, name: str | None, cut: str | None, width: int = 72, height: int = 24) -> list[str]:
    """The outcome map, or a slice, in characters."""
    if cut:
        key, value, other, x, found = slice_of(file, cut)
        lines = [f"theta_max/alpha at {key} = {value:.4g} over {other} {x[0]:.4g} to {x[-1]:.4g}; blank: overturned"]
        for s, theta in zip(file.structures, found, strict=True):
            picked = theta[np.linspace(0, theta.size - 1, min(width, theta.size)).astype(int)]
            lines += [f"{s.name}, eta = {s.eta:.3g}", *_bars(picked, 12)]
        return lines
    index = file.index(name or file.structures[0].name)
    frequency, amplitude = file.grid.frequency, file.grid.amplitude
    rows = np.linspace(amplitude.values.size - 1, 0, min(height, amplitude.values.size)).astype(int)
    columns = np.linspace(0, frequency.values.size - 1, min(width, frequency.values.size)).astype(int)
    outcome = file.block(index, slice(None))["outcome"]
    meanings = "  ".join(f"'{o.sign}' {o.sentence}" for o in Outcome if np.any(outcome == o))
    lines = [f"{file.structures[index].name}: {meanings}"]
    lines += [f"{amplitude.values[r]:>9.3g} |" + "".join(Outcome(int(outcome[c, r])).sign for c in columns) for r in rows]
    lines.append(" " * 10 + "+" + "-" * columns.size)
    lines.append(f"{amplitude.name:>9}   {frequency.name} {frequency.values[0]:.4g} to {frequency.values[-1]:.4g}")
    return lines


def _bars(values: np.ndarray, height: int) -> list[str]:
    top = float(np.nanmax(np.append(values, 1e-300)))
    filled = [-1 if np.isnan(v) else round(height * v / top) for v in values]
    marks = [f"{top * r / height:>9.3g} |" + "".join("*" if f == r else " " for f in filled) for r in range(height, -1, -1)]
    return [*marks, " " * 10 + "+" + "-" * len(filled)]

"""Tables drawn as lines: responses, comparisons, families, fragility curves, closed-form curves, accuracy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...documents.quantities import headed
from ...errors import UsageError
from ..rows import Rows, column, groups
from ..units import HEADING, Units, dimension_of
from .canvas import MARKERS, PLAIN, label, legend, look, series, values

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MEASURE_LABELS = {
    "Arias": "Arias intensity [m/s]", "CAV": "CAV [m/s]",
    "nPGA": r"PGA/$(\lambda g)$ [-]", "nPGV": r"$p$ PGV/$(g \tan\alpha)$ [-]", "nPGD": r"$p^2$ PGD/$(g \tan\alpha)$ [-]",
}  # fmt: skip
_JUMP = 8.0  # a step so many times larger than its neighbours is a jump of the motion
_MOVED = 0.02  # rad; a hinge that moves less between two members is still the same hinge
_LEAP = 4.0  # times the median step
_X = "over"  # a column for the abscissa of a family


def response(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the rotation (a line for each equation), below it the forces if the rows have any, and the ground acceleration."""
    x, y, ground = ("t", "theta", "ground_acceleration") if "t" in rows[0] else ("tau", "theta_ratio", "A")
    pushes = [c for c in rows[0] if c.startswith(("fx_ratio", "fz_ratio")) and not c.endswith("_after")]
    ratios = [3, *([1.5] if pushes else []), 1]
    axes, *between, below = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
    drawn = [c for c in rows[0] if c == y or (c.startswith(f"{y}_") and not c.startswith((f"{y}_dot", f"{y}_rate")))]
    for i, name in enumerate(drawn):
        model = name.removeprefix(y).strip("_")
        axes.plot(values(rows, x, units), values(rows, name, units), label=f"{model} equation" if model else "response", **look(i))
    axes.set_ylabel(label(y, units))
    legend(axes)
    below.plot(*with_jumps(values(rows, x, units), values(rows, ground, units)), color="0.3", lw=1.0)
    below.set(xlabel=label(x, units), ylabel=label("ground_acceleration" if x == "t" else "A_s", units))
    for one in between:
        for i, name in enumerate(pushes):
            word, model = name[:2], name[len("fx_ratio") :].strip("_")
            text = f"$F_{word[1]}/mg$" + (f", {model} equation" if model else "")
            one.plot(*with_jumps(values(rows, x, units), values(rows, name, units)), label=text, **look(i))
        one.set_ylabel("$F/mg$ [-]")
        legend(one)
    return [axes, *between, below]


def with_jumps(t: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The samples with one more point at each jump, which makes its line vertical at the later sample."""
    step = np.abs(np.diff(a, prepend=a[:1], append=a[-1:]))
    beside = np.maximum(step[:-2], step[2:]) if a.size > 1 else np.zeros(0)
    jumps = np.flatnonzero((step[1:-1] > _JUMP * beside) & (step[1:-1] > 0.05 * np.max(np.abs(a), initial=0.0))) + 1
    return np.insert(t, jumps, t[jumps]), np.insert(a, jumps, a[jumps - 1])


def comparison(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw theta over t, and theta/alpha over p t, in which the responses coincide (Fig. 8)."""
    figure.set_size_inches(8.0, 3.6)
    axes = list(figure.subplots(1, 2))
    for one, x, y in zip(axes, ("t", "tau"), ("theta", "theta_ratio"), strict=True):
        for i, (some, style) in enumerate(series(rows, "structure", "model")):
            one.plot(values(some, x, units), values(some, y, units), lw=2.4 - 0.5 * min(i, 3), **style)
        one.set(xlabel=label(x, units), ylabel=label(y, units))
    legend(axes[0])
    return axes


def accuracy(figure: Figure, rows: Rows, _: Units) -> list[Axes]:
    """Draw the largest error over run time, one line for each method."""
    axes = figure.add_subplot()
    for some, style in series(rows, "method", marked=True):
        axes.plot(1e6 * column(some, "time_per_cell"), np.maximum(column(some, "error_max"), 1e-17), **style)
    axes.set(xscale="log", yscale="log", xlabel="run time a cell [µs]", ylabel=r"largest error of $\theta/\alpha$ [-]")
    legend(axes)
    return [axes]


def closed_forms(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the closed-form curves A(Omega), one line for each."""
    axes = figure.add_subplot()
    for some, style in series(rows, "structure", "curve"):
        axes.plot(values(some, "Omega", units), values(some, "A", units), **{**style, "label": style["label"].replace("_", " ")})
    axes.set(xlabel=label("Omega", units), ylabel=label("A", units))
    legend(axes)
    return [axes]


def fragility_curves(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw a fragility curve with its confidence band and the observed fractions for each structure, limit state and method.

    A method without a fitted curve is drawn as steps of its fractions.
    """
    axes = figure.add_subplot()
    im = rows[0]["im"]
    dimension = dimension_of(im.lower())
    unit, factor = ("", 1.0) if dimension is None else units.of(dimension)
    for i, (some, style) in enumerate(series(rows, "structure", "limit_state", "method")):
        x, p, share = column(some, "x") / factor, column(some, "probability"), column(some, "fraction")
        if np.all(np.isnan(p)):
            axes.step(np.append(0.0, x), np.append(0.0, share), where="post", lw=1.0, **style)
            continue
        axes.plot(x, p, **style)
        axes.fill_between(x, column(some, "low"), column(some, "high"), color=style["color"], alpha=0.15, lw=0.0)
        axes.plot(x, share, ls="", marker=MARKERS[i % len(MARKERS)], ms=4.0, color=style["color"])
    axes.set(xlabel=MEASURE_LABELS.get(im) or headed(im, PLAIN.get(unit, unit)), ylabel="probability [-]", ylim=(0.0, 1.0))
    axes.set_xlim(left=0.0)
    legend(axes)
    return [axes]


def overturning_spectra(figure: Figure, rows: Rows, _: Units) -> list[Axes]:
    """Draw the first overturning PGA over p: the median of the records as a line, 16 to 84 % as a band, for each critical angle."""
    axes = figure.add_subplot()
    for i, (group, some) in enumerate(groups(rows, "alpha").items()):
        p = column(some, "p")
        low, middle, high = (column(some, f"pga_ratio_{q}") for q in (16, 50, 84))
        style = look(i) if group else {**look(i), "ls": "", "marker": MARKERS[i % len(MARKERS)]}
        axes.plot(p, middle, label=rf"$\alpha$ = {np.degrees(float(group[0])):.3g}°" if group else None, **style)
        axes.fill_between(p, low, high, color=style["color"], alpha=0.2, lw=0.0)
    axes.set(xlabel=r"$p$ [rad/s]", ylabel=r"first overturning PGA/$(\lambda g)$ [-]")
    legend(axes)
    return [axes]


def family(figure: Figure, rows: Rows, units: Units, over: str | None = None) -> list[Axes]:
    """Draw p, alpha, eta, lambda (and a_scale) over the first varied key, or over `KEY/KEY`; one line for each value of the others
    (Figs. 4 and 6).

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
            one.plot(*_broken(some, values(some, key, units)), label=text, **look(i))
        one.set_ylabel(label(key, units))
    for one in panels[len(keys) // 2 : len(keys)]:
        one.set_xlabel(xlabel)
        one.tick_params(labelbottom=True)
    for spare in panels[len(keys) :]:
        spare.axis("off")
        if others:
            spare.legend(handles=panels[0].get_lines(), loc="center")
    if len(keys) == len(panels):
        legend(panels[0])
    return panels[: len(keys)]


def _abscissa(rows: Rows, varied: list[str], over: str | None) -> tuple[np.ndarray, str, list[str]]:
    """(values, label, other columns) of the abscissa; the other columns are constant along a line. Raises UsageError."""
    names = {heading.partition(" [")[0]: heading for heading in varied}
    keys = next(iter(names)).split("/") if over is None else over.split("/")
    if len(keys) > 2 or any(key not in names for key in keys):
        raise UsageError(f"`over`: found {over!r}; expected {', '.join(names)}, or one over another, such as KEY/KEY")
    numbers, headings = [column(rows, names[key]) for key in keys], [names[key] for key in keys]
    others = [heading for heading in varied if heading not in headings]
    if len(keys) == 1:
        return numbers[0], headings[0].replace("_", " "), others
    units = [(HEADING.fullmatch(heading) or {"unit": ""})["unit"] for heading in headings]
    if units[0] != units[1]:
        raise UsageError(f"`over`: {keys[0]} is in {units[0]} and {keys[1]} in {units[1]}; expected one unit for both")
    return numbers[0] / numbers[1], f"{' / '.join(keys).replace('_', ' ')} [-]", [headings[1], *others]


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


def _valued(heading: str, value: str) -> str:
    """A column heading and a value as text: `height = 8 m` from `height [m]` and 8."""
    key, _, unit = heading.partition(" [")
    return f"{key.replace('_', ' ')} = {float(value):.4g} {unit.removesuffix(']')}".rstrip()

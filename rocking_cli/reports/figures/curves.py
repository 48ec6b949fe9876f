"""Tables drawn as lines: responses, comparisons, families, closed-form curves,
accuracy.
"""

import re
from itertools import cycle

import numpy as np

from ...errors import UsageError
from ..rows import Rows, column, groups
from ..units import HEADING, Units
from .canvas import (
    DASHES,
    MARKERS,
    SOURCE,
    Axes,
    Figure,
    heading,
    label,
    legend,
    line_style,
    literal,
    series,
    valued,
    values,
)

VARIED = "varied_"  # begins the columns of the varied values of check and envelope
_X = "over"  # a column for the abscissa of a family


def response(
    figure: Figure, rows: Rows, units: Units, align: bool = False
) -> list[Axes]:
    """Draw the rotation for each file and equation, below it the forces if there are
    any, and the ground acceleration.

    align: the time of each file counts from its largest rotation, or from theta = alpha
    if the body overturns.
    """
    x, ground = ("t", "ground_acceleration") if "t" in rows[0] else ("tau", "A")
    pushes = [
        c
        for c in rows[0]
        if c.startswith(("fx_ratio", "fz_ratio")) and not c.endswith("_after")
    ]
    ratios = [3, *([1.5] if pushes else []), 1]
    axes, *between, below = figure.subplots(
        len(ratios), 1, sharex=True, height_ratios=ratios
    )
    files = groups(rows, SOURCE)
    for i, (at, some) in enumerate(rotations(axes, rows, units, align)):
        style = {"color": "0.3" if len(files) == 1 else f"C{i}", "lw": 1.0}
        below.plot(*with_jumps(at, values(some, ground, units)), **style)
    below.set(
        xlabel=label(x, units) + ", 0 at the largest rotation" * align,
        ylabel=label("ground_acceleration" if x == "t" else "A_s", units),
    )
    for one in between:
        for i, name in enumerate(pushes):
            style = {
                "color": "C2" if name[1] == "x" else "C3",
                "ls": DASHES[i // 2],
            }  # an equation has its dash of above
            text = f"$F_{name[1]}/mg$" if i < 2 else "_"
            one.plot(
                *with_jumps(values(rows, x, units), values(rows, name, units)),
                label=text,
                **style,
            )
        one.set_ylabel("$F/mg$ [-]")
        legend(one)
    return [axes, *between, below]


def rotations(
    axes: Axes, rows: Rows, units: Units, align: bool = False
) -> list[tuple[np.ndarray, Rows]]:
    """Draw the rotation for each file and equation; return (times, rows) of each
    file.
    """
    x, y = ("t", "theta") if "t" in rows[0] else ("tau", "theta_ratio")
    files, found = groups(rows, SOURCE), []
    for i, (source, some) in enumerate(files.items()):
        at = values(some, x, units)
        if align:
            ratio = column(
                some, next(c for c in rows[0] if c.startswith("theta_ratio"))
            )
            at -= at[np.argmax(np.minimum(np.abs(ratio), 1.0))]
        for j, name in enumerate(
            c for c in rows[0] if re.fullmatch(f"{y}(_linear|_nonlinear)?", c)
        ):
            model = name.removeprefix(y).strip("_")
            words = [*map(literal, source), *([f"{model} equation"] if model else [])]
            text = ", ".join(words) or "response"
            style = (
                line_style(j)
                if len(files) == 1
                else {"color": f"C{i}", "ls": DASHES[j]}
            )
            axes.plot(at, values(some, name, units), label=text, **style)
        found.append((at, some))
    axes.set(
        ylabel=label(y, units), title=heading(rows, "structure", "motion", "model")
    )
    legend(axes)
    return found


def response_axes(axes: Axes, rows: Rows, units: Units, align: bool = False) -> Axes:
    """Draw the rotation alone into Axes, and return them."""
    rotations(axes, rows, units, align)
    time = label("t" if "t" in rows[0] else "tau", units)
    axes.set_xlabel(time + ", 0 at the largest rotation" * align)
    return axes


def with_jumps(t: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the samples with one more point at each jump, a step eight times larger
    than its neighbours: the line is vertical there.
    """
    step = np.abs(np.diff(a, prepend=a[:1], append=a[-1:]))
    neighbour = np.maximum(step[:-2], step[2:]) if a.size > 1 else np.zeros(0)
    jumps = (
        np.flatnonzero(
            (step[1:-1] > 8.0 * neighbour)
            & (step[1:-1] > 0.05 * np.max(np.abs(a), initial=0.0))
        )
        + 1
    )
    return np.insert(t, jumps, t[jumps]), np.insert(a, jumps, a[jumps - 1])


def comparison(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the ground acceleration if the rows have it, theta over t, and theta/alpha
    over p t (Figs. 8b to 8d).
    """
    shown = [("t", "theta"), ("tau", "theta_ratio")]
    shown[:0] = (
        [("t", "ground_acceleration")] if "ground_acceleration" in rows[0] else []
    )
    figure.set_size_inches(4.0 * len(shown), 3.6)
    axes = list(figure.subplots(1, len(shown)))
    for one, (x, y) in zip(axes, shown, strict=True):
        for i, (some, style) in enumerate(series(rows, "structure", "model")):
            one.plot(
                values(some, x, units),
                values(some, y, units),
                lw=2.4 - 0.5 * min(i, 3),
                **style,
            )
        one.set(xlabel=label(x, units), ylabel=label(y, units))
    if len(shown) == 3:  # the ground moves for the first part of the response only
        axes[0].set_xlim(
            0.0,
            1.1
            * max(float(row["t"]) for row in rows if float(row["ground_acceleration"])),
        )
    axes[len(axes) // 2].set_title(heading(rows, "structure", "motion", "model"))
    legend(axes[-1])
    return axes


def accuracy(figure: Figure, rows: Rows, _: Units) -> list[Axes]:
    """Draw the largest error over run time, one line for each method."""
    axes = figure.add_subplot()
    for marker, (some, style) in zip(
        cycle(MARKERS), series(rows, "method"), strict=False
    ):
        axes.plot(
            1e6 * column(some, "time_per_cell"),
            np.maximum(column(some, "error_max"), 1e-17),
            marker=marker,
            **style,
        )
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="run time a cell [µs]",
        ylabel=r"largest error of $\theta/\alpha$ [-]",
    )
    legend(axes)
    return [axes]


def closed_forms(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the closed-form curves A(Omega), one line for each."""
    axes = figure.add_subplot()
    for some, style in series(rows, "structure", "curve"):
        axes.plot(
            values(some, "Omega", units),
            values(some, "A", units),
            **{**style, "label": style["label"].replace("_", " ")},
        )
    axes.set(
        xlabel=label("Omega", units),
        ylabel=label("A", units),
        title=heading(rows, "structure", "motion", "model"),
    )
    legend(axes)
    return [axes]


def family(
    figure: Figure, rows: Rows, units: Units, over: str | None = None
) -> list[Axes]:
    """Draw p, alpha, eta, lambda (and a_scale) over the first varied key, or over
    `KEY/KEY`, for each value of the others (Figs. 4, 6).

    Lines have a gap where the hinges change their places, and where members have no
    solution. Raises UsageError.
    """
    head = list(rows[0])
    varied = head[: head.index("name")] if "name" in head else []
    if not varied:
        raise UsageError(
            "a family is drawn over the keys that were varied; this CSV has no column"
            " of a varied key"
        )
    xlabel, others = _abscissa(rows, varied, over)
    keys = [
        "p",
        "alpha",
        "eta",
        "lambda",
        *(["a_scale"] if np.any(column(rows, "a_scale") != 1.0) else []),
    ]
    figure.set_size_inches(10.5 if len(keys) > 4 else 7.2, 5.2)
    panels = list(figure.subplots(2, (len(keys) + 1) // 2, sharex=True).ravel())
    names = {
        row["name"].partition(f" {varied[0].partition(' [')[0]}=")[0] for row in rows
    }
    figure.suptitle(literal(names.pop()) if len(names) == 1 else "", fontsize="medium")
    for one, key in zip(panels, keys, strict=False):
        for i, (group, some) in enumerate(groups(rows, *others).items()):
            text = (
                ", ".join(_valued(k, v) for k, v in zip(others, group, strict=True))
                or "_"
            )
            one.plot(
                *_broken(some, values(some, key, units)), label=text, **line_style(i)
            )
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


def least_amplitudes(
    figure: Figure, rows: Rows, units: Units, over: str | None = None
) -> list[Axes]:
    """Draw the least amplitude that overturns over the first varied key, or over
    `KEY/KEY`: the CSV of check or envelope with `vary`.

    One line for each motion or frequency and value of the other keys, with gaps where
    nothing overturns. Raises UsageError.
    """
    y = next(
        key for key in ("first_overturning_a", "a_from", "A_from") if key in rows[0]
    )
    varied = [heading for heading in rows[0] if heading.startswith(VARIED)]
    xlabel, others = _abscissa(rows, varied, over)
    frequency = next((key for key in ("omega_g", "Omega") if rows[0].get(key)), "")
    for row in rows if frequency else ():  # its last digits differ between structures
        row[frequency] = f"{float(row[frequency]):.9g}"
    axes, demands = figure.add_subplot(), set[float]()
    places = [
        key
        for key in ("motion", "record", frequency, "model")
        if len(groups(rows, key)) > 1
    ]
    for i, (group, some) in enumerate(groups(rows, *others, *places).items()):
        named = zip([*others, *places], group, strict=True)
        text = ", ".join(
            (
                _valued(k, v)
                if k in others
                else valued(k, float(v), units)
                if k == frequency
                else v
            )
            for k, v in named
        )
        least = [
            min(lines, key=lambda row: float(row[y] or "inf"))
            for lines in groups(some, _X).values()
        ]
        axes.plot(
            *_broken(least, values(least, y, units)), label=text or "_", **line_style(i)
        )
        if (
            "demand_a" in rows[0]
            and (demand := round(float(values(some, "demand_a", units)[0]), 9))
            not in demands
        ):
            axes.axhline(
                demand, color="0.4", lw=1.0, ls="--", label="_" if demands else "demand"
            )
            demands.add(demand)
    axes.set(
        xlabel=xlabel,
        ylabel=label(y, units),
        title=heading(rows, "motion", "record", "model"),
    )
    axes.set_ylim(bottom=0.0)
    legend(axes)
    return [axes]


def _abscissa(rows: Rows, varied: list[str], over: str | None) -> tuple[str, list[str]]:
    """Add the column _X of the abscissa to the rows; return its label and the other
    columns. Raises UsageError.
    """
    names = {
        heading.partition(" [")[0].removeprefix(VARIED): heading for heading in varied
    }
    keys = next(iter(names)).split("/") if over is None else over.split("/")
    if len(keys) > 2 or any(key not in names for key in keys):
        more = (
            "; a key of one value is varied too, as in height=2:2:1"
            if len(keys) == 2
            else ""
        )
        raise UsageError(
            f"`over`: found {over!r}; expected {', '.join(names)}, or one over another,"
            f" such as KEY/KEY{more}"
        )
    headings = [names[key] for key in keys]
    x, *divisor = (column(rows, heading) for heading in headings)
    text, others = (
        headings[0].removeprefix(VARIED).replace("_", " "),
        [heading for heading in varied if heading not in headings],
    )
    if divisor:
        units = [
            (HEADING.fullmatch(heading) or {"unit": ""})["unit"] for heading in headings
        ]
        if units[0] != units[1]:
            raise UsageError(
                f"`over`: {keys[0]} is in {units[0]} and {keys[1]} in {units[1]};"
                " expected one unit for both"
            )
        x, text, others = (
            x / divisor[0],
            f"{' / '.join(keys).replace('_', ' ')} [-]",
            [headings[1], *others],
        )
    for row, value in zip(rows, x.tolist(), strict=True):
        row[_X] = repr(value)
    return text, others


def _broken(some: Rows, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (x, y) of a line, with NaN where the mechanism changes or a member is
    missing.
    """
    x = column(some, _X)
    order = np.argsort(x)
    x, y = x[order], y[order]
    gaps = np.zeros(max(0, x.size - 1), dtype=bool)
    hinges = [
        key for key in some[0] if key.startswith("hinges_") and key.endswith("_angle")
    ]
    if hinges and x.size > 1:
        steps = np.max(
            np.abs(
                np.diff(np.array([column(some, key)[order] for key in hinges]), axis=1)
            ),
            axis=0,
        )
        gaps |= (steps > 0.02) & (
            steps > 4.0 * np.nanmedian(steps)
        )  # rad; below it is the same hinge
    if x.size > 2:
        widths = np.diff(x)
        gaps |= widths > 1.5 * np.median(widths)
    at = np.flatnonzero(gaps) + 1
    return np.insert(x, at, np.nan), np.insert(y, at, np.nan)


def _valued(heading: str, value: str) -> str:
    """Return a heading and a value as text: `height = 8 m`."""
    key, _, unit = heading.partition(" [")
    return (
        f"{key.removeprefix(VARIED).replace('_', ' ')} = {float(value):.4g}"
        f" {unit.removesuffix(']')}".rstrip()
    )

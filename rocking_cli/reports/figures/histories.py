"""Responses in time: the rotation with its events above the motion of the ground."""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...dynamics.outcome import Outcome
from ...errors import UsageError
from ..rows import Rows, column, groups
from ..units import Units
from .canvas import (
    DASHES,
    SOURCE,
    Axes,
    Figure,
    column_in,
    heading,
    label,
    legend,
    line_style,
    literal,
)

if TYPE_CHECKING:
    from ...responses.identification.trace import Trace

_LEAST = 1e-9  # |theta|/alpha of a body that is off the ground
_AFTER = 0.1  # of the shown motion: the rest that is shown behind it
_NEAR = 0.3  # of alpha: a response that reaches it is drawn between lines at alpha


def response(
    figure: Figure, rows: Rows, units: Units, align: bool = False
) -> list[Axes]:
    """Draw the rotation for each file and equation with its events and alpha, below it
    the forces if there are any, and the ground acceleration.

    align: the time of each file counts from its largest rotation, or from theta = alpha
    if the body overturns.
    """
    x, ground = ("t", "ground_acceleration") if "t" in rows[0] else ("tau", "A")
    forces = [
        c
        for c in rows[0]
        if c.startswith(("fx_ratio", "fz_ratio")) and not c.endswith("_after")
    ]
    moves = bool(np.any(column(rows, ground)))  # not in free rocking
    ratios = [3, *([1.5] if forces else []), *([1] if moves else [])]
    axes, *others = figure.subplots(
        len(ratios), 1, sharex=True, height_ratios=ratios, squeeze=False
    ).ravel()
    files = rotations(axes, rows, units, align)
    for i, (times, some) in enumerate(files if moves else ()):
        others[-1].plot(
            *with_jumps(times, column_in(some, ground, units)),
            color="0.3" if len(files) == 1 else f"C{i}",
            lw=1.0,
        )
    if moves:
        others[-1].set_ylabel(label(ground if x == "t" else "A_s", units))
    drawn = [axes, *others]
    drawn[-1].set_xlabel(label(x, units) + ", 0 at the largest rotation" * align)
    if forces:
        _plot_forces(others[0], rows, column_in(rows, x, units), forces, units)
    last = max(_end_of_motion(times, some, ground) for times, some in files)
    begin, end = axes.get_xlim()
    axes.set_xlim(right=min(end, last + _AFTER * (last - begin)))
    return drawn


def _end_of_motion(times: np.ndarray, rows: Rows, ground: str) -> float:
    """Return the time from which body and ground are at rest."""
    keys = [key for key in rows[0] if key == ground or key.startswith("theta")]
    moving = [np.flatnonzero(np.abs(column(rows, key)) > _LEAST) for key in keys]
    last = max((int(at[-1]) for at in moving if at.size), default=-1)
    return float(times[max(last, 0)])


def rotations(
    axes: Axes, rows: Rows, units: Units, align: bool = False
) -> list[tuple[np.ndarray, Rows]]:
    """Draw the rotation for each file and equation, with its events and alpha; return
    (times, rows) of each file.
    """
    x, y = ("t", "theta") if "t" in rows[0] else ("tau", "theta_ratio")
    files = groups(rows, SOURCE)
    found = []
    for i, (source, some) in enumerate(files.items()):
        colour = None if len(files) == 1 else f"C{i}"
        times = _times(some, x, units, align)
        _plot_rotations(axes, some, times, y, units, source, colour)
        for name in _rotations(some, y):
            _mark_events(axes, some, times, name, colour)
        found.append((times, some))
    _show_alpha(axes, rows, y, units)
    if len(files) == 1 and len(names := _rotations(rows, y)) == 1:
        _say_peak(axes, rows, _times(rows, x, units, align), names[0], units)
    axes.set(
        ylabel=label(y, units),
        title=heading(rows, units, "structure", "motion", "model"),
    )
    legend(axes)
    return found


def measured(axes: Axes, trace: "Trace", units: Units) -> None:
    """Draw a measured rotation over a response. Raises UsageError for another
    quantity.
    """
    if trace.quantity != "theta":
        raise UsageError(
            f"{trace.name}: found {trace.quantity}; expected the rotation, theta"
        )
    _, factor = units.heading("theta")
    name = literal(f"{trace.name}, measured")
    axes.plot(trace.t, trace.y / factor, color="0.2", lw=0.8, ls=":", label=name)
    whole: Any = axes.figure
    for old in list(whole.legends):  # that of the response alone
        old.remove()
    legend(axes)


def response_axes(axes: Axes, rows: Rows, units: Units, align: bool = False) -> Axes:
    """Draw the rotation alone into Axes, and return them."""
    rotations(axes, rows, units, align)
    time = label("t" if "t" in rows[0] else "tau", units)
    axes.set_xlabel(time + ", 0 at the largest rotation" * align)
    return axes


def _times(rows: Rows, x: str, units: Units, align: bool) -> np.ndarray:
    """Return the times of a response, with `align` from its largest rotation."""
    times = column_in(rows, x, units)
    if align:
        ratio = column(rows, next(c for c in rows[0] if c.startswith("theta_ratio")))
        times -= times[np.argmax(np.minimum(np.abs(ratio), 1.0))]
    return times


def _plot_rotations(
    axes: Axes,
    rows: Rows,
    times: np.ndarray,
    y: str,
    units: Units,
    source: Sequence[str],
    colour: str | None,
) -> None:
    """Draw the rotation by each equation. source: the name of the file, where several
    are drawn; colour: of all its lines, None for one of each equation.
    """
    for i, name in enumerate(_rotations(rows, y)):
        model = name.removeprefix(y).strip("_")
        words = [*map(literal, source), *([f"{model} equation"] if model else [])]
        style = line_style(i) if colour is None else {"color": colour, "ls": DASHES[i]}
        axes.plot(
            times,
            column_in(rows, name, units),
            label=", ".join(words) or "response",
            **style,
        )


def _rotations(rows: Rows, y: str) -> list[str]:
    """Return the columns of the rotation; y: their name without the equation."""
    return [c for c in rows[0] if re.fullmatch(f"{y}(_linear|_nonlinear)?", c)]


def _beside(name: str, other: str = "theta_ratio") -> str:
    """Return the column of theta/alpha, or another one, of the same equation as a
    column of the rotation.
    """
    return re.sub("^theta(_ratio)?", other, name)


def _mark_events(
    axes: Axes, rows: Rows, times: np.ndarray, name: str, colour: str | None
) -> None:
    """Mark uplifts, impacts and the fall of one response; name: the column of its
    rotation. Does nothing without theta/alpha.
    """
    if _beside(name) not in rows[0]:
        return
    ratio = column(rows, _beside(name))
    up = np.abs(ratio) > _LEAST
    lifts = np.flatnonzero(up[1:] & ~up[:-1])
    known = axes.get_legend_handles_labels()[1]

    def mark(x: np.ndarray, y: np.ndarray, marker: str, words: str) -> None:
        if x.size:
            shown = "_" if words in known else words
            given: dict[str, Any] = {
                "marker": marker,
                "s": 22.0,
                "label": shown,
                "zorder": 3.0,
            }
            axes.scatter(x, y, color=colour or "0.25", lw=0.9, **given)

    impacts = _impacts(times, ratio)
    # a bounce begins where the one before ends
    close = np.abs(times[lifts][:, None] - impacts) <= 1e-9 * np.ptp(times)
    begins = lifts[~close.any(axis=1)]
    mark(times[begins], np.zeros(begins.size), "^", "uplift")
    mark(impacts, np.zeros(impacts.size), "|", "impact")
    outcome = rows[0].get(_beside(name, "outcome"))
    if any(one.flag == outcome and one.overturned for one in Outcome):
        mark(times[-1:], np.asarray(axes.lines[-1].get_ydata())[-1:], "X", "falls")


def _impacts(times: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Return the times at which theta/alpha passes or reaches zero."""
    side = np.where(np.abs(ratio) > _LEAST, np.sign(ratio), 0.0)
    reaches = np.flatnonzero((side[1:] == 0.0) & (side[:-1] != 0.0)) + 1
    passes = np.flatnonzero(side[1:] * side[:-1] < 0.0)
    share = ratio[passes] / (ratio[passes] - ratio[passes + 1])
    between = times[passes] + share * (times[passes + 1] - times[passes])
    return np.sort(np.concatenate([times[reaches], between]))


def _alphas(rows: Rows, name: str, units: Units) -> tuple[float, float] | None:
    """Return alpha on the right and the left side in the unit of the rotation, None if
    the body does not rock.
    """
    theta, ratio = column_in(rows, name, units), column(rows, _beside(name))
    found = {}
    for side in (1.0, -1.0):
        i = int(np.argmax(np.nan_to_num(side * ratio)))
        if side * ratio[i] > 0.0:
            found[side] = float(theta[i] / ratio[i])
    if not found:
        return None
    right, left = (found.get(side) or found[-side] for side in (1.0, -1.0))
    return right, left


def _show_alpha(axes: Axes, rows: Rows, y: str, units: Units) -> None:
    """Draw lines at plus and minus alpha if the response comes near, and an axis of
    theta/alpha on the right.
    """
    name = _rotations(rows, y)[0]
    if _beside(name) not in rows[0]:
        return
    alphas = _alphas(rows, name, units)
    if alphas is None:
        return
    right, left = alphas
    if np.nanmax(np.abs(column(rows, _beside(name)))) >= _NEAR:
        across = axes.get_yaxis_transform()
        style: dict[str, Any] = {"colors": "#CC79A7", "ls": "--", "lw": 0.9}
        words = r"$\pm\alpha$"
        axes.hlines([right, -left], 0.0, 1.0, transform=across, label=words, **style)
    if name.startswith("theta_ratio"):
        return

    def ratio_of(theta: Any) -> Any:
        return np.where(theta > 0.0, theta / right, theta / left)

    def theta_of(ratio: Any) -> Any:
        return np.where(ratio > 0.0, ratio * right, ratio * left)

    over = axes.secondary_yaxis("right", functions=(ratio_of, theta_of))
    over.set_ylabel(label("theta_ratio", units))


def _say_peak(
    axes: Axes, rows: Rows, times: np.ndarray, name: str, units: Units
) -> None:
    """Write the largest rotation of a body that stands beside it, over alpha and as the
    displacement of its top [mm].
    """
    outcome = rows[0].get(_beside(name, "outcome"))
    if not any(one.flag == outcome and one.safe for one in Outcome):
        return
    ratio, theta = column(rows, _beside(name)), column_in(rows, name, units)
    i = int(np.argmax(np.abs(ratio)))
    words = rf"{abs(ratio[i]):.3g} $\alpha$"
    if "top_displacement" in rows[0]:
        top = float(np.max(np.abs(column(rows, "top_displacement"))))
        words += f", top {1e3 * top:.3g} mm"
    axes.annotate(
        words,
        (times[i], theta[i]),
        xytext=(8, 0),
        textcoords="offset points",
        va="center",
        fontsize="small",
    )


def _plot_forces(
    axes: Axes, rows: Rows, times: np.ndarray, names: Sequence[str], units: Units
) -> None:
    """Draw the forces on the ground; names: their columns, Fx and Fz by each
    equation.
    """
    for i, name in enumerate(names):
        axes.plot(
            *with_jumps(times, column_in(rows, name, units)),
            label=f"$F_{name[1]}/mg$" if i < 2 else "_",
            color="C2" if name[1] == "x" else "C3",
            ls=DASHES[i // 2],  # an equation has its dash of above
        )
    axes.set_ylabel("$F/mg$ [-]")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))


def with_jumps(t: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the samples with one more point at each jump, a step eight times larger
    than its neighbours: the line is vertical there.
    """
    step = np.abs(np.diff(a, prepend=a[:1], append=a[-1:]))
    neighbour = np.maximum(step[:-2], step[2:]) if a.size > 1 else np.zeros(0)
    jumps = (
        np.flatnonzero(
            (step[1:-1] > 8.0 * neighbour)
            & (step[1:-1] > 0.05 * np.nanmax(np.abs(a), initial=0.0))
        )
        + 1
    )
    return np.insert(t, jumps, t[jumps]), np.insert(a, jumps, a[jumps - 1])

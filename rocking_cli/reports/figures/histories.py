"""Time histories: one response above its ground motion, and responses of several structures compared (Fig. 8)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..rows import Rows, column, groups
from ..units import Units
from .canvas import legend, literal, look
from .labels import label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_JUMP = 8.0  # a step so many times larger than its neighbours is a jump of the motion


def response(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the rotation (a line for each equation), below it the forces if the rows have any, and the ground acceleration."""
    x, y, ground = ("t", "theta", "ground_acceleration") if "t" in rows[0] else ("tau", "theta_ratio", "A")
    pushes = [c for c in rows[0] if c.startswith(("fx_ratio", "fz_ratio")) and not c.endswith("_after")]
    ratios = [3, *([1.5] if pushes else []), 1]
    axes, *between, below = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
    drawn = [c for c in rows[0] if c == y or (c.startswith(f"{y}_") and not c.startswith((f"{y}_dot", f"{y}_rate")))]
    for i, name in enumerate(drawn):
        model = name.removeprefix(y).strip("_")
        axes.plot(_in(rows, x, units), _in(rows, name, units), label=f"{model} equation" if model else "response", **look(i))
    axes.set_ylabel(label(y, units))
    legend(axes)
    below.plot(*with_jumps(_in(rows, x, units), _in(rows, ground, units)), color="0.3", lw=1.0)
    below.set(xlabel=label(x, units), ylabel=label("ground_acceleration" if x == "t" else "A_s", units))
    for one in between:
        for i, name in enumerate(pushes):
            word, model = name[:2], name[len("fx_ratio") :].strip("_")
            text = f"$F_{word[1]}/mg$" + (f", {model} equation" if model else "")
            one.plot(*with_jumps(_in(rows, x, units), _in(rows, name, units)), label=text, **look(i))
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
    for i, (key, some) in enumerate(groups(rows, "structure", "model").items()):
        style = {**look(i), "lw": 2.4 - 0.5 * min(i, 3), "label": literal(", ".join(key))}
        axes[0].plot(_in(some, "t", units), _in(some, "theta", units), **style)
        axes[1].plot(_in(some, "tau", units), _in(some, "theta_ratio", units), **style)
    axes[0].set(xlabel=label("t", units), ylabel=label("theta", units))
    axes[1].set(xlabel=label("tau", units), ylabel=label("theta_ratio", units))
    legend(axes[0])
    return axes


def _in(rows: Rows, name: str, units: Units) -> np.ndarray:
    return column(rows, name) / units.column(name)[2]

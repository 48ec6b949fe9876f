"""The scan of `rocking solve`: capacity over demand at each value of a key."""

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any

import numpy as np

from .canvas import MARKERS, Figure, legend, line_style, literal

_BESIDE: dict[str, Any] = {"textcoords": "offset points", "fontsize": "small"}


def capacities_over(
    figure: Figure,
    scans: Mapping[str, Sequence[tuple[float, float]]],
    ends: Sequence[float],
    words: tuple[str, str],
    margin: float,
) -> None:
    """Draw capacity over demand over the values of a key, a line for each structure,
    and the required margin.

    scans: (value, capacity over demand) by structure, at most twice the margin; ends:
    the boundaries; words: label of the values, and title.
    """
    axes = figure.add_subplot()
    for i, (name, points) in enumerate(scans.items()):
        x, y = np.array(sorted(points)).T
        marker = MARKERS[i % len(MARKERS)]
        axes.plot(x, y, marker=marker, ms=3, label=literal(name), **line_style(i))
    axes.axhline(margin, color="0.4", ls="--", label=f"required: {margin:g}")
    for end in ends:
        axes.axvline(end, color="0.4", lw=0.8, ls=":")
        axes.annotate(f"{end:.4g}", (end, 0.0), xytext=(3, 3), **_BESIDE)
    axes.set(xlabel=words[0], ylabel="capacity over demand [-]")
    axes.set_title(fill(literal(words[1]), 72))
    axes.set_ylim(0.0, min(2.0 * margin, axes.get_ylim()[1]))
    legend(axes)

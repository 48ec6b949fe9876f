"""A response in motion: the body and its ground as a GIF in real time."""

import io
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...documents.document import Document
from ...errors import UsageError
from ...plugins import require
from ...publishing import check_target, published
from ...structures import build_structure
from ...structures.kinds import sketch_of
from ...structures.sketch import Outline, Sketch, turned
from ..rows import Rows, column
from .canvas import DRAWN_WITH, Look, styled
from .drawing import GROUND, INK, STONE
from .phase import block_of, scaled

FORMATS = (".gif",)
_FRAMES = 25  # a second
_LONGEST = 60.0  # s


def animate(
    rows: Rows,
    target: str | Path,
    body: Document | None = None,
    *,
    look: Look | None = None,
    overwrite: bool = True,
    tell: Callable[[str], None] | None = None,
) -> None:
    """Write the response in `rows`, those of `rocking response --csv`, as a GIF in real
    time.

    body: None for the block with the p and alpha of the response. The ground moves by
    the double integral of its acceleration. Raises UsageError for a target that cannot
    be written and if the rows have no times or no rocking body, and OutputError.
    """
    check_target(Path(target), overwrite, FORMATS)
    require(*DRAWN_WITH)
    from scipy.integrate import cumulative_trapezoid

    if not {"t", "ground_acceleration"} <= set(rows[0]):
        raise UsageError(
            "an animation is in real time; found no columns t and ground_acceleration;"
            " expected a response with units"
        )
    t, suffix = column(rows, "t"), "" if "theta" in rows[0] else "_nonlinear"
    try:
        theta, ratio, alpha, p = scaled(rows, suffix)
    except (KeyError, ValueError) as error:
        raise UsageError(
            "an animation needs a response that rocks, with the columns tau and"
            f" theta_ratio: {error}"
        ) from None
    body = block_of(float(alpha.max()), p) if body is None else body
    sketch = sketch_of(body, build_structure(body))
    if t[-1] > _LONGEST and tell is not None:
        tell(f"{target}: found {t[-1]:.4g} s; the first {_LONGEST:g} s are shown")
    times = np.arange(0.0, min(float(t[-1]), _LONGEST), 1.0 / _FRAMES)
    turn, lean = np.interp(times, t, theta), np.interp(times, t, ratio)
    integral = partial(cumulative_trapezoid, x=t, initial=0.0)
    ground = np.interp(
        times, t, integral(integral(column(rows, "ground_acceleration")))
    )
    corners = np.concatenate(
        [
            np.array(outline)
            for outline in (*sketch.bodies, *sketch.still, *sketch.moved)
        ]
    )
    (left, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
    reach = 0.4 * (high - low)
    look, frames = look or Look(), []
    with styled(look) as figure:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.collections import PolyCollection
        from PIL import Image

        axes = figure.add_subplot(aspect="equal", xlabel="$x$ [m]", ylabel="$z$ [m]")
        axes.set(
            xlim=(left + ground.min() - reach, right + ground.max() + reach),
            ylim=(low - 0.1 * reach, high + 0.3 * reach),
            title=" ",
        )
        axes.grid(visible=False)
        stone, still = (
            PolyCollection([], facecolors=face, edgecolors=INK, linewidths=0.9)
            for face in (STONE, GROUND)
        )
        axes.add_collection(stone)
        axes.add_collection(still)
        (floor,) = axes.plot([], [], color=INK, lw=1.2, marker="|", ms=6.0)
        ticks = np.linspace(left - reach, right + reach, 12)
        clock = axes.text(0.02, 0.97, "", transform=axes.transAxes, va="top")
        figure.set_size_inches(
            5.6,
            0.9
            + 5.0
            * min(
                1.5, float(np.diff(axes.get_ylim())[0] / np.diff(axes.get_xlim())[0])
            ),
        )
        look.finish(figure)
        figure.set_dpi(look.dpi or 100.0)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        figure.set_layout_engine("none")  # what stays needs no new layout in each frame
        for now, angle, share, x in zip(times, turn, lean, ground, strict=True):
            posed = sketch.pose(float(angle)) if sketch.pose else None
            moving, staying = posed or (
                shape_at(sketch, float(angle), float(share)),
                list(sketch.still),
            )
            stone.set_verts([np.add(outline, (x, 0.0)) for outline in moving])
            still.set_verts([np.add(outline, (x, 0.0)) for outline in staying])
            floor.set_data(ticks + x, np.full(ticks.size, low))
            clock.set_text(f"{now:.1f} s")
            canvas.draw()
            frames.append(
                Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())
            )
    drawn = io.BytesIO()
    frames[0].save(
        drawn,
        format="gif",
        save_all=True,
        append_images=frames[1:],
        duration=1000 // _FRAMES,
        loop=0,
    )
    with published(Path(target), overwrite) as file:
        file.write(drawn.getvalue())


def shape_at(sketch: Sketch, angle: float, share: float) -> list[Outline]:
    """Return the outlines of the bodies at theta = `angle` = `share` alpha; a linkage
    is interpolated between rest and alpha.
    """
    if sketch.centre is not None:
        about = dict(sketch.pivots)["right" if angle > 0.0 else "left"]
        return [turned(outline, about, angle) for outline in sketch.bodies]
    sign = -1.0 if share < 0.0 else 1.0  # the mirror image of the mechanism
    mixed = [
        np.array(a) + abs(share) * (np.array(b) - np.array(a))
        for a, b in zip(sketch.bodies, sketch.moved, strict=True)
    ]
    return [tuple((sign * x, z) for x, z in outline.tolist()) for outline in mixed]

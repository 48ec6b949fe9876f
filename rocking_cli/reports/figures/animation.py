"""A response in motion: the body and its ground as a GIF in real time."""

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np

from ...documents.document import Document
from ...documents.quantities import DEFAULT_GRAVITY
from ...dynamics.outcome import Outcome
from ...errors import UsageError
from ...plugins import require
from ...publishing import check_target, published
from ...structures import build_structure
from ...structures.kinds import sketch_of
from ...structures.sketch import Outline, Sketch, turned
from ..rows import Rows, column
from .canvas import DRAWN_WITH, FIGURE_UNITS, Axes, Figure, Look, heading, styled
from .drawing import ACCENT, GROUND, INK, STONE
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
    if not {"t", "ground_acceleration"} <= set(rows[0]):
        raise UsageError(
            "an animation is in real time; found no columns t and ground_acceleration;"
            " expected a response with units"
        )
    try:
        response = scaled(rows, "" if "theta" in rows[0] else "_nonlinear")
    except (KeyError, ValueError) as error:
        raise UsageError(
            "an animation needs a response that rocks, with the columns tau and"
            f" theta_ratio: {error}"
        ) from None
    theta, ratio, alpha, p = response
    body = block_of(float(alpha.max()), p) if body is None else body
    sketch = sketch_of(body, build_structure(body))
    end = float(column(rows, "t")[-1])
    if end > _LONGEST and tell is not None:
        tell(f"{target}: found {end:.4g} s; the first {_LONGEST:g} s are shown")
    course = _course(rows, theta, ratio)
    words = heading(rows, FIGURE_UNITS, "structure", "motion", "model")
    frames = _frames(sketch, course, words, look or Look())
    with published(Path(target), overwrite) as file:
        file.write(_as_gif(frames))


class Track(NamedTuple):
    """A response at the times of the frames."""

    times: np.ndarray  # [s], (n,)
    theta: np.ndarray  # [rad], (n,)
    ratio: np.ndarray  # theta/alpha [-], (n,)
    ground: np.ndarray  # displacement of the ground [m], (n,)
    acceleration: np.ndarray  # of the ground [m/s2], (n,)
    falls: bool  # True if the body overturns by the end of the rows


def _course(rows: Rows, theta: np.ndarray, ratio: np.ndarray) -> Track:
    """Return the response at the times of the frames; theta [rad], ratio: theta/alpha,
    of each row.
    """
    t = column(rows, "t")
    acceleration = column(rows, "ground_acceleration")
    displacement = _integral(_integral(acceleration, t), t)
    times = np.arange(0.0, min(float(t[-1]), _LONGEST), 1.0 / _FRAMES)
    theta, ratio, displacement, acceleration = (
        np.interp(times, t, x) for x in (theta, ratio, displacement, acceleration)
    )
    outcomes = [rows[0].get(f"outcome{suffix}") for suffix in ("", "_nonlinear")]
    falls = any(one.overturned and one.flag in outcomes for one in Outcome)
    return Track(times, theta, ratio, displacement, acceleration, falls)


def _integral(y: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the integral of y over t from the first time on, by the trapezoidal
    rule.
    """
    areas = 0.5 * (y[1:] + y[:-1]) * np.diff(t)
    return np.concatenate([[0.0], np.cumsum(areas)])


def _frames(sketch: Sketch, course: Track, words: str, look: Look) -> list[Any]:
    """Return an image for each time of the course; words: the title.

    What stands still is drawn once; in each frame what moves is drawn on top of it.
    """
    frames: list[Any] = []
    with styled(look) as figure:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from PIL import Image

        stage = _Stage(figure, sketch, course, words)
        look.finish(figure)
        figure.set_dpi(look.dpi or 100.0)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        still = canvas.copy_from_bbox(figure.bbox)
        colours = None
        for i in range(course.times.size):
            stage.show(i)
            canvas.restore_region(still)
            for artist in stage.moving:
                figure.draw_artist(artist)
            size = canvas.get_width_height()
            frame = Image.frombytes("RGBA", size, canvas.buffer_rgba()).convert("RGB")
            # one palette: the frames have the same colours
            colours = colours or frame.quantize(256)
            frames.append(frame.quantize(palette=colours, dither=Image.Dither.NONE))
    return frames


class _Stage:
    """The axes of an animation and what moves on them."""

    def __init__(
        self, figure: Figure, sketch: Sketch, course: Track, words: str
    ) -> None:
        """The axes have room for every displacement of the ground."""
        from matplotlib.collections import PolyCollection

        self.sketch, self.course = sketch, course
        axes, below = figure.subplots(2, 1, height_ratios=(5.0, 1.0))
        left, right, self.low, reach = _set_room(axes, sketch, course.ground)
        axes.set_title(fill(words, 60), fontsize="small")
        self.stone, self.still = (
            PolyCollection([], facecolors=face, edgecolors=INK, linewidths=0.9)
            for face in (STONE, GROUND)
        )
        if sketch.gyration:  # its circle is no outline
            self.stone.set(facecolor="none", linestyles="--")
        axes.add_collection(self.stone)
        axes.add_collection(self.still)
        (self.floor,) = axes.plot([], [], color=INK, lw=1.2, marker="|", ms=6.0)
        self.ticks = np.linspace(left - reach, right + reach, 12)  # of the floor
        self.clock = axes.text(0.02, 0.97, "", transform=axes.transAxes, va="top")
        self.trace = course.acceleration / DEFAULT_GRAVITY
        below.plot(course.times, self.trace, color="0.3", lw=0.9)
        below.set(xlabel="time [s]", ylabel=r"$\ddot{x}_g$ [g]")
        (self.now,) = below.plot([], [], "o", color=ACCENT, ms=5.0)
        self.moving = (self.still, self.stone, self.floor, self.clock, self.now)
        for artist in self.moving:
            artist.set_animated(True)
        shape = float(np.diff(axes.get_ylim())[0] / np.diff(axes.get_xlim())[0])
        figure.set_size_inches(5.6, 2.2 + 5.0 * min(1.5, shape))

    def show(self, frame: int) -> None:
        """Show the body, the ground and its acceleration at a time of the course."""
        course = self.course
        time, theta, ratio, x = (
            float(values[frame])
            for values in (course.times, course.theta, course.ratio, course.ground)
        )
        posed = self.sketch.pose(theta) if self.sketch.pose else None
        moving, staying = posed or (
            shape_at(self.sketch, theta, ratio),
            list(self.sketch.still),
        )
        self.stone.set_verts([np.add(outline, (x, 0.0)) for outline in moving])
        self.still.set_verts([np.add(outline, (x, 0.0)) for outline in staying])
        self.floor.set_data(self.ticks + x, np.full(self.ticks.size, self.low))
        falling = course.falls and bool(np.all(np.abs(course.ratio[frame:]) >= 1.0))
        self.clock.set_text(f"{time:.1f} s" + ", falls" * falling)
        self.now.set_data([time], [self.trace[frame]])


def _set_room(
    axes: Axes, sketch: Sketch, ground: np.ndarray
) -> tuple[float, float, float, float]:
    """Give the axes room for the sketch on the displaced ground; return (left, right,
    bottom of the sketch, margin beside it [m]).
    """
    outlines = (*sketch.bodies, *sketch.still, *sketch.moved)
    corners = np.concatenate([np.array(outline) for outline in outlines])
    (left, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
    reach = 0.4 * (high - low)
    axes.set(
        aspect="equal",
        xlabel="$x$ [m]",
        ylabel="$z$ [m]",
        xlim=(left + ground.min() - reach, right + ground.max() + reach),
        ylim=(low - 0.1 * reach, high + 0.3 * reach),
    )
    axes.grid(visible=False)
    return left, right, low, reach


def _as_gif(frames: Sequence[Any]) -> bytes:
    """Return the images as one GIF that repeats."""
    drawn = io.BytesIO()
    frames[0].save(
        drawn,
        format="gif",
        save_all=True,
        append_images=frames[1:],
        duration=1000 // _FRAMES,
        loop=0,
    )
    return drawn.getvalue()


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

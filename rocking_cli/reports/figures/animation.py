"""A response in motion: the body and its ground as a GIF in real time."""

import io
from collections.abc import Callable
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
from ...structures.sketch import Sketch
from ..rows import Rows, column
from .canvas import DRAWN_WITH, FIGURE_UNITS, Figure, Look, heading, styled
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
    drawn = io.BytesIO()
    each = 1000 // _FRAMES  # ms
    frames[0].save(
        drawn, "gif", save_all=True, append_images=frames[1:], duration=each, loop=0
    )
    with published(Path(target), overwrite) as file:
        file.write(drawn.getvalue())


class Track(NamedTuple):
    """A response at the times of the frames."""

    times: np.ndarray  # [s], (n,)
    theta: np.ndarray  # [rad], (n,)
    ground: np.ndarray  # displacement of the ground [m], (n,)
    acceleration: np.ndarray  # of the ground [m/s2], (n,)
    fallen: np.ndarray  # True from where the body never comes back to alpha, (n,)


def _course(rows: Rows, theta: np.ndarray, ratio: np.ndarray) -> Track:
    """Return the response at the times of the frames; theta [rad], ratio: theta/alpha,
    of each row.
    """
    from scipy.integrate import cumulative_trapezoid

    t = column(rows, "t")
    acceleration = column(rows, "ground_acceleration")
    velocity = cumulative_trapezoid(acceleration, t, initial=0.0)
    displacement = cumulative_trapezoid(velocity, t, initial=0.0)
    times = np.arange(0.0, min(float(t[-1]), _LONGEST), 1.0 / _FRAMES)
    theta, ratio, displacement, acceleration = (
        np.interp(times, t, x) for x in (theta, ratio, displacement, acceleration)
    )
    outcomes = [rows[0].get(f"outcome{suffix}") for suffix in ("", "_nonlinear")]
    falls = any(one.overturned and one.flag in outcomes for one in Outcome)
    later = np.minimum.accumulate(np.abs(ratio)[::-1])[::-1]  # least from there on
    return Track(times, theta, displacement, acceleration, falls & (later >= 1.0))


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
    """The axes of an animation, with room for every displacement of the ground, and
    what moves on them.
    """

    def __init__(
        self, figure: Figure, sketch: Sketch, course: Track, words: str
    ) -> None:
        from matplotlib.collections import PolyCollection
        from matplotlib.transforms import Affine2D

        self.sketch, self.course, self.shift = sketch, course, Affine2D()
        axes, below = figure.subplots(2, 1, height_ratios=(5.0, 1.0))
        corners = np.concatenate([*sketch.bodies, *sketch.still, *sketch.moved])
        (left, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
        reach = 0.4 * (high - low)
        x = left + course.ground.min() - reach, right + course.ground.max() + reach
        z = low - 0.1 * reach, high + 0.3 * reach
        axes.set(aspect="equal", xlabel="$x$ [m]", ylabel="$z$ [m]", xlim=x, ylim=z)
        axes.grid(visible=False)
        axes.set_title(fill(words, 60), fontsize="small")
        figure.set_size_inches(5.6, 2.2 + 5.0 * min(1.5, np.ptp(z) / np.ptp(x)))
        on_ground: dict[str, Any] = {"transform": self.shift + axes.transData}
        self.stone, self.still = (
            PolyCollection([], fc=face, ec=INK, linewidths=0.9, **on_ground)
            for face in (STONE, GROUND)
        )
        if sketch.gyration:  # its circle is no outline
            self.stone.set(facecolor="none", linestyles="--")
        for parts in (self.stone, self.still):
            axes.add_artist(parts)
        ticks = np.linspace(left - reach, right + reach, 12)
        on_ground |= {"color": INK, "lw": 1.2, "marker": "|", "ms": 6.0}
        (floor,) = axes.plot(ticks, np.full(ticks.size, low), **on_ground)
        self.clock = axes.text(0.02, 0.97, "", transform=axes.transAxes, va="top")
        self.trace = course.acceleration / DEFAULT_GRAVITY
        below.plot(course.times, self.trace, color="0.3", lw=0.9)
        below.set(xlabel="time [s]", ylabel=r"$\ddot{x}_g$ [g]")
        (self.now,) = below.plot([], [], "o", color=ACCENT, ms=5.0)
        self.moving = (self.still, self.stone, floor, self.clock, self.now)
        for artist in self.moving:
            artist.set_animated(True)

    def show(self, frame: int) -> None:
        """Show the body, the ground and its acceleration at a time of the course."""
        course = self.course
        time = float(course.times[frame])
        self.shift.clear().translate(float(course.ground[frame]), 0.0)
        moving, staying = self.sketch.posed(float(course.theta[frame]))
        self.stone.set_verts(moving)
        self.still.set_verts(staying)
        self.clock.set_text(f"{time:.1f} s" + ", falls" * bool(course.fallen[frame]))
        self.now.set_data([time], [self.trace[frame]])

"""The history of a body that slides: its displacement, its speed and the ground."""

from ..rows import Rows
from ..units import Units
from .canvas import Axes, Figure, column_in, heading, label
from .histories import with_jumps


def slide_history(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the displacement over the ground, below it the speed and the ground
    acceleration.
    """
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=[3, 1.5, 1])
    t = column_in(rows, "t", units)
    above.plot(t, column_in(rows, "slide", units))
    friction = f", friction {float(rows[0]['friction']):.4g}"
    title = heading(rows, units, "structure", "motion") + friction
    above.set(ylabel=label("slide", units), title=title)
    middle.plot(t, column_in(rows, "slide_velocity", units), color="C1", lw=1.2)
    middle.set_ylabel(label("slide_velocity", units))
    below.plot(
        *with_jumps(t, column_in(rows, "ground_acceleration", units)), color="0.3"
    )
    below.set(xlabel=label("t", units), ylabel=label("ground_acceleration", units))
    for one in (above, middle):
        one.axhline(0.0, color="0.7", lw=0.8)
    return [above, middle, below]

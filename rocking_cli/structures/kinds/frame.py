"""A frame of free-standing columns that carry a rigid beam (Makris and Vassiliou 2013).

N equal rectangular columns of half diagonal R and slenderness alpha rock together, and
the beam translates with their tops. With gamma = mass of the beam / mass of all
columns, the frame rocks as one block of the same alpha with

    p_hat = p sqrt((1 + 2 gamma)/(1 + 3 gamma))
    eta   = (1 - 3/2 sin^2 alpha + 3 gamma cos 2 alpha)/(1 + 3 gamma)
"""

import math
from functools import partial

from ...documents.document import Document
from ...documents.keys import Key, Keys
from ..mechanics.single_body import RigidBody, equal_edges, radius_and_alpha, sizes
from ..sketch import Sketch, rectangle, turned

REPORTS = ("cap_ratio",)
KEYS = Keys(
    {
        "columns": Key("whole", "their number", least=1, most=1_000_000),
        "cap_ratio": Key(
            "number", "mass of the beam over the mass of all columns", least=0.0
        ),
    },
    ways=(sizes("of one column", "of one column", "half the diagonal of a column"),),
)


def body(document: Document) -> RigidBody:
    """Return the body of a frame. Raises DocumentError. Keys: columns: their number;
    width and height (or radius and alpha) of one column; cap_ratio: gamma. The drawing
    shows up to six columns.
    """
    count, gamma = document.integer("columns"), document.quantity("cap_ratio")
    return _frame(min(count, 6), gamma, *radius_and_alpha(document))


def _frame(
    drawn: int, gamma: float, radius: float, alpha: float, inset: float = 0.0
) -> RigidBody:
    """Return the body of a frame with columns of this half diagonal; inset: that of the
    pivots [m]; drawn: the number of drawn columns.
    """
    edge, height = radius * math.sin(alpha), 2.0 * radius * math.cos(alpha)
    drawing = _drawing(edge, height, inset, drawn)
    inset_by = partial(_frame, drawn, gamma, radius, alpha)
    column = 4.0 / 3.0  # I/(m R^2) of a column about its edge
    if inset:
        arm = math.hypot(edge - inset, 0.5 * height)
        column = 1.0 + (radius / arm) ** 2 / 3.0
        radius, alpha = arm, math.atan2(edge - inset, 0.5 * height)
    # The mass of the beam moves on the diagonal 2 R: it adds 2 gamma to M R and 4 gamma
    # to I/(M R^2).
    inertia = (column + 4.0 * gamma) / (1.0 + 2.0 * gamma)
    beam = 4.0 / column * gamma  # I of the beam over that of the columns
    eta = (1.0 - 2.0 / column * math.sin(alpha) ** 2 + beam * math.cos(2.0 * alpha)) / (
        1.0 + beam
    )
    return equal_edges(
        radius,
        alpha,
        inertia,
        eta=eta,
        whole=False,
        limit="more slender columns",
        foot="a frame, whose columns share the weight of the beam",
        details={"cap_ratio": gamma},
        drawing=drawing,
        inset_by=inset_by,
        crown=height,
        share=(1.0 + 2.0 * gamma) / (1.0 + gamma),
    )


def _drawing(half: float, height: float, inset: float, count: int) -> Sketch:
    """Return a sketch of the columns and the beam, at rest and at alpha."""
    foot, alpha = half - inset, math.atan2(half - inset, 0.5 * height)
    step = max(5.0 * half, 0.6 * height)
    axes = [step * (i - 0.5 * (count - 1)) for i in range(count)]
    columns = [rectangle(x - half, x + half, 0.0, height) for x in axes]
    beam = rectangle(axes[0] - 2.0 * half, axes[-1] + 2.0 * half, height, height * 1.08)
    leaning = [
        turned(column, (x + foot, 0.0), alpha)
        for column, x in zip(columns, axes, strict=True)
    ]
    # the beam rests on it
    (corner,) = turned([(axes[0] - foot, height)], (axes[0] + foot, 0.0), alpha)
    lifted = tuple(
        (x + corner[0] - axes[0] + foot, z + corner[1] - height) for x, z in beam
    )
    pivots = [
        (name, (x + side * foot, 0.0))
        for x in axes
        for name, side in (("left", -1.0), ("right", 1.0))
    ]
    return Sketch(
        bodies=(*columns, beam), moved=(*leaning, lifted), pivots=tuple(pivots)
    )

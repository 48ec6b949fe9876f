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
from ..mechanics.moments import Moments
from ..mechanics.single_body import RigidBody, half_and_height, sizes
from ..sketch import Outline, Sketch, rectangle, turned

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
    return _frame(min(count, 6), gamma, *half_and_height(document))


def _frame(
    drawn: int, gamma: float, half: float, z: float, inset: float = 0.0
) -> RigidBody:
    """Return the body of a frame with columns of this half width and half height [m];
    inset: that of the pivots [m]; drawn: the number of drawn columns.
    """
    edge, central = half - inset, (half**2 + z**2) / 3.0  # I_G/m of a column
    # The mass of the beam moves on the diagonal 2 R: it adds 2 gamma to M R, 4 gamma to
    # I/(M R^2), and 4 gamma cos 2 alpha to the angular momentum after the impact.
    square, turned_back = (edge**2 + z**2, z**2 - edge**2)  # R^2, R^2 cos 2 alpha
    inertia = central + (1.0 + 4.0 * gamma) * square
    kept = central + (1.0 + 4.0 * gamma) * turned_back
    carried = 1.0 + 2.0 * gamma
    return RigidBody(
        moments=Moments.of(1.0, (0.0, z), inertia / carried - square),
        half=edge,
        eta=kept / inertia,
        limit="more slender columns",
        foot="a frame, whose columns share the weight of the beam",
        details={"cap_ratio": gamma},
        drawing=_drawing(half, 2.0 * z, inset, drawn),
        moved=partial(_frame, drawn, gamma, half, z),
        crown=2.0 * z,
        share=carried / (1.0 + gamma),
    )


def _drawing(half: float, height: float, inset: float, count: int) -> Sketch:
    """Return a sketch of the columns and the beam, at rest and at alpha."""
    foot, alpha = half - inset, math.atan2(half - inset, 0.5 * height)
    step = max(5.0 * half, 0.6 * height)
    axes = [step * (i - 0.5 * (count - 1)) for i in range(count)]
    columns = [rectangle(x - half, x + half, 0.0, height) for x in axes]
    beam = rectangle(axes[0] - 2.0 * half, axes[-1] + 2.0 * half, height, height * 1.08)

    def pose(theta: float) -> tuple[list[Outline], list[Outline]]:
        toe = foot if theta > 0.0 else -foot
        leaning = [
            turned(column, (x + toe, 0.0), theta)
            for column, x in zip(columns, axes, strict=True)
        ]
        # the beam rests on it
        (corner,) = turned([(axes[0] - toe, height)], (axes[0] + toe, 0.0), theta)
        lifted = tuple(
            (x + corner[0] - axes[0] + toe, z + corner[1] - height) for x, z in beam
        )
        return [*leaning, lifted], []

    pivots = [
        (name, (x + side * foot, 0.0))
        for x in axes
        for name, side in (("left", -1.0), ("right", 1.0))
    ]
    return Sketch(
        bodies=(*columns, beam),
        moved=tuple(pose(alpha)[0]),
        pivots=tuple(pivots),
        pose=pose,
    )

"""A rigid body with known edges, mass centre and moment of inertia."""

import math

from ...documents.document import Document
from ...documents.keys import Keys, length, positive
from ..mechanics.moments import Moments
from ..mechanics.single_body import RigidBody
from ..mechanics.toe import foot_of
from ..shared_keys import mass_of
from ..sketch import circle, rocker

# largest ratio: moments about the middle between the edges then lose six digits of
# sixteen
_WIDEST = 1000.0
REPORTS = ("direction",)
_MASS = {"mass": positive("mass")}
KEYS = Keys(
    {
        "left": length("horizontal distance from the left edge to the mass centre"),
        "right": length("horizontal distance from the right edge to it"),
        "height": length("of the mass centre"),
    },
    {"length": length("of the base across the rocking, for strength", None)},
    (
        (
            Keys({"gyration": length("its radius about the mass centre")}, _MASS),
            Keys(
                {
                    "inertia": positive("moment of inertia", "about the mass centre"),
                    **_MASS,
                }
            ),
        ),
    ),
)


def body(document: Document) -> RigidBody:
    """Return the rigid body that a document of this kind describes. Raises
    DocumentError. Keys: left, right: horizontal distance from each edge to the mass
    centre; height of the mass centre above the edges; gyration: radius of gyration
    about the mass centre, or inertia about it and mass; mass is optional with gyration.
    length: of its base across the rocking, for `strength`.
    The drawing shows the base, and the circle of the radius of gyration in place of an
    outline.
    """
    left = document.length("left")
    right = document.length("right")
    height = document.length("height")
    half, x, gyration = 0.5 * (left + right), 0.5 * (left - right), _gyration(document)
    reach = math.hypot(min(left, right), height)
    if max(left, right) > _WIDEST * reach:
        far = "left" if left > right else "right"
        wanted = (
            f"up to {_WIDEST:g} times the {reach:g} m from the other edge to the mass"
            " centre"
        )
        raise document.fault(far, f"{max(left, right):g} m", wanted)
    outlines = [circle((0.0, height), gyration), ((-left, 0.0), (right, 0.0))]
    edges = (-left, 0.0), (right, 0.0)
    drawing = rocker(outlines, *edges, (0.0, height), gyration=True)
    return RigidBody(
        moments=Moments.of(1.0, (x, height), gyration**2),
        half=half,
        foot=foot_of(document, left + right, 0.0)[0],
        crown=math.inf,
        limit="a body more slender than this one",
        drawing=drawing,
    )


def _gyration(document: Document) -> float:
    """Return the radius of gyration about the mass centre [m]. Raises DocumentError."""
    if not document.has("inertia"):
        return document.length("gyration")
    inertia = document.quantity("inertia")
    if (mass := mass_of(document)) is None:
        raise document.missing("mass", "the mass [kg] that goes with inertia")
    return math.sqrt(inertia / mass)

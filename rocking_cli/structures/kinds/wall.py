"""A wall that rocks out of its plane: as a block as wide as the wall is thick if its
top is free, or as two bodies that bulge between its base and its top if a floor holds
it there; without openings and without bonded walls.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ..load_keys import Top, loads_of, parameters_of
from ..mechanics.held_wall import HeldWall
from ..mechanics.linkage_drawing import drawn, linkages_of
from ..mechanics.single_body import RigidBody, rectangle_body
from ..mechanics.toe import foot_of
from ..parameters import RockingParameters
from ..shared_keys import DENSITY, RESTRAINTS
from ..sketch import Sketch
from .mechanism import REPORTS as OF_MECHANISM

REPORTS = ("length", "crack_height", *OF_MECHANISM)
SIZES = ("thickness", "height")
KEYS = Keys(
    {
        "thickness": length("of the wall"),
        "height": length("between the floors, or free"),
    },
    {
        "length": length("across the rocking, with a density", None),
        "density": DENSITY,
        "top": Key(
            "choice", "whether a floor holds it", words=("held", "free"), default="free"
        ),
        "crack_height": Key(
            "length",
            "of a wall whose top is held",
            above=0.0,
            words=("auto",),
        ),
    },
)
_LESS = 1e-6  # of lambda: a smaller difference is not told


def body(document: Document) -> "RigidBody | WallBetweenFloors":
    """Return a wall from thickness, height, and length; density and length give its
    mass. top: held makes it a wall between two floors. Raises DocumentError.
    """
    thickness, height = document.length("thickness"), document.length("height")
    across = document.optional("length")
    details = {} if across is None else {"length": across}
    foot, mass = foot_of(document, thickness, thickness * height)
    details |= mass
    if document.choice("top") == "held":
        return WallBetweenFloors(thickness, height, details)
    if document.has("crack_height"):
        raise document.fault(
            "crack_height",
            "crack_height of a wall whose top is free, which turns about its base",
            "top: held, or no crack_height",
        )
    limit = "a wall thinner than 1.414 times its height"
    return rectangle_body(
        thickness,
        height,
        limit=limit,
        details=details,
        foot=foot,
    )


@dataclass(frozen=True)
class WallBetweenFloors:
    """A wall whose top is held, as its document describes it."""

    thickness: float  # [m]
    height: float  # [m]
    details: Mapping[str, Any]  # see `RockingParameters`

    def parameters(self, document: Document, name: str) -> RockingParameters:
        """Return the parameters, with the crack of the least lambda unless
        `crack_height` states it. Raises DocumentError.
        """
        for key in ("inset", "strength", "youngs_modulus", *RESTRAINTS):
            if document.has(key):
                raise document.fault(
                    key,
                    f"{key} of a wall whose top is held",
                    f"no {key}, or top: free",
                )
        mass = document.optional("mass") or self.details.get("mass")
        if mass is None:
            raise document.missing("mass", "mass, or density and length")
        wall = self._wall(document, mass)
        crack, least, remark = self._crack(document, wall)
        mechanism = wall.mechanism(crack, not _stated(document))
        found = parameters_of(document, mechanism, name, "wall")
        details = {
            **self.details,
            "mass": mass,
            "crack_height": crack,
            **found.details,
        }
        if least is None:
            details.pop("lambda_governing", None)
        else:
            details["lambda_governing"] = min(least[1], found.uplift)
            if least[1] < found.uplift * (1.0 - _LESS):
                remark = (
                    f"it moves from {least[1]:.3g} g on, in another mechanism (a crack"
                    f" at {least[0]:.3g} m); lambda = {found.uplift:.3g} is that of the"
                    " crack given."
                )
        remarks = (*found.remarks, *([f"{name}: {remark}"] if remark else []))
        return replace(found, details=details, remarks=remarks)

    def sketch(self, document: Document, built: RockingParameters) -> Sketch:
        """Return the wall at rest and as it bulges at alpha."""
        return drawn(built, *linkages_of(built), axis=0.0, slides="held")

    def _wall(self, document: Document, mass: float) -> HeldWall:
        """The wall with its loads. Far is the face about which no part turns at the
        crack.
        """
        half = 0.5 * self.thickness
        right, left = loads_of(document, Top((half, -half), self.height), 0.0)
        for i, load in enumerate(right):
            x, z = load.at
            if not (abs(x) <= half and 0.0 <= z <= self.height):
                raise document.fault(
                    "loads",
                    f"loads.{i} at [{x:g}, {z:g}] m",
                    f"a load on the wall, with x from {-half:g} to {half:g} m and z"
                    f" from 0 to {self.height:g} m",
                )
        sides = {1.0: right} if document.flag("one_sided") else {1.0: right, -1.0: left}
        return HeldWall(self.thickness, self.height, mass, sides)

    def _crack(
        self, document: Document, wall: HeldWall
    ) -> tuple[float, tuple[float, float, bool] | None, str]:
        """(height of the crack [m], that of the least lambda as `weakest_crack`, None
        where no range of heights is searched, a remark on a search that ends on a bound
        of its range). Raises DocumentError.
        """
        on_top = all(load.at[1] == self.height for load in wall.loads[1.0])
        least = wall.weakest_crack() if on_top else None
        if _stated(document):
            where = f"a length between 0 and the height, {self.height:g} m; or auto"
            crack = document.quantity(
                "crack_height", "length", above=0.0, below=self.height, where=where
            )
            return crack, least, ""
        if not on_top:
            raise document.missing(
                "crack_height",
                "its height: it is searched only for loads on the top, at z ="
                f" {self.height:g} m",
            )
        if least is None:
            raise document.fault(
                "thickness",
                f"{self.thickness:g} m, above 3/4 of the height",
                "a thinner wall: a crack is searched between height/4 and height -"
                " thickness; or crack_height",
            )
        crack, _, bound = least
        lowest = crack < 0.5 * self.height
        where = "a quarter of the height" if lowest else "height - thickness"
        remark = (
            f"the search for crack_height ends on its bound, {crack:.4g} m ({where}):"
            " lambda still falls there; state crack_height where the wall can crack."
        )
        return crack, least, remark if bound else ""


def _stated(document: Document) -> bool:
    """True if the document states the height of the crack."""
    return (
        document.has("crack_height")
        and document.values["crack_height"].content != "auto"
    )

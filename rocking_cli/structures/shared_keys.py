"""Keys that documents of several kinds share: their tables, and their readers."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from ..documents.keys import Key, Keys, Usual, in_units, positive
from ..documents.quantities import DEFAULT_GRAVITY
from .building_modes import MODE
from .mechanics.moments import INERTIAS
from .parameters import MOST_DAMPING
from .restraints import SIDES

if TYPE_CHECKING:
    from ..documents.document import Document

RESTRAINTS = ("ties", "tendon", "dampers")
BEARINGS = ("far", "centre", "near")
DENSITY = positive(
    "density",
    "of the material, instead of mass",
    # kN/m3 are weights
    usual=Usual(
        100.0,
        11500.0,
        {**in_units("t/m3"), "kN/m3": (1e3 / DEFAULT_GRAVITY).__mul__},
    ),
)


def _tangent(degrees: float) -> float:
    return math.tan(math.radians(degrees))


_COEFFICIENT = positive(
    "number",
    where="a positive number (a coefficient of friction)",
    usual=Usual(
        0.0,
        2.0,
        {"%": (0.01).__mul__, "deg (its tangent)": _tangent},
    ),
)
_FRICTION = Keys({"static": _COEFFICIENT, "kinetic": _COEFFICIENT})
# of every kind
SHARED = Keys(
    {"kind": Key("any", "of structure")},
    {
        "name": Key("text", "of the structure"),
        "restitution": Key(
            "number",
            "angular speed after over before an impact; from momentum when absent",
            words=("auto",),
        ),
        "gravity": Key(
            "acceleration",
            "of the place",
            least=1e-2,
            most=1e4,
            default=DEFAULT_GRAVITY,
            # from the Moon to Jupiter
            usual=Usual(1.5, 24.9, in_units("ft/s2", "in/s2", "cm/s2", "g")),
        ),
        "damping": Key(
            "number", "viscous, zeta", least=0.0, below=MOST_DAMPING, default=0.0
        ),
        "friction": replace(
            _COEFFICIENT,
            doc="of the base or the joints: a number, or {static: 0.35, kinetic: 0.3}",
            inner=_FRICTION,
        ),
        "building": Key(
            "parts",
            "modes of the building on whose floor it stands; see rocking help base",
            inner=MODE,
        ),
        "labels": Key("any", "texts by name, which are not used"),
    },
)
_STIFFNESS = (
    Keys({"stiffness": Key("stiffness", least=0.0)}),
    Keys(
        {
            "length": positive("length"),
            "area": positive("area"),
            "modulus": positive("stress"),
        }
    ),
)
_PRESTRESS = Key("force", least=0.0, default=0.0)
_TIE = Keys(
    {"height": positive("length")},
    {
        "prestress": _PRESTRESS,
        "yield": positive("force", default=math.inf),
        "ultimate": positive("length"),
        "behind": Key("length", default=0.0),
        "side": Key("choice", words=tuple(SIDES)),
    },
    (_STIFFNESS,),
)
_TENDON = Keys(
    {},
    {"prestress": _PRESTRESS, "rupture": Key("force", least=0.0, default=math.inf)},
    (_STIFFNESS,),
)
_WEIGHT = (
    Keys({"mass": positive("mass")}),
    Keys(
        {
            "weight": positive(
                "force",
                where="a positive weight",
                usual=Usual(100.0, math.inf, in_units("kN")),
            )
        }
    ),
)
_INERTIA = {"inertia": Key("choice", words=INERTIAS)}
POINT, MIRRORED = {"at": Key("pair")}, {"mirrored": Key("flag")}
# of a rigid body, and of a mechanism
LOADS = Keys(
    _INERTIA,
    {},
    (
        _WEIGHT,
        (Keys(POINT, MIRRORED), Keys({"bearing": Key("choice", words=BEARINGS)})),
    ),
)
LOADS_ON_BODIES = Keys({"body": Key("name"), **POINT, **_INERTIA}, MIRRORED, (_WEIGHT,))
# of every rigid kind
RIGID = Keys(
    {},
    {
        "one_sided": Key(
            "flag", "true: it rocks on its right edge only, against a backing"
        ),
        "mass": positive("mass", "for loads, ties, a tendon, dampers and strength"),
        "inset": Key(
            "length",
            "of the pivots from the edges: rounding, wear",
            least=0.0,
            default=0.0,
        ),
        "strength": positive(
            "stress",
            "of a toe that crushes, instead of inset",
            where="a positive stress, such as 2 MPa",
        ),
        "period": positive(
            "time", "of the body on a fixed base: tells how rigid it is"
        ),
        "youngs_modulus": positive(
            "stress",
            "instead of period, of block, free wall and cylinder with a density",
            usual=Usual(1e6, 1e12, in_units("MPa", "GPa")),
        ),
        "loads": Key("parts", "floors, roofs and other weights", inner=LOADS),
        "ties": Key("parts", "see rocking help ties", inner=_TIE),
        "tendon": Key("part", "see rocking help ties", inner=_TENDON),
        "dampers": Key(
            "part",
            "see rocking help ties",
            inner=Keys({"coefficient": Key("damping coefficient", least=0.0)}),
        ),
    },
)
ONE_SIDED_RESTITUTION = (
    "a number above -1 and up to 0 (one_sided: it returns to the side it came from)"
)


def gravity_of(document: Document) -> float:
    """Return the document's gravity [m/s2], 9.81 by default."""
    return document.quantity("gravity")


def restraints_in(document: Document) -> list[str]:
    """Return the document's keys of restraints. Raises DocumentError for one without a
    value, which would silently leave them out.
    """
    found = [key for key in RESTRAINTS if document.has(key)]
    for key in RESTRAINTS:
        if key in document.values and key not in found:
            raise document.fault(key, "nothing", f"the {key}, or no such key")
    return found


def has_loads(document: Document) -> bool:
    """True if the document has loads. Raises DocumentError for the key without a value,
    which would silently leave them out.
    """
    if document.has("loads"):
        return document.values["loads"].content != []
    if "loads" in document.values:
        raise document.fault("loads", "nothing", "the loads, or no such key")
    return False


def weight_of_loads(document: Document) -> float:
    """Return the weight of all loads of a body [N], which its base carries."""
    if not has_loads(document):
        return 0.0
    gravity = gravity_of(document)
    content = document.values["loads"].content
    # without their other keys, which `loads_of` reads and checks
    parts = [
        document.part("loads", child, f"loads.{i}")
        for i, child in enumerate(content if isinstance(content, list) else ())
    ]
    return gravity * sum(mass_of_load(part, gravity) for part in parts)


def mass_of_load(part: Document, gravity: float) -> float:
    """Return the weight of a load over g [kg]. Raises DocumentError."""
    weight = part.optional("weight")
    return part.quantity("mass") if weight is None else weight / gravity


def restitution_of(
    document: Document, momentum: float, limit: str
) -> tuple[float, str]:
    """Return (eta, its source): the document's value, or `momentum`, the value from
    conservation of angular momentum. limit: a text on the bodies for which the momentum
    model holds. Raises DocumentError if eta is not given and `momentum` is negative.
    """
    if _given(document):
        return abs(document.quantity("restitution", least=0.0, most=1.0)), "given"
    if momentum < 0.0:
        found = _swapped(document) or (
            "a shape for which conservation of angular momentum at an impact gives the"
            f" restitution {momentum:.4g}, below 0"
        )
        expected = f"{limit}; or give restitution, a number from 0 to 1"
        raise document.fault(None, found, expected)
    return momentum, "momentum"


def given_restitution(document: Document) -> float | None:
    """Return the document's restitution; None if it follows from momentum. Raises
    DocumentError for a number out of range.
    """
    if not _given(document):
        return None
    if document.flag("one_sided"):
        return one_sided_restitution_of(document, (1.0, 1.0), None)[0]
    return restitution_of(document, 0.0, "")[0]


def one_sided_restitution_of(
    document: Document, base: tuple[float, float], backing: float | None
) -> tuple[float, str]:
    """Return (e, its source) of a one-sided body, -1 < e <= 0: the document's value, or
    the product of three impacts. base: eta of the impact on the right edge and on the
    left edge; backing: the factor of the impact on the backing, None if the geometry
    does not define the point of impact. Raises DocumentError.
    """
    if _given(document):
        wanted = ONE_SIDED_RESTITUTION + ("" if backing is None else ", or auto")
        stated = document.quantity("restitution", above=-1.0, most=0.0, where=wanted)
        return stated + 0.0, "given"
    if backing is None:
        raise document.fault(
            "one_sided",
            "a one-sided body whose geometry does not define its impact on the backing",
            f"restitution as well: {ONE_SIDED_RESTITUTION}",
        )
    e = base[0] * base[1] * backing
    if min(base) < 0.0 or not -1.0 < e <= 0.0:
        found = (
            f"a restitution of {e:.4g} from three impacts, {base[0]:.4g} and"
            f" {base[1]:.4g} on its base and {backing:.4g} on its backing"
        )
        swapped = _swapped(document)
        raise document.fault(
            None if swapped else "one_sided",
            swapped or found,
            "a body more slender than this one; or give restitution",
        )
    return e, "momentum"


def _swapped(document: Document) -> str:
    """Return the sizes of a body that is wider than high in words, an empty text for
    another one.
    """
    for key, halves in (
        ("width", 1.0),
        ("base_radius", 2.0),
        ("thickness", 1.0),
        ("radius", 2.0),
    ):
        if document.has(key) and document.has("height"):
            size, height = document.length(key), document.length("height")
            if halves * size > height:
                return (
                    f"{key} {size:g} m and height {height:g} m, wider than high (did"
                    f" you swap {key} and height?)"
                )
    return ""


def _given(document: Document) -> bool:
    return (
        document.has("restitution") and document.values["restitution"].content != "auto"
    )


def labels_of(document: Document) -> dict[str, str]:
    """Return the document's labels: texts by name, which the computation does not use.
    Raises DocumentError.
    """
    if not document.has("labels"):
        return {}
    part = document.part("labels", document.values["labels"])
    return {
        name: part.word(name, "") if value.word() != "" else ""
        for name, value in part.values.items()
    }


def damping_of(document: Document) -> float:
    """Return the document's viscous damping zeta [-], 0 by default."""
    return document.quantity("damping")


def friction_of(document: Document) -> tuple[float | None, float | None]:
    """Return the document's coefficients of friction (static, kinetic) [-], None where
    they are not stated: `friction: 0.3`, or `friction: {static: 0.35, kinetic: 0.3}`.
    """
    if not document.has("friction"):
        return None, None
    value = document.values["friction"]
    if not isinstance(value.content, dict):
        return document.quantity("friction"), None
    part = document.part("friction", value)
    static = part.quantity("static")
    where = f"a positive number up to the static friction, {static:g}"
    kinetic = part.quantity("kinetic", most=static, where=where)
    return static, None if kinetic == static else kinetic


def mass_of(document: Document) -> float | None:
    """Return the document's mass [kg], None if absent."""
    return document.optional("mass")

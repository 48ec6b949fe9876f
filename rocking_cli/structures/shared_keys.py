"""Keys that documents of several kinds share: gravity, restitution, damping, friction,
mass.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..documents.quantities import DEFAULT_GRAVITY
from ..documents.spreads import is_spread
from ..errors import DocumentError
from .parameters import MOST_DAMPING

if TYPE_CHECKING:
    from ..documents.document import Document

RESTRAINTS = ("ties", "tendon", "dampers")
ONE_SIDED_RESTITUTION = (
    "a number above -1 and up to 0 (one_sided: it returns to the side it came from)"
)


def gravity_of(document: Document) -> float:
    """Return the document's gravity [m/s2], 9.81 by default."""
    return document.quantity(
        "gravity",
        "acceleration",
        least=1e-2,
        most=1e4,
        where="an acceleration from 0.01 to 10000 m/s2",
        default=DEFAULT_GRAVITY,
    )


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
    if not part.has("weight"):
        return part.quantity("mass", "mass", above=0.0, where="a positive mass")
    if part.has("mass"):
        raise part.fault("weight", "weight together with mass", "one of them")
    weight = part.quantity("weight", "force", above=0.0, where="a positive weight")
    return weight / gravity


def restitution_of(
    document: Document, momentum: float, limit: str
) -> tuple[float, str]:
    """Return (eta, its source): the document's value, or `momentum`, the value from
    conservation of angular momentum. limit: a text on the bodies for which the momentum
    model holds. Raises DocumentError if eta is not given and `momentum` is negative.
    """
    if _given(document):
        return (
            abs(
                _stated(document, "a number from 0 to 1, or auto", least=0.0, most=1.0)
            ),
            "given",
        )
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
        return _stated(document, wanted, above=-1.0, most=0.0) + 0.0, "given"
    if backing is None:
        found = (
            "a one-sided body whose geometry does not define its impact on the backing"
        )
        raise document.fault(
            "one_sided", found, f"restitution as well: {ONE_SIDED_RESTITUTION}"
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


def _stated(
    document: Document,
    wanted: str,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    most: float,
) -> float:
    """Return the document's restitution. Raises DocumentError if it is out of bounds;
    wanted: the bounds in words.
    """
    try:
        return document.quantity(
            "restitution", "number", above=above, least=least, most=most
        )
    except DocumentError:  # its sentence lacks `auto`
        if is_spread(str(document.values["restitution"].content)):
            raise
        raise document.fault(
            "restitution", str(document.values["restitution"]), wanted
        ) from None


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
    where = f"a number from 0 to below {MOST_DAMPING:g} (zeta)"
    return document.quantity(
        "damping", "number", least=0.0, below=MOST_DAMPING, where=where, default=0.0
    )


def friction_of(document: Document) -> tuple[float | None, float | None]:
    """Return the document's coefficients of friction (static, kinetic) [-], None where
    they are not stated: `friction: 0.3`, or `friction: {static: 0.35, kinetic: 0.3}`.
    """
    where = "a positive number (a coefficient of friction)"
    if not document.has("friction"):
        return None, None
    value = document.values["friction"]
    if not isinstance(value.content, dict):
        return document.quantity("friction", "number", above=0.0, where=where), None
    part = document.part("friction", value)
    static = part.quantity("static", "number", above=0.0, where=where)
    where = f"a positive number up to the static friction, {static:g}"
    kinetic = part.quantity("kinetic", "number", above=0.0, most=static, where=where)
    part.finish()
    return static, None if kinetic == static else kinetic


def mass_of(document: Document) -> float | None:
    """Return the document's mass [kg], None if absent."""
    return (
        document.quantity("mass", "mass", above=0.0, where="a positive mass")
        if document.has("mass")
        else None
    )

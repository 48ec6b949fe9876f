"""Keys that documents of several kinds share: gravity, restitution, one_sided, damping, friction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..documents.quantities import DEFAULT_GRAVITY
from ..errors import DocumentError
from .parameters import MOST_DAMPING

if TYPE_CHECKING:
    from ..documents.document import Document

ONE_SIDED_RESTITUTION = "a number above -1 and up to 0 (one_sided: it returns to the side it came from)"


def gravity_of(document: Document) -> float:
    """The document's gravity [m/s2], 9.81 unless given."""
    if not document.has("gravity"):
        return DEFAULT_GRAVITY
    return document.quantity("gravity", "acceleration", above=0.0, where="a positive acceleration")


def restitution_of(document: Document, momentum: float, limit: str) -> tuple[float, str]:
    """(eta, where it comes from): the document's value, or the given one from momentum.

    `limit` says in words where the momentum model ceases to hold (eta < 0), which is an error unless eta is given.
    """
    if document.has("restitution") and document.values["restitution"].content != "auto":
        wanted = "a number from 0 to 1, or auto"
        try:
            return abs(document.quantity("restitution", "number", least=0.0, most=1.0, where=wanted)), "given"
        except DocumentError:
            raise document.fault("restitution", str(document.values["restitution"]), wanted) from None
    if momentum < 0.0:
        raise document.fault(None, f"a restitution of {momentum:.4g} from momentum", f"{limit}; or give restitution")
    return momentum, "momentum"


def one_sided_restitution_of(document: Document, base: tuple[float, float], backing: float | None) -> tuple[float, str]:
    """The same for a one-sided body, (e, where it comes from): e is above -1 and up to 0.

    From momentum it is the product of three impacts: `base`, on leaving the right edge for the left and back; `backing`,
    None where the geometry does not say where the body meets it.
    """
    if document.has("restitution") and document.values["restitution"].content != "auto":
        wanted = ONE_SIDED_RESTITUTION + ("" if backing is None else ", or auto")
        try:
            return document.quantity("restitution", "number", above=-1.0, most=0.0, where=wanted) + 0.0, "given"
        except DocumentError:
            raise document.fault("restitution", str(document.values["restitution"]), wanted) from None
    if backing is None:
        found = "a one-sided body whose geometry does not say where it meets its backing"
        raise document.fault("one_sided", found, f"restitution beside it: {ONE_SIDED_RESTITUTION}")
    e = base[0] * base[1] * backing
    if min(base) < 0.0 or not -1.0 < e <= 0.0:
        found = f"a restitution of {e:.4g} from three impacts, {base[0]:.4g} and {base[1]:.4g} on its base and {backing:.4g} on its backing"
        raise document.fault("one_sided", found, "a body more slender than this one; or give restitution")
    return e, "momentum"


def one_sided_of(document: Document) -> bool:
    """Whether the body leaves the ground on its right edge only, false unless the document says so."""
    return document.flag("one_sided")


def damping_of(document: Document) -> float:
    """The document's viscous damping zeta [-], 0 unless given."""
    if not document.has("damping"):
        return 0.0
    where = f"a number from 0 to below {MOST_DAMPING:g} (zeta)"
    return document.quantity("damping", "number", least=0.0, below=MOST_DAMPING, where=where)


def friction_of(document: Document) -> float | None:
    """The document's coefficient of friction [-], None unless given."""
    if not document.has("friction"):
        return None
    return document.quantity("friction", "number", above=0.0, where="a positive number (a coefficient of friction)")

"""Rocking parameters stated directly, as `rocking params --json` prints them for every
kind.
"""

import math
from typing import Any

from ...documents.document import Document
from ...documents.keys import Key, Keys, positive
from ..parameters import (
    DIMENSIONLESS,
    OTHERS,
    VARIED,
    RockingParameters,
    Side,
    numbers_of,
    weaker_side,
)
from ..rigidity import RIGIDITY
from ..shared_keys import ONE_SIDED_RESTITUTION, RIGID, gravity_of

REPORTS = ()
# details that have a unit
DETAILS = {
    "mass": RIGID.all["mass"],
    "alpha_geometric": Key("angle"),
    "base_stress": Key("stress"),
    "omega_n": positive("frequency parameter"),
    "omega_n_over_p": positive("number"),
    **dict.fromkeys(("inset", "length", "tip_height", "crack_height"), Key("length")),
}
LARGEST_P = 1e150  # rad/s; p^2 and 1/p^2 must be within double precision
P_RANGE = f"a positive number, from {1.0 / LARGEST_P:g} to {LARGEST_P:g} rad/s"

_NUMBERS = {
    "p": Key(
        "frequency parameter",
        "frequency parameter",
        least=1.0 / LARGEST_P,
        most=LARGEST_P,
        where=P_RANGE,
    ),
    "alpha": Key("angle", "critical angle", above=0.0, below=math.pi),
    # of a one-sided body up to 0, of one side of two it may exceed 1
    "eta": Key("number", "coefficient of restitution", above=-1.0),
}
_RATIOS = {
    "lambda": positive("number", "static uplift acceleration over g"),
    "a_scale": positive("number", "alpha/lambda; one of both gives the other"),
    "arm": positive("length", "from the edge to the mass centre, for forces"),
}
_SIDE = Keys({"side": Key("choice", words=("left", "right")), **_NUMBERS}, _RATIOS)
_SIDES = {"sides": Key("parts", "left and right, if they differ", inner=_SIDE)}
KEYS = Keys(
    {},
    {
        **_RATIOS,
        **{key: RIGID.all[key] for key in ("one_sided", "ties", "tendon", "dampers")},
        **DETAILS,
        **dict.fromkeys(("structure_kind", "eta_source"), Key("text")),
        **dict.fromkeys((OTHERS, *VARIED, "restrained", "stands"), Key("any")),
    },
    ((Keys(_NUMBERS), Keys(_SIDES, _NUMBERS)),),
)


def build(document: Document, name: str) -> RockingParameters:
    """Return the parameters that the document states; a_scale = alpha/lambda gives an
    absent lambda or a_scale (Eq. 3.9). Raises DocumentError.
    """
    found = _free(document, name)
    if not (document.has("ties") | document.has("tendon")):
        return found
    from ..restraint_keys import restrained

    for key in ("restrained", "stands"):  # what params printed is derived anew
        document.has(key)
    return restrained(document, found)


def _free(document: Document, name: str) -> RockingParameters:
    """Return the parameters without ties and tendon. Raises DocumentError."""
    structure = document.word("structure_kind", "parameters")
    if structure == DIMENSIONLESS:
        raise document.fault(
            "structure_kind", structure, "the kind of a structure, which has units"
        )
    for key in document.values:
        if key.startswith(("left_", "right_")):  # as a CSV of params has them
            raise document.fault(
                key,
                f"{key}, a number of one side",
                "sides, a list, as `rocking params` prints it in JSON",
            )
    details = _details(document, structure)
    more: dict[str, Any] = {
        "eta_source": document.word("eta_source", "given"),
        "gravity": gravity_of(document),
        "details": details,
    }
    one_sided = document.flag("one_sided")
    if not document.has("sides"):
        numbers = _numbers(document, more["gravity"], one_sided)
        return RockingParameters(
            name=name, structure=structure, **numbers, one_sided=one_sided, **more
        )
    if one_sided:
        raise document.fault(
            "one_sided",
            "a one-sided body of two sides",
            "sides, or one_sided: true, not both",
        )
    left, right = _sides(document, more["gravity"])
    _require_those_of(document, weaker_side((left, right)))
    return RockingParameters.of_sides(name, structure, left, right, **more)


def _details(document: Document, structure: str) -> dict[str, Any]:
    """Return what params printed besides the parameters: the keys that this kind of
    structure reports. Raises DocumentError.
    """
    from . import reports_of

    # The stated alpha is that with the inset.
    moved = ("inset", "alpha_geometric", "base_stress")
    inset = moved if document.has("alpha_geometric") else ()
    reported = (*reports_of(structure), "mass", OTHERS, *inset, *VARIED, *RIGIDITY)
    details = {
        key: document.values[key].plain()
        for key in document.values
        if key in reported and document.has(key)
    }
    details |= {key: document.quantity(key) for key in details if key in DETAILS}
    _check_varied(document, details)
    if OTHERS in details and not isinstance(details[OTHERS], list):
        raise document.fault(
            OTHERS,
            str(document.values[OTHERS]),
            "a list of parameters, as rocking params prints them",
        )
    return details


def _require_those_of(document: Document, weaker: Side) -> None:
    """Raise DocumentError if a parameter beside `sides` is not that of the weaker one,
    as params prints it.
    """
    for key, number in {**numbers_of(weaker), "arm": weaker.arm}.items():
        if document.has(key) and document.quantity(key, most=math.inf) != number:
            raise document.fault(
                key,
                str(document.values[key]),
                f"{number!r} as in sides, where the {weaker.side} edge lifts first",
            )


def _check_varied(document: Document, details: dict[str, Any]) -> None:
    """Raise DocumentError unless `varied` maps keys to numbers, and `varied_units` the
    same keys to names of units.
    """
    values, units = (details.get(key, {}) for key in VARIED)
    fits = isinstance(values, dict) and isinstance(units, dict)
    if not (
        fits
        and {type(number) for number in values.values()} <= {float}
        and {type(unit) for unit in units.values()} <= {str, type(None)}
        and (not units or units.keys() == values.keys())
    ):
        raise document.fault(
            "varied",
            "values of another form",
            "numbers by key and, as varied_units, the names of their units by key",
        )


def _numbers(
    document: Document, gravity: float, one_sided: bool = False, most: float = 1.0
) -> dict[str, Any]:
    """Read p, alpha, eta, uplift, a_scale and arm of a body or of one of its sides;
    most: the largest eta. Raises DocumentError.
    """
    p, alpha = document.quantity("p"), document.quantity("alpha")
    if one_sided:
        eta = document.quantity("eta", most=0.0, where=ONE_SIDED_RESTITUTION)
    else:
        eta = document.quantity("eta", least=0.0, most=most)
    uplift, a_scale = map(document.optional, ("lambda", "a_scale"))
    if uplift is None and a_scale is None:
        raise document.fault(
            None,
            "neither lambda nor a_scale",
            "lambda (uplift acceleration over g), a_scale (alpha/lambda), or both",
        )
    arm = None
    if document.has("arm"):  # that of a point mass at most, since R p^2/g = m R^2/I
        most = gravity / p**2
        where = (
            f"a positive length up to g/p^2, {most:g} m (the mass centre's distance"
            " from the edge)"
        )
        arm = document.quantity("arm", most=most * (1.0 + 1e-9), where=where)
    return {
        "p": p,
        "alpha": alpha,
        "eta": eta,
        "uplift": uplift or alpha / (a_scale or 1.0),
        "a_scale": a_scale or alpha / (uplift or 1.0),
        "arm": arm,
    }


def _sides(document: Document, gravity: float) -> tuple[Side, Side]:
    """Return the left and the right side of the key `sides`. Raises DocumentError."""
    wanted = (
        "a list of two, one with side: left and one with side: right, each with p,"
        " alpha, eta, and lambda or a_scale"
    )
    parts = document.parts("sides", wanted)
    found: dict[str, Side] = {}
    for part in parts if len(parts) == 2 else ():
        side = part.choice("side")
        found[side] = Side(side, **_numbers(part, gravity, most=math.inf))
    if not found:
        raise document.fault("sides", "a list", wanted)
    if len(found) < 2:
        raise document.fault("sides", f"the {next(iter(found))} side twice", wanted)
    return found["left"], found["right"]

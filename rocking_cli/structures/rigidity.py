"""How rigid a body is: its frequency on a fixed base over p = sqrt(g/R) of its mass
centre, and by how much its flexibility lowers the first amplitude at which it falls.
"""

import math
from typing import Any

from ..documents.document import Document
from .parameters import RockingParameters

# omega_n/p, and by how much the first fall under one sine is lower than that of the
# rigid body, at most [-]: one lumped mass on its column, zeta = 0.05, alpha 0.1 and 0.2
_LOWER = {3: 0.38, 4: 0.29, 6: 0.17, 8: 0.13, 10: 0.10, 15: 0.06, 20: 0.03}
RIGIDITY = ("omega_n", "omega_n_over_p")  # what is told of a body with a period
_STEEPEST = 2.0  # (omega_n/p) sin(alpha) above which no table covers a body


def rigidity_of(
    document: Document, body: RockingParameters
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return (omega_n [rad/s] and omega_n_over_p [-] by their names, a sentence on a
    body that is not rigid), both empty without the key `period`, or omega_n as params
    prints it. Raises DocumentError for a body whose mass centre is not known.
    """
    key = "period" if document.has("period") else RIGIDITY[0]
    if not document.has(key):
        return {}, ()
    value, number = document.values[key], document.quantity(key)
    if body.arm is None:
        raise document.fault(key, str(value), f"no {key} of a body without one arm")
    omega = 2.0 * math.pi / number if key == "period" else number
    ratio = omega / math.sqrt(body.gravity / body.arm)
    found = dict(zip(RIGIDITY, (omega, ratio), strict=True))
    if ratio >= max(_LOWER):
        return found, ()
    told = f"{value.place}: {key}: omega_n/p = {ratio:.3g}: the body is not rigid; "
    if ratio < min(_LOWER) or ratio * math.sin(body.alpha) > _STEEPEST:
        return found, (told + "no table says what it bears",)
    lower = _LOWER[max(least for least in _LOWER if least <= ratio)]
    sentence = (
        f"it may fall from an amplitude up to {100.0 * lower:.0f} % lower on (one"
        " lumped mass under one sine)"
    )
    return found, (told + sentence,)

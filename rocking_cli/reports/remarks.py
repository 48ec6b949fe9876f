"""Remarks on results: the model and the direction of a run, what the linear equation
misjudges, bases that slide.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..dynamics.method import LINEAR, Method, geometry_known, has_direction
from ..structures.friction import sliders
from ..structures.parameters import RockingParameters

if TYPE_CHECKING:
    from ..responses.inset import InsetEffect


def model_in_words(
    method: Method,
    *structures: RockingParameters,
    model: str | None = None,
    dimensionless: bool = False,
) -> str:
    """The line that names the model of a run; if the model is linear by default, it
    says why. Parameters as of `governing_method`.
    """
    line = f"model: {method.model}"
    if model is not None or method != LINEAR:
        return line
    if dimensionless:
        return f"{line}, on dimensionless axes (A, Omega)"
    stated = [s.name for s in structures if not geometry_known(s)]
    return f"{line}, since the geometry of {_some(stated)} is not known"


def _some(names: list[str]) -> str:
    """Return names in words, the first three of many."""
    return f"{', '.join(names[:3])}{' and others' * (len(names) > 3)}"


def inset_in_words(found: "InsetEffect") -> str:
    """Return the line on the effect of worn edges on a capacity."""
    from ..responses.inset import INSET

    pivots = f"{found.structure}: pivots {1000.0 * found.inset:.3g} mm inside the edges"
    change = 100.0 * found.change
    does = f"{'take' if change <= 0.0 else 'add'} {abs(change):.2g} % of the capacity"
    if found.crushes:
        return f"{pivots} (its strength: the toe crushes) {does} on sharp edges"
    return f"{pivots} ({100.0 * INSET:g} % of the width: rounding, wear) would {does}"


def misjudged_in_words(
    unsafe: float, falls: float, alarms: float, *, a_max: float
) -> str:
    """Return a sentence on the lengths of `envelopes.intervals.misjudged` up to
    a_max.
    """
    share = f"{100.0 * unsafe / falls:.3g} %" if falls else "none"
    overturn = f"the amplitudes that overturn up to A = {a_max:g}"
    return (
        f"the linear equation is unsafe over {share} of {overturn}, and falls over"
        f" {alarms:.3g} in A where the body stands"
    )


def direction_in_words(
    *structures: RockingParameters,
    opposite: str = "the other sign of `scale` (1 if not given)",
) -> list[str]:
    """Return the lines for a run that computes one direction of the motion only: one
    that names the structures for which the opposite direction may have another result,
    none without such a structure. opposite: the option that computes the other
    direction.
    """
    names = [s.name for s in structures if has_direction(s)]
    return (
        [
            "one direction of the motion only, though the sides differ:"
            f" {_some(names)}; {opposite} gives the opposite one"
        ]
        if names
        else []
    )


def stuck_in_words(structures: Iterable[RockingParameters]) -> list[str]:
    """Return the line for a result that holds for bases that do not slide; none if no
    structure slides instead.
    """
    if not (names := [s.name for s in sliders(structures)]):
        return []
    return [
        "the base is taken not to slide, though by its friction, which is below lambda,"
        f" it slides and never rocks: {_some(names)}; see rocking check"
    ]

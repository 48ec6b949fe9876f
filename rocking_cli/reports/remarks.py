"""Remarks on results: the model of a run, what the linear equation misjudges, ties."""

from typing import TYPE_CHECKING, Any

from ..dynamics.method import LINEAR, Method, geometry_known
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
    return (
        f"{line}, since the geometry of"
        f" {', '.join(stated[:3])}{' and others' * (len(stated) > 3)} is not known"
    )


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


def devices_in_words(
    devices: tuple[dict[str, Any], ...], first: float | None, free: float | None
) -> list[str]:
    """Return a sentence for each row of `device_rows`, one that compares first, the
    lowest overturning amplitude, with free, that without these devices, and one on
    devices that yield and never break.
    """
    lines = [one["words"] for one in devices]
    if first is not None and free is not None:
        change = 100.0 * (first / free - 1.0)
        tendon, ties = (
            any((one["device"] == "tendon") is held for one in devices)
            for held in (True, False)
        )
        name, without = (
            ("ties and tendon", "them")
            if ties and tendon
            else ("ties", "them")
            if ties
            else ("tendon", "it")
        )
        verb = ("add" if change >= 0.0 else "take") + "s" * (name == "tendon")
        lines.append(
            f"its {name} {verb} {abs(change):.3g} % of the capacity without {without}"
        )
    if endless := [one["device"] for one in devices if one.get("endless")]:
        lines.append(
            f"without `ultimate`, {' and '.join(endless)} never"
            f" {'breaks' if len(endless) == 1 else 'break'} in this model, however far"
            " stretched beyond yield"
        )
    return lines

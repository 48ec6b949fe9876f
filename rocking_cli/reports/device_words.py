"""What ties and a tendon do, in words."""

from typing import Any

from ..responses.verdict import Verdict


def device_in_words(device: dict[str, Any]) -> str:
    """Return the text of a row of `device_rows`."""
    share = (
        ""
        if device["tie_force"] is None
        else f" ({device['tie_force']:.4g} of its {device['limit']})"
    )
    if not device["tie_elongation"]:
        prestress = (
            f", at its prestress of {device['force']:.6g} N{share}"
            if device["force"]
            else ""
        )
        return f"{device['device']} {device['state']}, not stretched{prestress}"
    left = (
        f", {1e3 * device['permanent']:.4g} mm of them permanent"
        if device["permanent"]
        else ""
    )
    return (
        f"{device['device']} {device['state']}, up to {device['force']:.6g} N{share}"
        f" and {1e3 * device['tie_elongation']:.4g} mm{left}"
    )


def devices_in_words(v: Verdict) -> list[str]:
    """Return a sentence for each tie and tendon of a body, one that compares its
    capacity with that without them, and one on those that yield and never break.
    """
    devices, first = v.devices, v.first_overturning_a
    free = v.first_overturning_a_free
    lines = [device_in_words(one) for one in devices]
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

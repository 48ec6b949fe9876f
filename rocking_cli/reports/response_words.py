"""A response in time in words: its outcome, its largest rotation and its forces."""

import math
from collections.abc import Iterator

from ..dynamics.outcome import Outcome
from ..responses.contact_forces import ContactForces
from ..responses.force_history import ForceHistory
from ..responses.time_history import TimeHistory
from .device_words import device_in_words


def response_in_words(found: TimeHistory, *, forces: bool = False) -> Iterator[str]:
    """Yield a sentence on the outcome for each model; forces: True with what is known
    of the forces.
    """
    s = found.structure
    for model, own in found.histories.items():
        outcome, peak, ratio = found.outcome(model), own.peak, own.theta_ratio or 0.0
        text, before = outcome.sentence, 0.0 if peak is None else abs(peak.theta_ratio)
        if outcome == Outcome.LOST_CONTACT:
            text += _loss_in_words(found, model)
        elif ratio > before * (1.0 + 1e-9):
            text += f", largest theta {ratio:.6g} alpha after {own.end / s.p:.4g} s"
        elif peak is not None:
            text += (
                f", largest theta {ratio * float(s.alpha_on(peak.side)):.6g} rad"
                f" ({ratio:.6g} alpha) at {peak.tau / s.p:.4g} s"
            )
        if top := found.top_displacement(model):
            text += f", top displaced by up to {1e3 * top:.4g} mm"
        ended = any(m.event in ("rest", "overturning") for m in own.events)
        if outcome == Outcome.ROCKED and not ended:
            text += f"; still rocking at {own.end / s.p:.4g} s"
        if outcome.overturned:
            text += _loss_in_words(found, model)
        text += "".join(f"; {device_in_words(device)}" for device in own.devices)
        if forces:
            text += f"; {forces_in_words(found.forces[model])}"
        yield f"{s.name}, {model}: {text}"


def _loss_in_words(found: TimeHistory, model: str) -> str:
    """Return what to say of a loss of contact; empty without one."""
    own, p = found.histories[model], found.structure.p
    if not found.outcome(model).overturned:
        if own.lost is None:
            return f" after {own.end / p:.4g} s"
        return f" at {own.lost / p:.4g} s, and its later motion is not known"
    if own.lost is None:
        return ""
    return (
        f", and loses contact with the ground at {own.lost / p:.4g} s during its fall,"
        " which is therefore not proved"
    )


def forces_in_words(forces: ForceHistory) -> str:
    """Return a sentence on the extreme forces."""
    if isinstance(forces, ContactForces):
        return _contact_in_words(forces)
    arch = "hinge_force" in forces.statics[1.0].joints.SHOWN
    if not forces.found.arcs.start.size:
        return f"the {'arch' if arch else 'mechanism'} never moved"
    found = forces.extremes
    if not found:
        return "N and T are not known without outlines that touch at the hinges"
    at = "on joint {}" if arch else "at hinge {} ({})"
    thrust, friction, *others = (
        (worst.value, at.format(worst.place, "right" if worst.side > 0.0 else "left"))
        for worst in (
            found[name]
            for name in ("thrust_min", "friction", "eccentricity", "hinge_force")
            if name in found
        )
    )
    text = f"least N {thrust[0]:.4g} of the weight {thrust[1]}"
    text += f", largest |T|/N {friction[0]:.4g} {friction[1]}"
    if arch:
        (eccentricity, on), hinge = others[0], found["hinge_force"]
        text += f", largest |M|/(N t/2) {eccentricity:.4g} {on}"
        opens = eccentricity > 1.0 + 1e-9
        text += ", where a further hinge opens" * opens
        text += ", so no further hinge opens" * (not opens)
        text += f"; largest force at a hinge {hinge.value:.4g} of the weight, at hinge"
        text += f" {hinge.place}"
    elif thrust[0] <= 0.0:
        text += "; a hinge lifts off, so another mechanism follows"
    if (limit := forces.structure.friction) is not None:
        slides = "a joint slides" if friction[0] > limit else "no joint slides"
        text += f"; with the friction {limit:g} of the document {slides}"
    return text


def _contact_in_words(forces: ContactForces) -> str:
    """Return a sentence on the extremes of the forces on the ground."""
    extremes, s = forces.extremes, forces.structure
    friction, tau = extremes.friction
    text = f"least Fz {extremes.fz_min:.6g} m g at {extremes.fz_min_tau / s.p:.4g} s"
    if not math.isfinite(friction):
        return f"{text}, so no friction holds the base"
    text += f", required friction {friction:.6g} at {tau / s.p:.4g} s"
    if extremes.impact is not None:
        text += f" ({extremes.impact.friction:.6g} in impacts)"
    if s.friction is None:
        return text
    when = {
        None: "does not slide",
        "impact": "would slide at an impact",
        "rocking": "would slide while rocking",
    }
    words = when.get(extremes.slides(s.friction), "would slide before it rocks")
    return f"{text}: with the friction {s.friction:g} of the document the base {words}"

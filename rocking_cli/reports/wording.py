"""The texts of a report: the demand and each verdict in words, and the parameters of a
structure with their relations.
"""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..digits import digits_apart, rounded_down
from ..documents.quantities import DEFAULT_GRAVITY
from ..dynamics.method import LINEAR
from ..dynamics.outcome import Outcome
from ..motions import Motion
from ..motions.grid import Grid
from ..responses.verdict import Verdict
from ..structures import RockingParameters, Side
from .figures.canvas import motion_in_words

if TYPE_CHECKING:
    from ..responses.code_check import CodeCheck
    from ..responses.uncertainty import DrawnVerdict

OVERVIEW = (
    "structure",
    "verdict",
    "worst motion",
    "capacity over demand",
    "overturns from [g]",
    "friction needed",
)
_RELATIONS = {  # closed forms of the paper by kind
    "block": {"p": "p² = 3 g/(4 R)", "eta": "η = 1 − 3/2 sin² α"},
    "point_mass": {"p": "p² = g/R", "eta": "η = cos 2α"},
    "arch": {
        "p": "Eqs. 3.5 to 3.9, the linkage at its unstable equilibrium",
        "lambda": "least over all admissible mechanisms",
    },
}
# symbol, meaning, value, unit, relation
ParameterRow = tuple[str, str, float, str, str]
_EQUILIBRIUM = "{:.4g}°: beyond it the structure does not come back on its own"
_LIFTS = "it lifts at ẍg = λ g"


def draws_in_words(name: str, found: "DrawnVerdict") -> str:
    """Return the line on the draws of a structure."""
    share = found.share
    line = (
        f"{name}: of {share.draws:,} draws {100.0 * share.share:.3g} % fall"
        f" ({100.0 * share.low:.3g} to {100.0 * share.high:.3g} %)"
    )
    if found.key is None:
        return line
    what = "the first overturning" if found.quantiles else "the outcome"
    explained, low, high = (
        f"{100.0 * x:.0f}" for x in (found.indices[found.key], *found.interval)
    )
    return f"{line}; {found.key} explains {explained} % ({low} to {high} %) of {what}"


def demand_plainly(
    shakes: Sequence[tuple[Motion, Grid]], vertical: str | None = None
) -> str:
    """Return the demand in words, such as `one cycle of a sine of 0.3 g at 1 Hz`;
    shakes: motions with a grid of one cell each.
    """
    upwards = f", with the vertical motion {vertical}" if vertical else ""
    motion, grid = shakes[0]
    peaks = [abs(float(shake.amplitude.values[0])) for _, shake in shakes]
    with_unit, unit = (
        ("{} g", DEFAULT_GRAVITY)
        if grid.amplitude.name == "a_g"
        else (grid.amplitude.name + " = {}", 1.0)
    )
    size = with_unit.format(
        " to ".join(dict.fromkeys(f"{x / unit:.3g}" for x in (min(peaks), max(peaks))))
    )
    if motion.acceleration is not None:
        return (
            f"{len(shakes)} records of PGA {size}"
            if len(shakes) > 1
            else f"the record {motion.name}, of PGA {size}"
        ) + upwards
    plain, times, factor = motion.name.partition(" times ")
    name = motion_in_words(plain)
    if name == plain:
        name = f"a{'n' if name[0].lower() in 'aeiou' else ''} {name}"
    at = f"{_frequencies(shakes)}{times}{factor}"
    return f"{name} of {size} at {at}{upwards}"


def _frequencies(shakes: Sequence[tuple[Motion, Grid]]) -> str:
    """Return the frequency of a pulse in words; of both ends of a range that the worst
    one counts.
    """
    axes = [grid.frequency for _, grid in shakes]
    unit = math.tau if axes[0].name == "omega_g" else 1.0
    found = sorted(dict.fromkeys(float(axis.values[0]) / unit for axis in axes))
    text = " to ".join(f"{x:.4g}" for x in found)
    at = f"{text} Hz" if unit != 1.0 else f"{axes[0].name} = {text}"
    return at if len(found) == 1 else f"{at}, at the worst for each structure"


def _at(v: Verdict, frequency: str, azimuth: str) -> str:
    """Return where in a range a number of a verdict holds, such as ` at 0.5 Hz`, from
    its column of a range of frequencies or azimuths; empty without a range.
    """
    if (f_g := v.ranged.get(frequency)) is not None:
        return f" at {f_g:.3g} Hz"
    if (angle := v.ranged.get(azimuth)) is not None:
        return f" at {math.degrees(float(angle)):.4g}°"
    return ""


def range_in_words(ranged: str, searched: bool) -> str:
    """Return the line on the row of a range: which numbers are the least and which the
    largest; ranged: `frequency` or `azimuth`; searched: True with capacities.
    """
    least, most = {
        "frequency": ("worst_f_g", "largest_f_g"),
        "azimuth": ("azimuth", "largest_azimuth"),
    }[ranged]
    capacity = (
        f"first_overturning_a and capacity_demand are the least over the range, at"
        f" {least}; "
    )
    return (
        f"{capacity * searched}theta_ratio and top_displacement are the largest over"
        f" the range, at {most}"
    )


def verdict_plainly(v: Verdict) -> str:
    """Return a verdict in a sentence or two."""
    there = _at(v, "worst_f_g", "azimuth")
    first = (
        None
        if v.first_overturning_a is None
        else f"{v.first_overturning_a / DEFAULT_GRAVITY:.3g} g"
    )
    if v.outcome == Outcome.FAILED:
        said = "Not known: the computation failed."
    elif v.outcome.overturned:
        said = f"Falls: it {v.outcome.sentence}{there}."
    elif v.outcome == Outcome.LEANING:
        said = (
            "Leans: it comes to rest held by its ties alone, so it counts as falling."
        )
    elif v.falls:
        said = (
            "Leaves the ground: its later motion is not known, so it counts as falling."
        )
        said += f" It {v.slide.words}." if v.slide is not None else ""
    elif v.slide is not None:
        said = f"Stands: it {v.slide.words}."
    elif v.outcome == Outcome.NO_UPLIFT:
        said = "Stands: it does not lift."
    else:
        percent = 100.0 * (v.theta_ratio or 0.0)
        shown = float(f"{percent:.{digits_apart(percent, 100.0, 2)}g}")
        most = _at(v, "largest_f_g", "largest_azimuth")
        said = f"Stands: it rocks to {shown:g} % of its critical angle{most}."
        if there and v.capacity_demand is not None:
            said += f" Its capacity is least{there}."
        if (
            first is not None
            and v.capacity_demand is not None
            and v.capacity_demand < 1.0
        ):
            said += f" Weaker shaking, from {first}, overturns it{there}."
    if v.unsettled:
        said += " A change of the demand in its last digits changes this."
    if v.coupling:
        said += f" It {v.coupling}."
    if v.friction_needed is not None and v.friction_needed > 0.0 and not v.slide:
        # rounded up: it exceeds the friction of a base that would slide
        needed = f"{-rounded_down(-v.friction_needed, 2):#.2g}"
        said += (
            f" Its base would slide: it needs a friction of {needed}."
            if v.slides and not v.coupling
            else f" It needs a friction of {needed} at its base."
        )
    elif v.slides and not v.coupling:
        said += " Its base would slide."
    return said + " This is by the linear equation alone." * (v.model == LINEAR.model)


NOT_KNOWN = " (not known)"  # behind the name of a structure without an answer


def verified_in_words(checks: Sequence["CodeCheck"]) -> list[str]:
    """Return for each limit state of the code how many structures are not verified, and
    which.
    """
    lines = []
    for state in ("SLV", "SLC"):
        asked = dict.fromkeys(c.structure for c in checks if state in c.asked)
        failed = dict.fromkeys(
            c.structure + NOT_KNOWN * (state in c.unanswered)
            for c in checks
            if state in c.asked and not c.verified(state)
        )
        if asked:
            names = f": {', '.join(failed)}" if failed else ""
            lines.append(f"{state}: {len(failed)} of {len(asked)} not verified{names}")
    return lines


def tally(verdicts: Sequence[Verdict]) -> str:
    """Return a text with the number of structures that overturn, and, if there are any,
    of those that lose contact or lean.
    """
    lost, leans = (
        sum(v.outcome == outcome for v in verdicts)
        for outcome in (Outcome.LOST_CONTACT, Outcome.LEANING)
    )
    overturn = (
        f"{sum(v.outcome.overturned for v in verdicts)} of {len(verdicts)} overturn"
    )
    if slid := sum(v.outcome == Outcome.SLID for v in verdicts):
        overturn += f", {slid} slide{'s' if slid == 1 else ''} and never rock"
        overturn += "s" * (slid == 1)
    overturn += (
        f", {lost} lose{'s' if lost == 1 else ''} contact with the ground"
        if lost
        else ""
    )
    return overturn + (
        f", {leans} come{'s' if leans == 1 else ''} to rest leaning" if leans else ""
    )


def capacity_left(v: Verdict) -> float:
    """Return capacity over demand for sorting: -1 for an unknown outcome, infinite if
    nothing overturns the structure.
    """
    if v.outcome == Outcome.FAILED:
        return -1.0
    return math.inf if v.capacity_demand is None else v.capacity_demand


def worst_of(verdicts: Sequence[Verdict]) -> Verdict:
    """Return the worst verdict: an unknown outcome or a fall first, then the least
    capacity.
    """
    return min(verdicts, key=lambda v: (v.outcome.safe, capacity_left(v)))


def overview_row(verdicts: Sequence[Verdict]) -> tuple[str | float | None, ...]:
    """Return the cells of OVERVIEW from the verdicts of one structure under all
    motions.
    """
    v, fallen = worst_of(verdicts), sum(one.falls for one in verdicts)
    said = verdict_plainly(v) + (
        f" It falls under {fallen} of {len(verdicts)} motions."
        if fallen and len(verdicts) > 1
        else ""
    )
    return (
        v.structure,
        said,
        v.motion,
        v.capacity_demand,
        v.first_overturning_a,
        v.friction_needed,
    )


def opposite_in_words(outcomes: Sequence[tuple[str, Outcome]]) -> str:
    """Return a remark on the worst of the outcomes (name, outcome) in the opposite
    direction.
    """
    names: dict[str, dict[str, None]] = {}
    for name, outcome in outcomes:
        said = (
            "overturns"
            if outcome.falls
            else "does not overturn"
            if outcome.safe
            else "is not known for"
        )
        names.setdefault(said, {})[name] = None
    worst = next(
        said
        for said in ("overturns", "is not known for", "does not overturn")
        if said in names
    )
    return (
        "the opposite direction (`scale` -1), which may differ for unequal sides:"
        f" {worst} {', '.join(names[worst])}"
    )


def parameter_rows(s: RockingParameters) -> list[dict[str, str]]:
    """Return the rows for p, alpha, eta, lambda and a_scale, of each edge if they
    differ, and for restraints and damping.
    """
    rows = [row for of in s.sides or (s,) for row in _rows_of(s, of)]
    if s.restraints:
        for held in s.details.get("restrained", ()):
            rows += _restrained_rows(held)
    if s.damping:
        rows.append(("ζ", "viscous damping", s.damping, "-", "θ̈ is less by 2 ζ p θ̇"))
    return [
        {
            "symbol": symbol,
            "meaning": meaning,
            "value": f"{value:#.4g}".removesuffix("."),
            "unit": unit,
            "relation": relation,
        }
        for symbol, meaning, value, unit, relation in rows
    ]


def _rows_of(s: RockingParameters, of: RockingParameters | Side) -> list[ParameterRow]:
    """Return the rows of a structure, or of one of its edges."""
    known = dict(_RELATIONS.get(s.structure, {}))
    if s.eta_source != "momentum" or s.one_sided:
        known.pop("eta", None)
    edge = f", {of.side} edge" if isinstance(of, Side) else ""
    free = ", of the free body" * bool(s.restraints)
    which = "the impact that leaves this edge" if s.sides else "an impact"
    relations = {
        "p": "θ̈ = p² (θ − α sgn θ − a_scale ẍg/g)",
        "alpha": _EQUILIBRIUM.format(math.degrees(of.alpha)) + free,
        "eta": f"θ̇ after = η θ̇ before {which}",
        "lambda": _LIFTS + free,
        "a_scale": "α/λ; 1 for a single body",
        **known,
    }
    return [
        ("p", f"frequency parameter{edge}", of.p, "rad/s", relations["p"]),
        ("α", f"critical angle{edge}", of.alpha, "rad", relations["alpha"]),
        ("η", f"coefficient of restitution{edge}", of.eta, "-", relations["eta"]),
        (
            "λ",
            f"static uplift acceleration over g{edge}",
            of.uplift,
            "-",
            relations["lambda"],
        ),
        (
            "a_scale",
            f"scale of the ground acceleration{edge}",
            of.a_scale,
            "-",
            relations["a_scale"],
        ),
    ]


def _restrained_rows(row: Mapping[str, Any]) -> list[ParameterRow]:
    """Return the rows of a body with its ties and tendon on one edge; row: of the
    details.
    """
    held = f"with its ties and tendon (side: {row['side']})"
    meaning = f"static uplift acceleration over g {held}"
    rows: list[ParameterRow] = [("λ", meaning, row["lambda"], "-", _LIFTS)]
    if row["equilibrium"] != "none":
        relation = _EQUILIBRIUM.format(math.degrees(row["equilibrium"]))
        meaning = f"first equilibrium {held}"
        rows.append(("θ", meaning, row["equilibrium"], "rad", relation))
    return rows

"""The texts of a report: the demand and each verdict in words, and the parameters of a
structure with their relations.
"""

import math
import re
from collections.abc import Sequence

from ..documents.quantities import DEFAULT_GRAVITY
from ..dynamics.method import LINEAR
from ..dynamics.outcome import Outcome
from ..motions import Motion
from ..motions.grid import Grid
from ..responses.check import Verdict
from ..structures import RockingParameters, Side

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
_CYCLES = re.compile(r"(.+), ([\d.]+) cycles?")


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
    match, omega = _CYCLES.fullmatch(motion.name), float(grid.frequency.values[0])
    name, count = match.groups() if match else (motion.name, None)
    cycles = {None: "", "1": "one cycle of ", "0.5": "half a cycle of "}.get(
        count, f"{count} cycles of "
    )
    at = (
        f"{omega / math.tau:.4g} Hz"
        if grid.frequency.name == "omega_g"
        else f"{grid.frequency.name} = {omega:.4g}"
    )
    return (
        f"{cycles}a{'n' if name[0].lower() in 'aeiou' else ''} {name} of {size} at"
        f" {at}{upwards}"
    )


def verdict_plainly(v: Verdict) -> str:
    """Return a verdict in a sentence or two."""
    first = (
        None
        if v.first_overturning_a is None
        else f"{v.first_overturning_a / DEFAULT_GRAVITY:.3g} g"
    )
    if v.outcome == Outcome.FAILED:
        said = "Not known: the computation failed."
    elif v.outcome.overturned:
        said = f"Falls: it {v.outcome.sentence}."
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
        said = (
            f"Stands: it rocks to {100.0 * (v.theta_ratio or 0.0):.2g} % of its"
            " critical angle."
        )
        if (
            first is not None
            and v.capacity_demand is not None
            and v.capacity_demand < 1.0
        ):
            said += f" Weaker shaking, from {first}, overturns it."
    if v.unsettled:
        said += " A change of the demand in its last digits changes this."
    return (
        said
        + f" It {v.coupling}." * bool(v.coupling)
        + " Its base would slide." * (v.slides and not v.coupling)
        + " This is by the linear equation alone." * (v.model == LINEAR.model)
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
    v, falls = worst_of(verdicts), sum(one.falls for one in verdicts)
    said = verdict_plainly(v) + (
        f" It falls under {falls} of {len(verdicts)} motions."
        if falls and len(verdicts) > 1
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
    known = dict(_RELATIONS.get(s.structure, {}))
    if s.eta_source != "momentum" or s.one_sided:
        known.pop("eta", None)
    impact = "θ̇ after = η θ̇ before " + (
        "the impact that leaves this edge" if s.sides else "an impact"
    )
    free = ", of the free body" * bool(s.restraints)
    equilibrium, lifts = (
        "{:.4g}°: beyond it the structure does not come back on its own",
        "it lifts at ẍg = λ g",
    )
    rows = [
        (
            symbol,
            f"{meaning}, {of.side} edge" if isinstance(of, Side) else meaning,
            value,
            unit,
            known.get(key, relation),
        )
        for of in s.sides or (s,)
        for key, symbol, meaning, value, unit, relation in (
            (
                "p",
                "p",
                "frequency parameter",
                of.p,
                "rad/s",
                "θ̈ = p² (θ − α sgn θ − a_scale ẍg/g)",
            ),
            (
                "alpha",
                "α",
                "critical angle",
                of.alpha,
                "rad",
                equilibrium.format(math.degrees(of.alpha)) + free,
            ),
            ("eta", "η", "coefficient of restitution", of.eta, "-", impact),
            (
                "lambda",
                "λ",
                "static uplift acceleration over g",
                of.uplift,
                "-",
                lifts + free,
            ),
            (
                "a_scale",
                "a_scale",
                "scale of the ground acceleration",
                of.a_scale,
                "-",
                "α/λ; 1 for a single body",
            ),
        )
    ]
    for row in s.details.get("restrained", ()) if s.restraints else ():
        held = f"with its ties and tendon (side: {row['side']})"
        rows.append(
            (
                "λ",
                f"static uplift acceleration over g {held}",
                row["lambda"],
                "-",
                lifts,
            )
        )
        if row["equilibrium"] != "none":
            rows.append(
                (
                    "θ",
                    f"first equilibrium {held}",
                    row["equilibrium"],
                    "rad",
                    equilibrium.format(math.degrees(row["equilibrium"])),
                )
            )
    if s.damping:
        rows.append(("ζ", "viscous damping", s.damping, "-", "θ̈ is less by 2 ζ p θ̇"))
    return [
        {
            "symbol": symbol,
            "meaning": meaning,
            "value": f"{value:.6g}",
            "unit": unit,
            "relation": relation,
        }
        for symbol, meaning, value, unit, relation in rows
    ]

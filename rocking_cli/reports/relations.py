"""The rocking parameters of a structure as the rows of a table: symbol, meaning, value, unit and relation."""

import math

from ..structures import RockingParameters, Side

_RELATIONS = {  # closed forms of the paper by kind
    "block": {"p": "p² = 3 g/(4 R)", "eta": "η = 1 − 3/2 sin² α"},
    "point_mass": {"p": "p² = g/R", "eta": "η = cos 2α"},
    "arch": {"p": "Eqs. 3.5 to 3.9, the linkage at its unstable equilibrium", "lambda": "least over all admissible mechanisms"},
}


def parameter_rows(s: RockingParameters) -> list[dict[str, str]]:
    """The rows for p, alpha, eta, lambda and a_scale, of each edge if the edges differ, and for the damping if there is any."""
    known = dict(_RELATIONS.get(s.structure, {}))
    if s.eta_source != "momentum" or s.one_sided:
        known.pop("eta", None)
    impact = "θ̇ after = η θ̇ before " + ("the impact that leaves this edge" if s.sides else "an impact")
    equilibrium = "{:.4g}°: beyond it the structure does not come back on its own"
    rows = [
        (symbol, f"{meaning}, {of.side} edge" if isinstance(of, Side) else meaning, value, unit, known.get(key, relation))
        for of in s.sides or (s,)
        for key, symbol, meaning, value, unit, relation in (
            ("p", "p", "frequency parameter", of.p, "rad/s", "θ̈ = p² (θ − α sgn θ − a_scale ẍg/g)"),
            ("alpha", "α", "critical angle", of.alpha, "rad", equilibrium.format(math.degrees(of.alpha))),
            ("eta", "η", "coefficient of restitution", of.eta, "-", impact),
            ("lambda", "λ", "static uplift acceleration over g", of.uplift, "-", "it lifts at ẍg = λ g"),
            ("a_scale", "a_scale", "scale of the ground acceleration", of.a_scale, "-", "α/λ; 1 for a single body"),
        )
    ]
    if s.damping:
        rows.append(("ζ", "viscous damping", s.damping, "-", "θ̈ is less by 2 ζ p θ̇"))
    return [
        {"symbol": symbol, "meaning": meaning, "value": f"{value:.6g}", "unit": unit, "relation": relation}
        for symbol, meaning, value, unit, relation in rows
    ]

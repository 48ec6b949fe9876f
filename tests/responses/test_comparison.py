"""Structures side by side collapse to one dimensionless curve."""

from rocking_cli import Method, load_structures, parse_grid, sine
from rocking_cli.responses.comparison import collapse, compare


def test_three_structures_collapse_to_one_dimensionless_curve():
    # Each is computed from its own a_g and omega_g; Fig. 8.
    structures = load_structures([f"{body},restitution=0.8" for body in ("block:0.5x2", "spire:1.5x12", "arch:10x1.5x157.5deg")])
    for grid in ("A=2,Omega=4", "A=3.1,Omega=5.3", "a_g=0.4g,f_g=1.4"):
        responses = compare(structures, sine(), parse_grid(grid), [Method()])
        assert len({r.structure.p for r in responses}) == 3
        peaks = [max(abs(x["theta"]) for x in r.rows()) for r in responses]
        assert max(peaks) / min(peaks) > 1.4
        assert collapse(responses, "linear") < 1e-10

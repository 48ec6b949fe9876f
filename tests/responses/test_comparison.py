"""Structures side by side collapse to one dimensionless curve."""

from rocking_cli import build_structure, parse_documents, parse_grid, sine
from rocking_cli.dynamics.method import Method
from rocking_cli.responses.comparison import collapse, compare


def test_three_structures_collapse_to_one_dimensionless_curve():
    # Each is computed from its own a_g and omega_g; Fig. 8.
    texts = ("kind: block\nwidth: 0.5\nheight: 2", "kind: spire\nbase_radius: 1.5\nheight: 12")
    structures = [build_structure(parse_documents(f"{t}\nrestitution: 0.8")[0]) for t in texts]
    structures.append(build_structure(parse_documents("kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\nrestitution: 0.8")[0]))
    for grid in ("A=2,Omega=4", "A=3.1,Omega=5.3", "a_g=0.4g,f_g=1.4"):
        responses = compare(structures, sine(), parse_grid(grid), [Method()])
        assert len({r.structure.p for r in responses}) == 3
        peaks = [max(abs(x["theta"]) for x in r.records()) for r in responses]
        assert max(peaks) / min(peaks) > 1.4
        assert collapse(responses, "linear") < 1e-10

"""Draws of structures whose numbers have spreads, against exact distributions."""

import numpy as np
import pytest

from rocking_cli import DocumentError, UsageError, parse_documents, read_documents
from rocking_cli.structures.draws import draws


def drawn(text, n=1024, seed=0):
    (document,) = read_documents(text)
    return list(draws(document, n, seed))


@pytest.mark.parametrize(
    ("height", "sd", "quantiles"),
    [
        # lambda = w/h of a block: P(lambda <= x) = Phi((x h - w)/s),
        # s^2 = s_w^2 + x^2 s_h^2
        ("2", 0.005, (0.24177573, 0.25, 0.25822427)),
        ("2+-0.02", 0.0055912886, (0.24087115, 0.25, 0.25926416)),
    ],
)
def test_the_ratio_of_two_normals(height, sd, quantiles):
    found = [draw.parameters.uplift for draw in drawn(f"block:0.5+-0.01x{height}")]
    assert np.std(found) == pytest.approx(sd, rel=0.02)
    # Points of a Sobol sequence fill the ranks evenly: errors far below 1/sqrt(1024).
    assert np.quantile(found, (0.05, 0.5, 0.95)) == pytest.approx(quantiles, abs=1.5e-4)


def test_a_seed_gives_its_draws():
    text = "block:0.5+-0.01x2,restitution=0.85..0.95"
    assert [d.values for d in drawn(text, 8)] == [d.values for d in drawn(text, 8)]
    assert drawn(text, 8) != drawn(text, 8, seed=1)
    assert len(drawn(text, 5)) == 8


def test_no_draw_leaves_the_range_of_its_key():
    eta = [d.values["restitution"] for d in drawn("block:0.5x2,restitution=0.9+-0.06")]
    assert max(eta) <= 1.0
    # The cut normal: its mean is below that of the whole one.
    assert np.mean(eta) == pytest.approx(0.9 - 0.00624, abs=1e-3)


def test_draws_that_make_no_structure_are_told():
    (document,) = parse_documents("{kind: block, width: 1.2 .. 3, height: 2}")
    found = list(draws(document, 64))
    faults = [draw for draw in found if draw.parameters is None]
    # Momentum gives eta < 0 for a block wider than sqrt(2) times its height.
    assert all(draw.values["width"] > 2.0 * 2.0**0.5 for draw in faults)
    assert faults
    assert all("restitution" in draw.fault for draw in faults)


MECHANISM = """
kind: mechanism
restitution: 0.8
bodies:
  one: {corners: [[0, 0], [0.5, 0], [0.5, 2], [0, 2]], density: 1800 +- 50}
joints: [{hinge: [ground, one], at: [0.5, 0]}]
loads: [{body: one, at: [0.25, 2], weight: 17.658 kN, inertia: vertical}]
"""


def test_a_body_of_a_mechanism_has_a_spread_too():
    (document,) = parse_documents(MECHANISM)
    found = list(draws(document, 16))
    assert all(set(draw.values) == {"bodies.one.density"} for draw in found)
    # The load of 1800 kg is not driven: lambda = (m + 1800)/m w/h, m = 1 m3 density.
    masses = np.array([draw.values["bodies.one.density"] for draw in found])
    assert masses.std() == pytest.approx(50.0, rel=0.2)
    uplifts = [draw.parameters.uplift for draw in found]
    assert uplifts == pytest.approx((1.0 + 1800.0 / masses) * 0.25, rel=1e-12)


@pytest.mark.parametrize(
    ("exact", "spread", "key"),
    [
        ("[0.5, 0], [0.5, 2]", "[0.5 +- 0.01, 0], [0.5, 2]", "corners"),
        ("at: [0.25, 2]", "at: [0.25 m +- 10 mm, 2]", "at"),
    ],
)
def test_a_point_takes_no_spread(exact, spread, key):
    (document,) = parse_documents(MECHANISM.replace(exact, spread))
    with pytest.raises(DocumentError, match=rf"{key}: found a .* they take no spread"):
        list(draws(document, 8))


def test_a_key_inside_a_list_has_a_spread_too():
    (document,) = parse_documents(
        "{kind: stack, pieces: [{width: 1, height: 1}, {width: 0.5 +- 2 %, height: 2}]}"
    )
    values = [draw.values for draw in draws(document, 8)]
    assert all(set(value) == {"pieces.1.width"} for value in values)


def test_nothing_to_draw():
    with pytest.raises(UsageError, match="no number with a spread"):
        drawn("block:0.5x2")
    with pytest.raises(UsageError, match="from 2 to"):
        drawn("block:0.5+-0.01x2", 1)

"""Spires: reference values, independent integrations of the cracked tip, limits and
refusals.
"""

import math

import numpy as np
import pytest
from support.documents import built

from rocking_cli.structures.kinds.spire import Spire
from rocking_cli.structures.mechanics.stacked_pieces import frustum_moments

THIN = "kind: spire\nbase_radius: 1.5\nheight: 12\n"
CRACKED = THIN + "thickness: 0.15\ncrack: diagonal\n"


def test_cracked_spire_has_the_reference_values():
    # p and alpha to the digits of an independent evaluation. That evaluation gave eta =
    # 0.185625; the integration below, which shares nothing with the program, gives
    # 0.185631.
    s = built(CRACKED)
    assert s.p == pytest.approx(1.115994, abs=1e-6)
    assert s.alpha == pytest.approx(0.139125, abs=1e-6)
    assert s.eta == pytest.approx(0.1856306, abs=1e-7)
    assert s.details["crack_height"] == pytest.approx(10.8)


def integrate_spire(base, height, thickness, tip, crack, count=2500):
    """M, x, z moments, I about (base, 0) and the shared u.w by vertical columns: z in
    closed form, midpoints in the plan.
    """
    slope = crack / (base + base * (1 - crack / height))
    rho = (np.arange(count) + 0.5) / count * base
    totals = np.zeros(5)
    for angle in (np.arange(count) + 0.5) / count * math.pi:
        x = rho * math.cos(angle)
        wall = np.maximum(0.0, tip * (1 - rho / (base - thickness)))
        top = height * (1 - rho / base)
        low = np.maximum(wall, slope * (base - x))
        high = np.maximum(top, low)
        d1, d2, d3 = high - low, (high**2 - low**2) / 2, (high**3 - low**3) / 3
        totals[:4] += [
            (rho * f).sum() for f in (d1, x * d1, d2, (x - base) ** 2 * d1 + d3)
        ]
        low = np.maximum(wall, slope * (base + np.abs(x)))
        high = np.maximum(top, low)
        totals[4] += (
            rho * ((x * x - base * base) * (high - low) + (high**3 - low**3) / 3)
        ).sum()
    return totals * 2.0 * base * math.pi / count**2


@pytest.mark.parametrize(
    "geometry",
    [
        (1.5, 12.0, 0.15, 10.8, 10.8),
        (1.5, 12.0, 0.4, 9.0, 5.0),
        pytest.param((2.0, 7.0, 0.2, 7.0, 3.0), marks=pytest.mark.soak),
        pytest.param((1.5, 12.0, 0.3, 9.6, 6.0), marks=pytest.mark.soak),
    ],
)
def test_cracked_spire_equals_an_independent_integration(geometry):
    mass, x, z, inertia, shared = integrate_spire(*geometry)
    spire = Spire(*geometry)
    body = spire.rocking()
    assert body.mass == pytest.approx(mass, rel=2e-6, abs=0)
    assert (body.x / body.mass, body.z / body.mass) == pytest.approx(
        (x / mass, z / mass), rel=2e-6, abs=0
    )
    assert body.about(geometry[0], 0.0) / body.mass == pytest.approx(
        inertia / mass, rel=2e-6, abs=0
    )
    assert spire.restitution() == pytest.approx(shared / inertia, abs=1e-6)


def test_quadrature_has_converged_to_1e_9(monkeypatch):
    from rocking_cli.structures.kinds import spire

    one = Spire(1.5, 12.0, 0.15, 10.8, 10.8)
    fine = [*one.rocking(), *one.rocking(both=True)]
    monkeypatch.setattr(spire, "_NODES", 24)
    assert [*one.rocking(), *one.rocking(both=True)] == pytest.approx(
        fine, rel=1e-9, abs=1e-15
    )


def test_a_whole_spire_is_its_cone_without_the_hollow():
    outer, hollow = (
        frustum_moments(1.5, 0.0, 12.0),
        frustum_moments(1.5 - 0.3, 0.0, 9.0),
    )
    mass, z, inertia = (
        a - b
        for a, b in zip(
            (outer.mass, outer.z, outer.polar),
            (hollow.mass, hollow.z, hollow.polar),
            strict=True,
        )
    )
    s = built(THIN + "thickness: 0.3\ntip_height: 9")
    assert s.alpha == pytest.approx(math.atan2(1.5, z / mass), rel=1e-13, abs=0)
    assert s.p**2 == pytest.approx(
        9.81 * mass * math.hypot(1.5, z / mass) / (inertia + mass * 1.5**2),
        rel=1e-13,
        abs=0,
    )


def test_crack_at_the_base_and_vanishing_wall():
    uncracked, at_base = built(THIN), built(THIN + "crack: diagonal\ncrack_height: 0")
    for name in ("p", "alpha", "eta"):
        assert getattr(at_base, name) == pytest.approx(
            getattr(uncracked, name), rel=1e-10, abs=0
        )
    barely = built(THIN + "crack_height: 1e-9")
    assert (barely.p, barely.alpha, barely.eta) == pytest.approx(
        (uncracked.p, uncracked.alpha, uncracked.eta), rel=1e-8, abs=0
    )
    thin, film = (
        built(THIN + "crack_height: 8"),
        built(THIN + "thickness: 1e-6\ncrack_height: 8"),
    )
    assert (film.p, film.alpha, film.eta) == pytest.approx(
        (thin.p, thin.alpha, thin.eta), rel=1e-6, abs=0
    )

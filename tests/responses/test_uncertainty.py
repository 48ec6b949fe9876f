"""Shares of draws, their intervals and indices, against exact values.

The exact values are closed forms (rectangular pulse, linear: first overturning at
alpha g/(1 - exp(-p t_d))), Phi((w* - mean)/sd) with the boundary w* of an independent
integrator, and quadratures over one key (independent programs, 2026).
"""

import numpy as np
import pytest

import rocking_cli as rk
from rocking_cli.dynamics.method import governing_method
from rocking_cli.dynamics.outcome import safe
from rocking_cli.envelopes.together import (
    Together,
    first_overturning_of,
    outcomes_at,
)
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.given import demand_of
from rocking_cli.responses.shares import (
    ShareOfDraws,
    first_order_indices,
    index_interval,
)
from rocking_cli.structures.draws import draws, sobol


@pytest.mark.parametrize(
    ("count", "low", "high"),
    [
        (0, 0.0, 0.0035959404),
        (12, 0.0060695054, 0.020380742),
        (512, 0.46892483, 0.53107517),
        (1024, 0.99640406, 1.0),
    ],
)
def test_the_interval_of_clopper_and_pearson(count, low, high):
    found = ShareOfDraws.of(count, 1024)
    assert (found.low, found.high) == pytest.approx((low, high), rel=1e-7)


def test_indices_of_the_function_of_ishigami():
    x = np.pi * (2.0 * sobol(3, 1024, 0) - 1.0)
    y = (
        np.sin(x[:, 0])
        + 7.0 * np.sin(x[:, 1]) ** 2
        + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    )
    assert first_order_indices(x, y) == pytest.approx(
        [0.31390519, 0.44241114, 0.0], abs=0.03
    )
    assert not first_order_indices(x, 0.0 * y).any()


@pytest.mark.parametrize(("n", "width"), [(16, 0.3), (64, 0.1), (1024, 0.02)])
def test_the_interval_of_an_index_holds_it_and_few_draws_explain_nothing_for_sure(
    n, width
):
    """y = 2 a + b of uniform keys: the index of a is 4/5. With 16 bins of one draw each
    16 draws explained all of it.
    """
    keys = sobol(2, n, 0)
    y = 2.0 * keys[:, 0] + keys[:, 1]
    index = first_order_indices(keys, y)[0]
    low, high = index_interval(keys[:, 0], y)
    assert low < 0.8 < high
    assert low < index < 0.97
    assert width < high - low < 8.0 * width


def drawn(text, n=1024):
    (document,) = rk.read_documents(text)
    found = list(draws(document, n))
    keys = np.array([list(draw.values.values()) for draw in found])
    return [draw.parameters for draw in found], keys


def share_of_falls(structures, motion, grid=None):
    codes = outcomes_at(structures, *demand_of(motion, grid and rk.parse_grid(grid)))
    return ShareOfDraws.of(int(np.count_nonzero(~safe(codes))), codes.size)


@pytest.mark.parametrize(
    ("text", "grid", "exact"),
    [
        ("block:0.62+-0.01x2", "a_g=0.4g,f_g=1", 0.62248696),
        pytest.param(
            "block:0.5x2,restitution=0.85..0.95",
            "a_g=0.4g,f_g=1.5",
            0.773395,
            marks=pytest.mark.soak,
        ),
    ],
)
def test_the_share_that_falls(text, grid, exact):
    found = share_of_falls(drawn(text)[0], rk.sine(), grid)
    assert found.low < exact < found.high
    # A smooth boundary: Sobol points are far closer than the interval.
    assert found.share == pytest.approx(exact, abs=0.004)


@pytest.mark.soak
def test_two_windows_of_the_restitution_are_seen():
    """It falls for eta from 0.93182 to 0.93566 and above 0.93760 (independent
    program)."""
    motion = rk.read_motion("configs/motions/synthetic.at2")
    found = share_of_falls(drawn("block:0.5x2,restitution=0.85..0.95")[0], motion)
    assert found.share == pytest.approx(0.1624354, abs=0.004)


def rectangular(p, alpha):
    return f"parameters:p={p},alpha={alpha},eta=0.9,a_scale=1"


def test_first_overturning_and_the_indices_of_both_keys():
    structures, keys = drawn(rectangular("2.66+-0.15", "0.245+-0.01"))
    demand = demand_of(rk.pulse("rectangular"), rk.parse_grid("a_g=0.3g,T_g=0.5"))
    first = first_overturning_of(structures, *demand, [20.0] * len(structures))

    alpha, p = (
        np.array([getattr(s, key) for s in structures]) for key in ("alpha", "p")
    )
    closed = alpha * 9.81 / -np.expm1(-0.5 * p)
    assert first == pytest.approx(closed, rel=2e-6)

    assert first.mean() == pytest.approx(3.2734129, rel=2e-4)
    assert first.std() == pytest.approx(0.16085335, rel=0.02)
    assert np.quantile(first, (0.05, 0.5, 0.95)) == pytest.approx(
        (3.0149441, 3.2699753, 3.5435768), rel=2e-3
    )
    assert first_order_indices(keys, first) == pytest.approx(
        [0.30954771, 0.68993659], abs=0.03
    )


@pytest.mark.parametrize(
    "text",
    [
        "block:0.5+-0.01x2",
        "rigid:left=0.3+-0.01,right=0.35,height=1,gyration=0.7",
        pytest.param(
            "arch:radius=10,angle=157.5deg+-1deg,thickness=1.5,voussoirs=7",
            marks=pytest.mark.soak,
        ),
    ],
)
def test_a_draw_has_the_verdict_that_it_has_alone(text):
    structures, _ = drawn(text, 2)
    motion, grid = rk.pulse("rectangular"), rk.parse_grid("a_g=0.42g,T_g=0.5")
    codes = outcomes_at(structures, motion, grid)
    first = first_overturning_of(structures, motion, grid, [20.0] * 2)
    for structure, code, amplitude in zip(structures, codes, first, strict=True):
        alone = rk.check(structure, motion, grid)
        assert code == alone.outcome
        assert amplitude == pytest.approx(alone.first_overturning_a, rel=2e-6)


@pytest.mark.slow
def test_a_first_overturning_under_a_record_is_rounded_down():
    """Between two steps of 1 % there may be several overturning intervals."""
    motion = rk.read_motion("configs/motions/synthetic.at2")
    structures = drawn("block:0.5+-0.02x2", 2)[0][1:]
    demand = demand_of(motion)
    first = first_overturning_of(structures, *demand, [4.0] * len(structures))
    assert np.isfinite(first).all()
    for structure, amplitude in zip(structures, first, strict=True):
        stands = rk.parse_grid(f"a_g={float(amplitude)!r}", own_time=True)
        falls = rk.parse_grid(f"a_g={1.01 * float(amplitude)!r}", own_time=True)
        assert safe(outcomes_at([structure], motion, stands)).all()
        assert not safe(outcomes_at([structure], motion, falls)).any()


def test_a_draw_that_leaves_the_ground_falls_by_the_linear_equation_too():
    structures, _ = drawn("block:0.5+-0.05x0.6,restitution=0.6..0.9", 8)
    grid = rk.parse_grid("A=3,Omega=6")
    codes = outcomes_at(structures, rk.sine(), grid)
    assert rk.Outcome.LOST_CONTACT in codes
    for structure, code in zip(structures, codes, strict=True):
        assert code == rk.check(structure, rk.sine(), grid, a_max=None).outcome


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(
            "block:0.5+-0.05x2,restitution=0.85..0.95", marks=pytest.mark.soak
        ),
        rectangular("2.66", "0.245+-0.03"),
    ],
    ids=["equation of motion", "linear"],
)
def test_a_draw_has_its_own_weight_under_a_vertical_motion(text):
    """The weight over m g follows z_g'' / g, so over A it depends on alpha."""
    structures, _ = drawn(text, 16)
    motion, grid = (
        with_vertical(rk.sine(), rk.sine(), 0.5),
        rk.parse_grid("a_g=0.4g,f_g=1.2"),
    )
    codes = outcomes_at(structures, motion, grid)
    alone = [rk.check(one, motion, grid, a_max=None) for one in structures]
    assert codes.tolist() == [verdict.outcome for verdict in alone]
    cells = np.array([grid.cell(one) for one in structures])
    method = governing_method(*structures)
    together = Together(method, motion, structures, cells[:, 1])
    theta, _ = together.responses(np.arange(16), cells[:, 0])
    wanted = [v.theta_ratio for v in alone]
    assert theta == pytest.approx(np.array(wanted, dtype=float), abs=1e-8, nan_ok=True)
    assert any(one is not None for one in wanted)


def test_a_draw_that_slides_never_falls():
    """lambda is 0.25: half of the frictions keep the block from rocking."""
    structures, _ = drawn("block:0.5x2,friction=0.2..0.3", 64)
    grid = rk.parse_grid("a_g=0.5g,f_g=1")
    codes = outcomes_at(structures, rk.sine(), grid)
    first = first_overturning_of(structures, rk.sine(), grid, [20.0] * 64)
    for structure, code, amplitude in zip(structures, codes, first, strict=True):
        slides = structure.friction < 0.25
        assert safe(code) == slides
        assert np.isinf(amplitude) == slides

"""The check by the Italian code against the check values of its reference, which
another program computed.
"""

import numpy as np
import pytest
from support.documents import built

from rocking_cli import (
    FloorMode,
    SpectrumFile,
    UsageError,
    check,
    code_check,
    first_beyond,
    load_records,
    load_structures,
    parse_grid,
    sine,
)
from rocking_cli.motions.design_spectra import FloorSpectrum
from rocking_cli.motions.grid import as_recorded

G = 9.81
(BODY,) = load_structures("block:0.5x2")

# q = 2, SLV and SLC in g, at ground level with S = 1, by an independent program (SLV
# and SLC not below uplift).
TABLE = [
    ("0.5x2", None, 0.500, 0.250, 0.250),
    ("0.5x2", 0.4, 0.500, 0.537, 0.765),
    ("0.5x2", 0.8, 0.500, 0.250, 0.250),
    ("0.5x2", 1.2, 0.500, 0.250, 0.250),
    ("0.6x6", None, 0.200, 0.111, 0.174),
    ("0.6x6", 0.8, 0.200, 0.164, 0.242),
]


def motion_and_grid(period):
    """(motion, grid): the shipped record, or a cycle of a sine."""
    if period is not None:
        return sine(), parse_grid(f"a_g=0.3g,T_g={period}")
    (recording,) = load_records("configs/motions/synthetic.at2")
    return recording.motion, as_recorded(recording.acceleration)


@pytest.mark.parametrize(("size", "period", "linear", "slv", "slc"), TABLE)
def test_the_amplitudes_of_the_reference(
    size, period, linear, slv, slc, pytestconfig, monkeypatch
):
    monkeypatch.chdir(pytestconfig.rootpath)
    (body,) = load_structures(f"block:{size}")
    found = code_check(body, *motion_and_grid(period)).accepted()
    assert [a / G for a in found.values()] == pytest.approx(
        [linear, slv, slc], abs=0.0006
    )


@pytest.mark.parametrize(
    ("height", "slv", "slc"), [(2, 1.3759, 1.9164), (8, 2.7518, 3.8328)]
)
@pytest.mark.parametrize("width", [0.005, 0.01])
def test_the_secant_periods_of_a_slender_block_depend_on_its_height_alone(
    width, height, slv, slc
):
    # T_SLV = 4.30937 sqrt(h_G/g), T_SLC = 6.00233 sqrt(h_G/g), whatever b.
    found = code_check(
        built(f"kind: block\nwidth: {width}\nheight: {height}"),
        sine(),
        parse_grid("a_g=1,T_g=0.3"),
    )
    assert (found.slv.period, found.slc.period) == (
        pytest.approx(slv, abs=1e-4),
        pytest.approx(slc, abs=1e-4),
    )
    root = (0.5 * height / G) ** 0.5
    assert (found.slv.period / root, found.slc.period / root) == (
        pytest.approx(4.30937, rel=1e-5),
        pytest.approx(6.00233, rel=1e-5),
    )


def test_the_confidence_factor_divides_the_acceleration():
    motion = motion_and_grid(0.4)
    one, other = code_check(BODY, *motion), code_check(BODY, *motion, confidence=1.35)
    assert other.linear == pytest.approx(one.linear / 1.35)
    assert other.slv.period == pytest.approx(one.slv.period * 1.35**0.5)
    with pytest.raises(
        UsageError, match=r"found 0\.9; expected a confidence factor from 1"
    ):
        code_check(BODY, *motion, confidence=0.9)


def test_the_weaker_edge_decides():
    grid = parse_grid("a_g=1,T_g=0.4")
    both = code_check(
        built("kind: rigid\nleft: 0.3\nright: 0.5\nheight: 2\ngyration: 1.2"),
        sine(),
        grid,
    )
    weak = code_check(
        built("kind: rigid\nleft: 0.3\nright: 0.3\nheight: 2\ngyration: 1.2"),
        sine(),
        grid,
    )
    assert both.accepted() == pytest.approx(weak.accepted())


def test_the_demand_scales_the_amplitude():
    one, other = (
        code_check(BODY, sine(), parse_grid(f"a_g={a}g,T_g=0.4")) for a in (0.2, 0.6)
    )
    assert one.accepted() == pytest.approx(other.accepted())
    assert one.row()["code_slv_ratio"] == pytest.approx(
        3.0 * other.row()["code_slv_ratio"]
    )


def test_a_floor_compares_with_its_own_peak_and_spectrum():
    motion = motion_and_grid(0.4)
    ground, floor = (
        code_check(BODY, *motion),
        code_check(BODY, *motion, floor=[FloorMode(0.3, 0.05, 1.4)]),
    )
    on_floor, below = floor.slv.of.spectrum, ground.slv.of.spectrum
    assert isinstance(on_floor, FloorSpectrum)
    assert floor.linear == pytest.approx(ground.linear * below.pga / on_floor.pga)
    asked = on_floor.demand(floor.slv.period, 0.08)
    assert floor.slv.amplitude == pytest.approx(
        max(0.3 * G * 0.1 / asked, 0.5 * floor.linear), rel=1e-6
    )
    assert floor.promises(0.1, 0.1) == []  # its dynamics are those on the ground


@pytest.mark.slow
def test_the_rotation_is_passed_where_check_says():
    motion, grid = motion_and_grid(0.4)
    least = first_beyond(BODY, motion, grid)
    below, above = (
        check(
            BODY, motion, parse_grid(f"a_g={least * x},T_g=0.4"), a_max=None
        ).theta_ratio
        for x in (0.9995, 1.0005)
    )
    assert below < 0.4 < above
    assert least / G == pytest.approx(0.571, abs=1e-3)
    assert first_beyond(BODY, motion, grid, most=0.5 * G) is None


def test_a_sentence_where_the_code_promises_more():
    found = code_check(BODY, *motion_and_grid(0.4))  # 0.500, 0.537, 0.765 g
    assert found.promises(1.084 * G, 0.571 * G) == []
    assert found.promises(None, None) == []
    assert (
        found.promises(0.39 * G, 0.3 * G)[0]
        == "the q = 2 method accepts 0.500 g, the body overturns at 0.390 g"
    )
    assert found.promises(0.7 * G, 0.52 * G) == [
        "the SLV method accepts 0.537 g, theta exceeds 0.4 alpha at 0.520 g",
        "the SLC method accepts 0.765 g, the body overturns at 0.700 g",
    ]


PERIODS = np.array([0.0, 0.15, 0.5, 2.0, 4.0])
SITE = SpectrumFile("life", PERIODS, G * np.array([0.3, 0.8, 0.8, 0.2, 0.05]))


def test_each_limit_state_has_its_own_spectrum():
    """SLV and SLC have other return periods: 1.4 times the spectrum of SLV at SLC takes
    as many times the amplitude from it, and leaves SLV as it is.
    """
    stronger = SpectrumFile("collapse", PERIODS, 1.4 * SITE.values)
    one, other, alone = (
        code_check(BODY, site=SITE, site_slc=SITE),
        code_check(BODY, site=SITE, site_slc=stronger),
        code_check(BODY, site=SITE),
    )
    assert other.ratios()["code_slv"] == one.ratios()["code_slv"]
    assert other.slc.ratio == pytest.approx(one.slc.ratio / 1.4, rel=1e-12)
    assert (other.demand, other.demand_a) == ("life and collapse", SITE.pga)
    assert (alone.slc, alone.row()["code_slc"]) == (None, None)
    assert alone.accepted() == {
        key: a for key, a in one.accepted().items() if key != "code_slc"
    }
    collapse = code_check(BODY, site_slc=stronger)
    assert collapse.ratios() == {"code_slc": other.slc.ratio}


@pytest.mark.parametrize(("points", "known"), [(5, {"SLV"}), (4, set())])
def test_a_spectrum_that_ends_before_a_period_gives_no_answer(points, known):
    """The secant periods of the slender body are 1.3759 and 1.9164 s, as of a height
    of 2 m times 2.5.
    """
    body = built("kind: block\nwidth: 0.1\nheight: 12.5")
    site = SpectrumFile("s", PERIODS[:points], SITE.values[:points])
    found = code_check(body, site=site, site_slc=site)
    assert set(found.reached()) == known
    assert {state for state in ("SLV", "SLC") if found.verified(state)} <= known
    assert set(found.unanswered) == {"SLV", "SLC"} - known
    assert "found periods up to" in found.unanswered["SLC"]
    assert found.sentence("code_slc").startswith("SLC: not known (")
    assert found.linear is not None  # its demand is the peak


def test_a_check_needs_a_demand():
    with pytest.raises(
        UsageError, match="no demand; expected a motion, or the spectrum of a site"
    ):
        code_check(BODY)
    with pytest.raises(UsageError, match="the amplitude is 0; expected a positive one"):
        code_check(BODY, sine(), parse_grid("a_g=0,f_g=1"))

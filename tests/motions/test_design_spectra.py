"""Spectra as a code takes them: the formulas evaluated by hand, another integrator, and
files that are refused.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.refusals import refuses

from rocking_cli import (
    DocumentError,
    FloorMode,
    SpectrumFile,
    UsageError,
    pulse,
    read_record,
    read_spectrum,
    sine,
)
from rocking_cli.motions.design_spectra import (
    FloorSpectrum,
    MotionSpectrum,
    damping_factor,
)

SITE = SpectrumFile(
    "site", np.array([0.0, 0.2, 0.6, 4.0]), np.array([2.0, 5.0, 5.0, 0.5])
)


def test_a_file_keeps_its_values_before_the_peak():
    factors = [damping_factor(x) for x in (0.05, 0.08, 0.10, 0.5)]
    assert factors == pytest.approx([1.0, math.sqrt(10 / 13), math.sqrt(10 / 15), 0.55])
    eta = factors[1]
    assert SITE.acceleration(np.array([0.0, 0.1, 0.4, 2.3]), 0.08) == pytest.approx(
        [2.0, 3.5, 5.0 * eta, 2.75 * eta]
    )
    assert SITE.demand(2.3, 0.08) == pytest.approx(
        2.75 * eta * (2.3 / (2 * math.pi)) ** 2
    )
    with pytest.raises(
        UsageError, match=r"found periods up to 4 s; expected up to 4\.5 s"
    ):
        SITE.demand(4.5, 0.08)


def test_the_spectrum_of_a_floor():
    # C7.2.5 to 10 by hand: T_k = 0.4 s on the plateau, xi_k = 5 %, gamma psi = 1.3, the
    # element with 8 %.
    floor = FloorSpectrum(SITE, [FloorMode(0.4, 0.05, 1.3)])
    a_z = 5.0 * 1.3 * math.sqrt(1.01)
    gain = 1.1 / math.sqrt(0.05) * math.sqrt(10 / 13)
    assert floor.pga == pytest.approx(a_z)
    here = floor.acceleration(np.array([0.16, 0.32, 0.43, 0.88]), 0.08)
    assert here == pytest.approx(
        [
            gain * a_z / (1 + (gain - 1) * 0.5**1.6),
            gain * a_z,
            gain * a_z,
            gain * a_z / gain,
        ]
    )
    both = FloorSpectrum(SITE, [FloorMode(0.4, 0.05, 1.3), FloorMode(0.4, 0.05, -1.3)])
    assert both.pga == pytest.approx(math.sqrt(2) * a_z)
    at_first, later = floor.acceleration(np.array([0.4, 3.0]), 0.08)
    assert floor.demand(0.7, 0.08) == pytest.approx(
        at_first * (1.1 * 0.4 / (2 * math.pi)) ** 2
    )  # not below that of its first mode
    assert floor.demand(3.0, 0.08) == pytest.approx(later * (3.0 / (2 * math.pi)) ** 2)


@pytest.mark.parametrize("name", ["sine", "rectangular-impulse"])
def test_the_displacement_under_a_pulse_by_another_integrator(name):
    motion, amplitude, omega, period, xi = pulse(name), 3.0, 5.0, 1.4, 0.08
    w, end = 2 * math.pi / period, motion.duration / omega
    found = solve_ivp(
        lambda t, y: [
            y[1],
            -2 * xi * w * y[1]
            - w * w * y[0]
            - amplitude * float(motion.value(omega * t)),
        ],
        (0.0, end + period),
        [0.0, 0.0],
        max_step=end / 500,
        rtol=1e-9,
        atol=1e-12,
    )
    spectrum = MotionSpectrum.of(motion, amplitude, omega)
    (a,) = spectrum.acceleration(np.array([period]), xi)
    assert a / w**2 == pytest.approx(np.abs(found.y[0]).max(), rel=1e-3)


@pytest.mark.slow
def test_the_demand_of_a_motion_is_the_largest_up_to_the_period(pytestconfig):
    record = read_record(pytestconfig.rootpath / "configs/motions/synthetic.at2")
    spectrum = MotionSpectrum.of(record.motion, 0.5 * record.motion.acceleration, 1.0)
    periods = np.linspace(0.03, 1.6, 300)
    assert spectrum.pga == pytest.approx(0.5 * np.abs(record.acceleration).max())
    most = (spectrum.acceleration(periods, 0.08) * (periods / (2 * math.pi)) ** 2).max()
    assert spectrum.demand(1.6, 0.08) == pytest.approx(most, rel=1e-4)
    assert MotionSpectrum.of(sine(), 1.0, 2 * math.pi).pga == pytest.approx(
        1.0, rel=1e-6
    )  # without rounding of its peak


def test_a_file_is_read_in_its_units(tmp_path):
    (tmp_path / "a.csv").write_text(
        "T [s];Se [g];remark\n0;0.2;x\n0.5;0.5;y\n2;0.1;z\n"
    )
    found = read_spectrum(tmp_path / "a.csv")
    assert (found.name, found.pga, found.values) == (
        "a",
        pytest.approx(1.962),
        pytest.approx([1.962, 4.905, 0.981]),
    )


REFUSED = [
    (
        "T,S_a [g],Se [g]\n0,1,1\n",
        "a.csv:2:3: found both S_a and Se; expected one of them",
    ),
    ("T,x\n0,1\n", "a.csv:2:1: found T, x; expected the columns T and S_a"),
    ("T,S_a [m/s2]\n0,1\n0.5,m\n", "a.csv:3:2: S_a: found 'm'; expected "),
    (
        "T,S_a [m/s2]\n0,1\n0.5,2\n0.5,3\n",
        "a.csv:4:1: T: found '0.5'; expected periods that rise, of one spectrum",
    ),
    (
        "T,S_a [m/s2]\n0,1\n0.5,-2\n",
        "a.csv:3:2: S_a: found '-2 m/s2'; expected a positive acceleration",
    ),
    (
        "T,S_a [m/s2],damping\n0,1,0.05\n0.5,2,0.08\n",
        "a.csv:3:3: damping: found 0.08; expected 0.05",
    ),
    ("T,S_a [m/s2]\n0,1\n", "a.csv: found 1 point of a spectrum; expected two or more"),
    (
        "T,S_a [m/s2]\n0.1,1\n1,2\n",
        "a.csv: found the first period 0.1 s; expected a first period up to 0.03 s",
    ),
    ("T [Hz],S_a [g]\n0,1\n1,2\n", "a.csv:2:1: T: found '0 Hz'; expected a time"),
    (
        "T,S_a [kg]\n0,1\n1,2\n",
        "a.csv:2:2: S_a: found '1 kg'; expected an acceleration",
    ),
    ("T,Se\n0,1\n1,2\n", "a.csv:2:2: Se: found '1' without a unit; expected "),
    ("", "a.csv: found 0 points of a spectrum"),
]
test_a_malformed_file_is_refused_with_its_place = refuses(
    read_spectrum, DocumentError, REFUSED, file="a.csv"
)


def test_the_demand_of_a_file_does_not_fall_with_the_period():
    """S_a = 10 - 2 T up to 4 s: T^2 S_a is largest at 10/3 s, where it is 1000/27; then
    a second rise of S_a to a lower S_d.
    """
    falling = SpectrumFile(
        "record", np.array([0.0, 4.0, 4.2, 5.0]), np.array([10.0, 2.0, 2.0, 0.1])
    )
    unit = (2.0 * math.pi) ** 2
    assert falling.demand(3.0, 0.05) * unit == pytest.approx(4.0 * 9.0, rel=1e-14)
    for period in (10.0 / 3.0, 3.9, 4.1, 4.9):
        assert falling.demand(period, 0.05) * unit == pytest.approx(
            1000.0 / 27.0, rel=1e-14
        )


@pytest.mark.parametrize(
    "text",
    [
        "T [s];Sa [g]\n0;0,3\n0,15;0,75\n4;0,05\n",
        "# site\nT\tS_a [g]\n0\t0,3\n0,15\t0,75\n4\t0,05\n",
        "T [s]  Se [g]\n0     0,3\n0,15  0,75\n4     0,05\n",
        '"T [s]", "Se [g]"\n"0", "0.3"\n"0.15", "0.75"\n"4", "0.05"\n',
    ],
)
def test_a_spectrum_in_the_forms_of_spreadsheets(text, tmp_path):
    (tmp_path / "s.csv").write_text(text)
    found = read_spectrum(tmp_path / "s.csv")
    assert found.periods.tolist() == [0.0, 0.15, 4.0]
    assert found.values == pytest.approx([2.943, 7.3575, 0.4905])

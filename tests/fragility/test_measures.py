"""Measures of pulses and structures: closed forms; site pulses and what is wrong with
them.
"""

from __future__ import annotations

import numpy as np
import pytest
from support.documents import built
from support.packages import installed
from support.record_layouts import wave
from support.refusals import refuses
from support.synthetic_records import pulsed, recorded

from rocking_cli import DocumentError, UsageError, pulse, sine
from rocking_cli.fragility.measures import (
    compared,
    members_of,
    pulse_intensity,
    site_pulses,
)
from rocking_cli.motions.intensity_measures import GROUP, MEASURES, Measure, measure_of
from rocking_cli.motions.reading import factor_to
from rocking_cli.motions.response_spectra import mean_acceleration

OF_PULSES = [name for name, one in MEASURES.items() if one.of_record is None]
BLOCK = built("kind: block\nwidth: 0.5\nheight: 2")
RECORDING = recorded(wave(300, 3.0), 0.02, factor=-2.0)


def test_the_measures_of_pulses_are_their_closed_forms():
    a, w, t = 3.0, 8.0, 2 * np.pi / 8.0
    sines = (
        a,
        2 * a / w,
        2 * np.pi * a / w**2,
        np.pi / (2 * 9.81) * a * a * np.pi / w,
        4 * a / w,
    )
    boxes = (
        a,
        a * t,
        a * t * t / 2 + a * t * t,
        np.pi / (2 * 9.81) * (a * a * t + 0.25 * a * a * 2 * t),
        a * t + 0.5 * a * 2 * t,
    )
    for motion, closed in ((sine(), sines), (pulse("rectangular-impulse"), boxes)):
        found = pulse_intensity(motion, a, w)
        assert (
            found.pga,
            found.pgv,
            found.pgd,
            found.arias,
            found.cav,
        ) == pytest.approx(closed, rel=1e-6, abs=0)


def test_measures_of_a_structure_are_dimensionless():
    member = pulsed(sine(), 3.0, 8.0)
    values = {name: member.measured(MEASURES[name], BLOCK) for name in OF_PULSES}
    g, tan = 9.81, 0.25
    assert values["nPGA"] == pytest.approx(3.0 / (tan * g), rel=1e-12)
    assert values["nPGV"] == pytest.approx(BLOCK.p * (6.0 / 8.0) / (g * tan), rel=1e-6)
    assert values["nPGD"] == pytest.approx(
        BLOCK.p**2 * (6.0 * np.pi / 64.0) / (g * tan), rel=1e-6
    )


def test_site_pulses_have_units_weights_and_shapes(tmp_path):
    (tmp_path / "p.csv").write_text(
        "a_g,T_g,weight,pulse\n0.3 g,0.5 s,1,\n2.0,0.8,3,rectangular\n"
    )
    one, two = site_pulses(tmp_path / "p.csv")
    assert (one.acceleration, two.acceleration) == pytest.approx((0.3 * 9.81, 2.0))
    assert (one.omega, two.omega) == pytest.approx((4 * np.pi, 2.5 * np.pi))
    assert (one.weight, two.weight) == (0.5, 1.5)
    assert (one.motion.name, two.motion.name) == ("sine 1 cycle", "rectangular")


REFUSED = [
    ("a_g,f\n1,2\n", "line 1: unknown column 'f'; expected a_g"),
    ("a_g,f_g,T_g\n1,2,3\n", "expected a_g and one of f_g, T_g, omega_g"),
    ("a_g,f_g\n1,2\n0.3 m,2\n", "line 3: a_g: found '0.3 m'; expected an acceleration"),
    ("a_g,f_g\n1,-2\n", "line 2: f_g: found '-2'; expected a positive number"),
    ("a_g,f_g,weight\n1,2,\n", "line 2: weight: found ''"),
    ("a_g,f_g,pulse\n1,2,sinus\n", "line 2: unknown pulse 'sinus'; expected"),
    ("a_g,f_g\n", "holds no pulse"),
    ("", "line 1: found the columns none; expected a_g"),
]
test_wrong_tables_are_refused_with_their_place = refuses(
    site_pulses, DocumentError, REFUSED, file="p.csv"
)


def test_unknown_measures_and_those_that_a_motion_lacks_are_refused():
    with pytest.raises(UsageError, match=r"`im`: found 'PGX'; expected PGA, PGV"):
        measure_of("PGX")
    with pytest.raises(UsageError, match="sine 1 cycle: its PGV is 0"):
        pulsed(sine(), 0.0, 1.0).measured(MEASURES["PGV"], BLOCK)


def test_spectral_measures_are_of_records_only():
    (member,) = members_of([RECORDING])
    measure = measure_of("avgsa(0.5,1)")
    assert (measure.name, measure.dimension, measure.power) == (
        "AvgSA(0.5,1)",
        "acceleration",
        1.0,
    )
    assert member.measured(measure, BLOCK) == pytest.approx(
        2.0 * mean_acceleration(RECORDING.record, np.array([0.5, 1.0])), rel=1e-14
    )
    with pytest.raises(
        UsageError, match=r"found AvgSA\(0.5,1\) of a pulse; expected a record"
    ):
        pulsed(sine(), 1.0, 1.0).measured(measure, BLOCK)


def test_the_efficiency_of_spectral_measures_is_compared_under_records():
    names = [m.name for m in compared(members_of([RECORDING]), measure_of("SA(0.3)"))]
    assert names == [*MEASURES, "SA(0.5)", "SA(1)", "SA(2)", "AvgSA(1)", "SA(0.3)"]
    of_pulses = compared([pulsed(sine(), 1.0, 1.0)], MEASURES["PGA"])
    assert [m.name for m in of_pulses] == OF_PULSES


def test_a_measure_of_records_alone_is_compared_under_records_alone(monkeypatch):
    longest = Measure("longest", "time", of_record=lambda record: record.duration)
    monkeypatch.setitem(MEASURES, "longest", longest)
    of_pulses = compared([pulsed(sine(), 1.0, 1.0)], MEASURES["PGA"])
    assert "longest" in {m.name for m in compared(members_of([RECORDING]), longest)}
    assert "longest" not in {m.name for m in of_pulses}


ENERGY = """
import numpy as np
DIMENSION, POWER = "number", 2.0
def value(record):
    return float(np.sum(record.acceleration**2)) * record.dt
"""


def test_an_installed_package_adds_a_measure_of_records(monkeypatch, tmp_path):
    installed(monkeypatch, tmp_path, GROUP, "energy", ENERGY)
    measure = measure_of("energy")
    assert (measure.name, measure.unit, measure.power) == ("energy", "", 2.0)
    (member,) = members_of([RECORDING])
    record = RECORDING.record
    energy = float(np.sum(record.acceleration**2)) * record.dt
    assert member.measured(measure, BLOCK) == pytest.approx(4.0 * energy)
    (of_site,) = site_pulses(_site(tmp_path))
    with pytest.raises(UsageError, match="found energy of a pulse; expected a record"):
        of_site.measured(measure, BLOCK)
    with pytest.raises(UsageError, match=r"found 'energi'; .* .did you mean 'energy'"):
        measure_of("energi")
    assert factor_to(record, f"energy={9 * energy!r}") == pytest.approx(3.0, rel=1e-12)


def _site(tmp_path):
    (tmp_path / "site.csv").write_text("a_g,f_g\n1,2\n")
    return tmp_path / "site.csv"


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("value = [1.0]", "AttributeError: module 'rocking_odd' has no"),
        (
            "DIMENSION = 'number'\ndef value(r): pass",
            "TypeError: value returns NoneType, not a number",
        ),
        (
            "DIMENSION = 'number'\ndef value(r): return 1 / 0",
            "ZeroDivisionError: division by zero",
        ),
        (
            "DIMENSION = 'weight'\ndef value(r): return 1",
            "ValueError: found the dimension 'weight'",
        ),
        (
            "DIMENSION = 'number'\nPOWER = 0\ndef value(r): return 1",
            "ValueError: found the dimension 'number' and the power 0.0",
        ),
        (
            "DIMENSION = 'number'\ndef value(r): return [1.0]",
            "TypeError: value returns list, not a number",
        ),
        ("import nothing_at_all", "ModuleNotFoundError: No module named 'nothing_at"),
    ],
)
def test_a_measure_of_a_package_that_is_none_is_told(
    monkeypatch, tmp_path, source, words
):
    installed(monkeypatch, tmp_path, GROUP, "odd", source)
    told = "`im`: the measure odd, which the package of-odd adds and which cannot be"
    with pytest.raises(UsageError, match=f"^{told} used: {words}"):
        members_of([RECORDING])[0].measured(measure_of("odd"), BLOCK)

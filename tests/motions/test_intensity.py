"""Intensity measures: closed forms, and a quadrature in many small steps that shares no
code.
"""

import math

import numpy as np
import pytest
from support.record_layouts import plain_record as record
from support.record_layouts import wave
from support.synthetic_records import at2_file, far_shock, near_shock

from rocking_cli.motions.intensity import intensity
from rocking_cli.motions.records import read_record


@pytest.mark.requirement(
    "Measures of a record are integrals of its straight lines",
    "motions/intensity_measures.py",
    "Measures of a record",
)
def test_a_triangle_exactly():
    """a rises from 0 to 3 m/s2 in 2 s and falls back in 2 s: v = 6 m/s and d = 12 m at
    the end, the integral of a^2 is 12 m2/s3.
    """
    found = intensity(record([0.0, 3.0, 0.0], 2.0))
    assert (found.pga, found.pga_time, found.pgv, found.pgd, found.cav) == (
        3.0,
        2.0,
        6.0,
        12.0,
        6.0,
    )
    assert found.arias == pytest.approx(math.pi / (2 * 9.81) * 12.0, rel=1e-14, abs=0)
    # 6 (t/2)^3 = 5 % of 12 on the way up, and by symmetry 95 % on the way down
    at_5 = 2.0 * 0.1 ** (1 / 3)
    assert found.d5_95 == pytest.approx(4.0 - 2.0 * at_5, rel=1e-14, abs=0)
    assert found.d5_75 == pytest.approx(
        4.0 - 2.0 * 0.5 ** (1 / 3) - at_5, rel=1e-14, abs=0
    )


def test_extremes_between_the_samples():
    """a = 1 - t from 0 to 2 s: v = t - t^2/2 is largest at t = 1, between the samples,
    and 0 at the end; then a pulse brings it back.
    """
    found = intensity(record([1.0, -1.0], 2.0))
    assert (found.pgv, found.cav) == (0.5, 1.0)
    assert found.pgd == pytest.approx(4.0 / 2.0 - 8.0 / 6.0, rel=1e-14, abs=0)
    # a = 1 - t to 4 s: v = t - t^2/2 = 0 at 2 s, d = t^2/2 - t^3/6 is 2/3 m there and
    # -8/3 m at the end
    found = intensity(record([1.0, -3.0], 4.0))
    assert found.pgd == pytest.approx(8.0 / 3.0, rel=1e-14, abs=0)
    # and with the sign turned at the end, 1 - t to 2.2 s: the largest is the 2/3 m at t
    # = 2 s, between the samples
    found = intensity(record([1.0, -1.2], 2.2))
    assert found.pgd == pytest.approx(2.0 / 3.0, rel=1e-14, abs=0)


def test_a_quadrature_in_many_small_steps():
    """Each interval in 400 parts by Simpson's rule, and durations by interpolation:
    within the error of that.
    """
    samples, dt, parts = wave(300, 2.0) + 0.01, 0.02, 400
    t = np.linspace(0.0, dt * 299, 299 * parts + 1)
    a = np.interp(t, dt * np.arange(300), samples)
    h = t[1]
    middle = 0.5 * (a[1:] + a[:-1])
    v = np.concatenate([[0.0], np.cumsum(h * middle)])
    d = np.concatenate(
        [[0.0], np.cumsum(h * (v[:-1] + h * (2.0 * a[:-1] + a[1:]) / 6.0))]
    )
    energy = np.concatenate(
        [[0.0], np.cumsum(h / 6.0 * (a[:-1] ** 2 + 4.0 * middle**2 + a[1:] ** 2))]
    )
    found = intensity(record(samples, dt))
    assert found.pgv == pytest.approx(np.abs(v).max(), rel=1e-7, abs=0)
    assert found.pgd == pytest.approx(np.abs(d).max(), rel=1e-7, abs=0)
    assert found.cav == pytest.approx(np.sum(h * np.abs(middle)), rel=1e-6, abs=0)
    assert found.arias == pytest.approx(math.pi / 19.62 * energy[-1], rel=1e-12, abs=0)
    at = np.interp([0.05, 0.75, 0.95], energy / energy[-1], t)
    assert found.d5_75 == pytest.approx(at[1] - at[0], abs=1e-6)
    assert found.d5_95 == pytest.approx(at[2] - at[0], abs=1e-6)


def test_scaled_mirrored_and_refined_records():
    samples = wave(500, 3.0)
    plain = intensity(record(samples, 0.01))
    mirrored, doubled = (
        intensity(record(-samples, 0.01)),
        intensity(record(2.0 * samples, 0.01)),
    )
    assert mirrored == plain
    assert (doubled.pga, doubled.pgv, doubled.pgd, doubled.cav) == tuple(
        2.0 * x for x in (plain.pga, plain.pgv, plain.pgd, plain.cav)
    )
    assert doubled.arias == 4.0 * plain.arias
    fine = np.interp(np.arange(4 * 499 + 1) / 4.0, np.arange(500), samples)
    refined = intensity(record(fine, 0.0025))
    for name in ("pga", "pga_time", "pgv", "pgd", "arias", "cav", "d5_75", "d5_95"):
        assert getattr(refined, name) == pytest.approx(
            getattr(plain, name), rel=1e-11, abs=0
        ), name


def test_a_record_that_is_zero_throughout_measures_nothing():
    found = intensity(record(np.zeros(10), 0.01))
    assert found == type(found)(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("made", "peak", "strong", "highest"),
    [(far_shock, 4.0, (9.0, 10.0), 19.6), (near_shock, 3.4, (20.0, 21.0), 5.2)],
)
def test_the_synthetic_records_keep_their_character(
    tmp_path, made, peak, strong, highest
):
    """Peak, duration of the strong phase, and the frequency [Hz] below which 95 % of
    the energy lies: what is measured with these records stays comparable.
    """
    samples, dt = made()
    found = intensity(read_record(at2_file(tmp_path / "record.at2", samples, dt)))
    energy = np.cumsum(np.abs(np.fft.rfft(samples)) ** 2)
    f95 = np.fft.rfftfreq(samples.size, dt)[np.searchsorted(energy, 0.95 * energy[-1])]
    assert found.pga == pytest.approx(peak, rel=1e-6)
    assert strong[0] < found.d5_95 < strong[1]
    assert f95 == pytest.approx(highest, abs=0.1)

"""Slices of spectra and quantiles over a set of records, read back from the figure that
would be saved.
"""

import math

import numpy as np
import pytest
from support.axes import lines, same
from support.record_layouts import wave

from rocking_cli import (
    Axis,
    Method,
    Outcome,
    Record,
    Recording,
    SpectraFile,
    UsageError,
    overturned,
)
from rocking_cli.dynamics.outcome import falls
from rocking_cli.envelopes.closed_form import peak_after_impact
from rocking_cli.reports.figures.slices import SHARES, record_quantiles, slice_of
from rocking_cli.spectra.record_scene import angles_scene
from rocking_cli.spectra.sweep import write_scene
from rocking_cli.spectra.sweep_options import SweepOptions


@pytest.fixture
def towers(swept):
    return swept(
        "configs/block.yaml",
        "configs/spire.yaml",
        "--grid",
        "a_g=0.1g:1.2g:23,f_g=0.5:2:7",
    )


def test_bars_stand_where_a_body_left_the_ground_too(swept, drawn):
    path = swept(
        "block:1.6x2,restitution=0.6",
        "--grid",
        "a_g=1.8g:1.9g:3,f_g=1.144",
        "--model",
        "nonlinear",
    )
    (axes,) = drawn(path, cut="f_g=1.144").axes
    with SpectraFile(path) as file:
        assert set(file.array("outcome").flat) == {Outcome.LOST_CONTACT}
    (bars,) = axes.collections
    assert len(bars.get_paths()) == 1
    assert axes.get_title().endswith("bars: overturned or lost contact")


def test_a_slice_is_a_row_of_the_file_with_bars_where_it_overturns(
    drawn, spectrum_file
):
    with SpectraFile(spectrum_file) as file:
        frequency, amplitude = file.grid.frequency.values, file.grid.amplitude.values
        block = file.block(0, slice(None))
    at = int(np.abs(frequency - 5.0).argmin())
    figure = drawn(spectrum_file, cut="Omega=5")
    (axes,) = figure.axes
    shown = lines(axes)
    assert set(shown) == {r"$\eta$ = 0.9", "Eq. 2.7, after the first impact"}
    same(shown[r"$\eta$ = 0.9"], amplitude, block["theta_ratio"][at])
    peaks = shown["Eq. 2.7, after the first impact"][1]
    assert np.array_equal(
        np.isnan(peaks),
        [
            a < 1.0 or np.isnan(peak_after_impact(a, frequency[at], 0.9))
            for a in amplitude
        ],
    )
    assert axes.get_title().splitlines()[0] == r"$\eta$ = 0.9"
    assert (
        rf"one cycle of a sine, linear equation, $\Omega$ = {frequency[at]:.4g}"
        in axes.get_title()
    )
    assert (
        figure.remark
        == f"slice at Omega = {frequency[at]:.6g}, the nearest of the file"
    )
    (bars,) = axes.collections
    covered = np.zeros(amplitude.size, dtype=bool)
    for path in bars.get_paths():
        (left, _), (right, _) = path.vertices.min(axis=0), path.vertices.max(axis=0)
        covered |= (amplitude >= left) & (amplitude <= right)
    np.testing.assert_array_equal(covered, overturned(block["outcome"][at]))
    other = drawn(spectrum_file, cut="A=3").axes[0]
    same(
        next(iter(lines(other).values())),
        frequency,
        block["theta_ratio"][:, int(np.abs(amplitude - 3.0).argmin())],
    )
    assert (other.get_xlabel(), other.get_ylabel()) == (
        r"$\Omega = \omega_g/p$ [-]",
        r"$\theta_{max}/\alpha$ [-]",
    )


def test_any_axis_of_the_request_is_an_axis_of_the_slice(drawn, towers):
    with SpectraFile(towers) as file:
        by_frequency = [
            slice_of(file, cut)
            for cut in (
                "f_g=1.5",
                "T_g=0.66666667",
                f"omega_g={3 * math.pi!r}",
                "f_g=1.5 Hz",
            )
        ]
        by_amplitude = [
            slice_of(file, cut) for cut in ("a_g=0.6g", f"a_g={0.6 * 9.81!r}")
        ]
        ends = [
            slice_of(file, cut).coordinate
            for cut in (
                "f_g=0.5",
                "f_g=2",
                "omega_g=3.14159",
                "omega_g=12.5664",
                "a_g=1.2g",
                "a_g=11.772",
            )
        ]
    assert {s.coordinate for s in by_frequency} == {by_frequency[0].coordinate}
    assert by_frequency[0].coordinate == pytest.approx(3 * math.pi, rel=1e-14)
    assert {s.coordinate for s in by_amplitude} == {by_amplitude[0].coordinate}
    assert ends == pytest.approx(
        [math.pi, 4 * math.pi, math.pi, 4 * math.pi, 1.2 * 9.81, 1.2 * 9.81], rel=1e-12
    )
    figure = drawn(towers, cut="f_g=1.6")
    assert figure.remark == "slice at f_g = 1.5 Hz, the nearest of the file"
    assert figure.axes[0].get_xlabel() == "$a_g$ [g]"
    assert list(lines(figure.axes[0])) == [
        r"Column, $\eta$ = 0.9118",
        r"Spire, $\eta$ = 0.8322",
    ]


BESIDE = {
    "B=3": (
        r"expected omega_g=3.14159 to 12.5664 \(f_g=0.5 to 2, T_g=0.5 to 2\) or"
        r" a_g=0.981 to 11.772"
    ),
    "f_g=2.1": "found 'f_g=2.1'",
    "a_g=2g": "found 'a_g=2g'",
    "a_g=1 Hz": "found 'a_g=1 Hz'",
    "T_g=0": "found 'T_g=0'",
    "a_g": "found 'a_g'",
}


def test_a_slice_beside_the_file_is_refused_with_what_it_holds(towers):
    with SpectraFile(towers) as file:
        for cut, words in BESIDE.items():
            with pytest.raises(UsageError, match=words):
                slice_of(file, cut)


ALPHAS, PERIODS = (
    Axis("alpha", np.array([0.15, 0.85])),
    Axis("T", np.array([0.5, 1.2, 5.0])),
)


@pytest.fixture(scope="module")
def spectra(tmp_path_factory):
    path = tmp_path_factory.mktemp("records") / "r.h5"
    peaks = (1.0, 2.5, 4.0, -12.0, 45.0)
    records = [
        Recording(
            Record(f"r{i}", "text", None, 0.1, wave(20, p), None, "m/s2", "s", f"{i}")
        )
        for i, p in enumerate(peaks)
    ]
    write_scene(
        angles_scene(ALPHAS, PERIODS, records, 0.5, Method()),
        path,
        SweepOptions(workers=1, check=0),
    )
    return path


def test_quantiles_of_five_records(spectra):
    with SpectraFile(spectra) as file:
        found, theta, outcome = (
            record_quantiles(file),
            file.array("theta_ratio"),
            file.array("outcome"),
        )
    fell = falls(outcome)
    assert {Outcome.OVERTURNED_AFTER_IMPACT, Outcome.LOST_CONTACT} <= set(outcome[fell])
    assert not fell.all()
    for j in range(2):
        for k in range(3):
            ordered = sorted(
                np.inf if fell[i, j, k] else theta[i, j, k] for i in range(5)
            )
            assert found[:, j, k].tolist() == [ordered[0], ordered[2], ordered[4]], (
                "the first, third and fifth of five"
            )
    assert SHARES == (0.16, 0.5, 0.84)


def test_the_figure_has_a_line_and_a_band_for_each_angle(spectra, drawn):
    with SpectraFile(spectra) as file:
        median = record_quantiles(file)[1]
    figure = drawn(spectra)
    curves = figure.axes[0]
    for line, row in zip(curves.get_lines(), median, strict=True):
        assert line.get_xdata().tolist() == PERIODS.values.tolist()
        np.testing.assert_array_equal(
            line.get_ydata(), np.where(np.isinf(row), np.nan, row)
        )
    assert len(curves.collections) == 2
    assert "median and 16 to 84 % of 5 records, linear equation" in curves.get_title()
    assert figure.axes[1].get_ylabel() == "$p$ [rad/s]"
    assert len(drawn(spectra, structure="r1").axes) == 1, "the map of one of them"

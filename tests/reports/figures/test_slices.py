"""Slices of spectra, read back from the figure that would be saved."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.axes import lines, same

from rocking_cli import Outcome, UsageError, overturned
from rocking_cli.reports.figures.slices import slice_of
from rocking_cli.spectra.file.reader import SpectraFile


@pytest.fixture
def towers(rocking, tmp_path):
    call = ("spectrum", "configs/block.yaml", "configs/spire.yaml", "--grid", "a_g=0.1g:1.2g:23,f_g=0.5:2:7", "-o", "t.h5", "-q")
    assert rocking(*call).returncode == 0
    return tmp_path / "t.h5"


def test_bars_stand_where_a_body_left_the_ground_too(rocking, drawn, tmp_path):
    call = ("spectrum", "block:1.6x2,restitution=0.6", "--grid", "a_g=1.8g:1.9g:3,f_g=1.144", "--model", "nonlinear", "-o", "l.h5", "-q")
    assert rocking(*call).returncode == 0
    (axes,) = drawn(tmp_path / "l.h5", cut="f_g=1.144").axes
    with SpectraFile(tmp_path / "l.h5") as file:
        assert set(file.array("outcome").flat) == {Outcome.LOST_CONTACT}
    (bars,) = axes.collections
    assert len(bars.get_paths()) == 1
    assert axes.get_title().endswith("bars: overturned or lost contact")


def test_a_slice_is_a_row_of_the_file_with_bars_where_it_overturns(drawn, spectrum_file):
    with SpectraFile(spectrum_file) as file:
        frequency, amplitude = file.grid.frequency.values, file.grid.amplitude.values
        block = file.block(0, slice(None))
    at = int(np.abs(frequency - 5.0).argmin())
    figure = drawn(spectrum_file, cut="Omega=5")
    (axes,) = figure.axes
    ((label, line),) = lines(axes).items()
    assert label == r"$\eta$ = 0.9"
    same(line, amplitude, block["theta_ratio"][at])
    assert axes.get_title().splitlines()[0] == r"$\eta$ = 0.9"
    assert rf"sine, 1 cycle, linear equation, $\Omega$ = {frequency[at]:.4g}" in axes.get_title()
    assert figure.told == f"slice at Omega = {frequency[at]:.6g}, the nearest of the file"
    (bars,) = axes.collections
    covered = np.zeros(amplitude.size, dtype=bool)
    for path in bars.get_paths():
        (left, _), (right, _) = path.vertices.min(axis=0), path.vertices.max(axis=0)
        covered |= (amplitude >= left) & (amplitude <= right)
    np.testing.assert_array_equal(covered, overturned(block["outcome"][at]))
    other = drawn(spectrum_file, cut="A=3").axes[0]
    same(next(iter(lines(other).values())), frequency, block["theta_ratio"][:, int(np.abs(amplitude - 3.0).argmin())])
    assert (other.get_xlabel(), other.get_ylabel()) == (r"$\Omega = \omega_g/p$ [-]", r"$\theta_{max}/\alpha$ [-]")


def test_any_axis_of_the_request_is_an_axis_of_the_slice(drawn, towers):
    with SpectraFile(towers) as file:
        by_frequency = [slice_of(file, cut) for cut in ("f_g=1.5", "T_g=0.66666667", f"omega_g={3 * math.pi!r}", "f_g=1.5 Hz")]
        by_amplitude = [slice_of(file, cut) for cut in ("a_g=0.6g", f"a_g={0.6 * 9.81!r}")]
        ends = [slice_of(file, cut).value for cut in ("f_g=0.5", "f_g=2", "omega_g=3.14159", "omega_g=12.5664", "a_g=1.2g", "a_g=11.772")]
    assert {s.value for s in by_frequency} == {by_frequency[0].value}
    assert by_frequency[0].value == pytest.approx(3 * math.pi, rel=1e-14)
    assert {s.value for s in by_amplitude} == {by_amplitude[0].value}
    assert ends == pytest.approx([math.pi, 4 * math.pi, math.pi, 4 * math.pi, 1.2 * 9.81, 1.2 * 9.81], rel=1e-12)
    figure = drawn(towers, cut="f_g=1.6")
    assert figure.told == "slice at f_g = 1.5 Hz, the nearest of the file"
    assert figure.axes[0].get_xlabel() == "$a_g$ [g]"
    assert list(lines(figure.axes[0])) == [r"Column, $\eta$ = 0.9118", r"Spire, $\eta$ = 0.8322"]


@pytest.mark.parametrize(
    ("cut", "words"),
    [("B=3", r"expected omega_g=3.14159 to 12.5664 \(f_g=0.5 to 2, T_g=0.5 to 2\) or a_g=0.981 to 11.772"),
     ("f_g=2.1", "found 'f_g=2.1'"), ("a_g=2g", "found 'a_g=2g'"), ("a_g=1 Hz", "found 'a_g=1 Hz'"), ("T_g=0", "found 'T_g=0'"),
     ("a_g", "found 'a_g'")],
)  # fmt: skip
def test_a_slice_beside_the_file_is_refused_with_what_it_holds(towers, cut, words):
    with SpectraFile(towers) as file, pytest.raises(UsageError, match=words):
        slice_of(file, cut)

"""Statistics of a set of records: quantiles by hand, where overturning and leaving the ground count as larger than every rotation."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import wave

from rocking_cli import Axis, Method, Outcome
from rocking_cli.motions.recording import Recording
from rocking_cli.motions.records import Record
from rocking_cli.reports.figures.slices import SHARES, record_quantiles
from rocking_cli.spectra.file.reader import SpectraFile
from rocking_cli.spectra.record_scene import angles_scene
from rocking_cli.spectra.sweep import SweepOptions, write_scene

ALPHAS, PERIODS = Axis("alpha", np.array([0.15, 0.85])), Axis("T", np.array([0.5, 1.2, 5.0]))


@pytest.fixture(scope="module")
def spectra(tmp_path_factory):
    path = tmp_path_factory.mktemp("records") / "r.h5"
    peaks = (1.0, 2.5, 4.0, -12.0, 45.0)
    records = [Recording(Record(f"r{i}", "text", None, 0.1, wave(20, p), None, "m/s2", "s", f"{i}")) for i, p in enumerate(peaks)]
    write_scene(angles_scene(ALPHAS, PERIODS, records, 0.5, Method()), path, SweepOptions(workers=1, check=0))
    return path


def test_quantiles_of_five_records(spectra):
    with SpectraFile(spectra) as file:
        found, theta, outcome = record_quantiles(file), file.array("theta_ratio"), file.array("outcome")
    fell = np.isin(outcome, [Outcome.OVERTURNED_NO_IMPACT, Outcome.OVERTURNED_AFTER_IMPACT, Outcome.LOST_CONTACT])
    assert {Outcome.OVERTURNED_AFTER_IMPACT, Outcome.LOST_CONTACT} <= set(outcome[fell])
    assert not fell.all()
    for j in range(2):
        for k in range(3):
            ordered = sorted(np.inf if fell[i, j, k] else theta[i, j, k] for i in range(5))
            assert found[:, j, k].tolist() == [ordered[0], ordered[2], ordered[4]], "the first, third and fifth of five"
    assert SHARES == (0.16, 0.5, 0.84)


def test_the_figure_has_a_line_and_a_band_for_each_angle(spectra, drawn):
    with SpectraFile(spectra) as file:
        median = record_quantiles(file)[1]
    figure = drawn(spectra)
    curves = figure.axes[0]
    for line, row in zip(curves.get_lines(), median, strict=True):
        assert line.get_xdata().tolist() == PERIODS.values.tolist()
        np.testing.assert_array_equal(line.get_ydata(), np.where(np.isinf(row), np.nan, row))
    assert len(curves.collections) == 2
    assert "median and 16 to 84 % of 5 records, linear equation" in curves.get_title()
    assert figure.axes[1].get_ylabel() == "$p$ [rad/s]"
    assert len(drawn(spectra, structure="r1").axes) == 1, "the map of one of them"

"""Overturning spectra: order statistics of first overturnings, which are those of the bodies themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from rocking_cli import Axis, build_structure, parse_documents
from rocking_cli.motions.recording import Recording
from rocking_cli.motions.records import Record
from rocking_cli.reports.figures.curves import overturning_spectra
from rocking_cli.reports.units import Units
from rocking_cli.spectra.record_envelope import Tracing, overturning_spectrum, tracing_records
from rocking_cli.spectra.record_scene import angles_scene, structures_scene

RECORDS = tuple(
    Recording(Record(f"R{n}", "plain", None, 0.1, np.array([0.0, a, 0.0, -a, 0.0, b, 0.0]), None, "m/s2", f"R{n}", "0" * 64))
    for n, (a, b) in enumerate(((1.0, 0.0), (1.0, 0.7), (0.5, 1.0)))
)


def test_quantiles_lie_between_the_order_statistics():
    scene = angles_scene(Axis("alpha", np.array([0.2])), Axis("T", np.array([3.0])), RECORDS, 0.9)
    body = scene.structures[0]
    rows = [{"alpha": 0.2, "T": 3.0, "A_from": a} for a in (3.0, None, 1.0, 2.0, 5.0)]
    (row,) = overturning_spectrum(scene, rows)
    scale = body.alpha / math.tan(body.alpha)
    assert [row[f"pga_ratio_{q}"] for q in (16, 50)] == pytest.approx([1.64 * scale, 3.0 * scale], rel=1e-12)
    assert row["pga_ratio_84"] is None
    assert (row["overturned"], row["records"], row["p"]) == (4, 5, pytest.approx(2.0 * math.pi / 3.0))


def test_a_block_is_the_same_by_its_angle_and_by_its_size():
    """2 pi/p = 1 s and alpha = 0.2: the block of that radius under the same records."""
    alpha, p = 0.2, 2.0 * math.pi
    (document,) = parse_documents(f"kind: block\nradius: {0.75 * 9.81 / p**2!r}\nalpha: {alpha}\nrestitution: 0.9")
    scenes = (
        angles_scene(Axis("alpha", np.array([alpha])), Axis("T", np.array([1.0])), RECORDS[:2], 0.9),
        structures_scene([build_structure(document)], RECORDS[:2]),
    )
    one, other = (next(overturning_spectrum(scene, tracing_records(Tracing(scene, 8.0, True), workers=1))) for scene in scenes)
    for key in ("p", "pga_ratio_16", "pga_ratio_50", "overturned", "records"):
        assert one[key] == pytest.approx(other[key], rel=1e-9)
    assert one["overturned"] == 2


def test_its_figure_draws_the_median_and_the_band_of_each_angle():
    def row(alpha, p, *ratios):
        return {"alpha": str(alpha), "p": str(p), **{f"pga_ratio_{q}": str(x) for q, x in zip((16, 50, 84), ratios, strict=True)}}

    rows = [row(0.1, 1, 2, 3, 4), row(0.1, 2, 1, 2, ""), row(0.2, 1, 3, 4, 5), row(0.2, 2, 2, 3, 4)]
    (axes,) = overturning_spectra(Figure(), rows, Units())
    assert [line.get_ydata().tolist() for line in axes.lines] == [[3.0, 2.0], [4.0, 3.0]]
    assert len(axes.collections) == 2

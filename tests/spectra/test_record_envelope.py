"""Overturning scales of records: their ends against an independent solution, the first
one alone, and its quantiles over records.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from support.documents import built
from support.record_layouts import rows, wave
from support.synthetic_records import motion_of_samples, noise, recorded

from rocking_cli import Axis, LinearEquation, Recording, System, Units, UsageError
from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.references.general_solver import solve_cell
from rocking_cli.envelopes.boundaries import Search
from rocking_cli.envelopes.capacity import RATIO
from rocking_cli.envelopes.scan import Scan
from rocking_cli.reports.figures.fragility_curves import overturning_spectra
from rocking_cli.spectra.record_envelope import (
    NONE,
    Tracing,
    overturning_spectrum,
    tracing_rows,
)
from rocking_cli.spectra.record_scene import angles_scene, structures_scene

BLOCK = built("kind: block\nwidth: 0.12 m\nheight: 0.5 m")
TWO = [recorded(wave(24, 3.0), 0.1, "a"), recorded(-0.5 * wave(24)[::-1], 0.1, "b")]
A_MAX = 2.1


@pytest.mark.slow
def test_ends_of_intervals_by_another_method():
    """On both sides of the first ends a Runge-Kutta method says what the row says; the
    rows are in all units the same.
    """
    (recording,) = TWO[:1]
    scene = structures_scene([BLOCK], [recording])
    found = list(tracing_rows(Tracing(scene, 3.0), workers=1))
    assert [row["A_to"] is None for row in found] == [False, True]
    problem, omega = scene.method.problem_of(BLOCK), 1.0 / BLOCK.p
    for row in found:
        for key, inside in (("from", 1e-7), ("to", -1e-7)):
            end = row[f"A_{key}"]
            if end is None:
                continue
            there, beyond = (
                solve_cell(recording.motion, end * (1.0 + d), omega, problem)[0]
                for d in (inside, -inside)
            )
            assert there.mode == row["mode"] != beyond.mode
            assert row[f"a_{key}"] == pytest.approx(end * BLOCK.alpha * 9.81, rel=1e-14)
            assert row[f"scale_{key}"] == pytest.approx(
                row[f"a_{key}"] / recording.acceleration, rel=1e-14
            )


@pytest.mark.soak
def test_a_scan_that_leads_the_march_changes_no_interval(monkeypatch):
    motion = motion_of_samples(noise(100, 0.06, 4), 0.06)
    omegas = np.array([0.3, 0.5])
    search = Search(
        System(LinearEquation(), Symmetric(0.9)),
        motion,
        4.0,
        ratio=RATIO,
        digits=1e-6,
        parts=128,
    )
    led = search.rows(omegas)
    monkeypatch.setattr(Scan, "supports", lambda *_: False)
    assert led == search.rows(omegas)
    assert sum(map(len, led)) > 9


@pytest.mark.slow
def test_the_first_is_the_first_of_all():
    scene = angles_scene(
        Axis("alpha", np.radians([8.0])), Axis("T", np.array([0.9, 40.0])), TWO[:1], 0.9
    )
    every: dict[tuple[float, float], float] = {}
    for row in tracing_rows(Tracing(scene, A_MAX), workers=2):
        every.setdefault((row["alpha"], row["T"]), row["A_from"])
    first = list(tracing_rows(Tracing(scene, A_MAX, first=True), workers=1))
    assert [(row["alpha"], row["T"]) for row in first] == [
        (s.alpha, t) for s in scene.structures for t in (0.9, 40.0)
    ]
    for row in first:
        assert "A_to" not in row
        assert (row["A_from"] is None) == (row["mode"] == NONE)
        there = every.get((row["alpha"], row["T"]))
        assert (
            row["A_from"] == pytest.approx(there, rel=1e-14)
            if there
            else row["A_from"] is None
        )
    assert {row["mode"] for row in first} >= {NONE, "after_impact"}


@pytest.mark.slow
def test_signs_of_unequal_sides():
    body = built(
        "kind: rigid\nleft: 0.06 m\nright: 0.04 m\nheight: 0.2 m\ngyration: 0.12 m"
    )
    tracing = Tracing(structures_scene([body], TWO[:1]), 2.1, first=True)
    by_sign = {
        row["sign"]: row["A_from"]
        for row in tracing_rows(tracing, sign="both", workers=1)
    }
    turned = structures_scene([body], [Recording(TWO[0].record, -1.0)])
    (other,) = tracing_rows(Tracing(turned, 2.1, first=True), sign="+", workers=1)
    assert other["A_from"] == pytest.approx(by_sign[-1], rel=1e-14)


def test_a_body_that_the_limit_does_not_lift():
    (row,) = tracing_rows(
        Tracing(structures_scene([BLOCK], TWO[:1]), 0.5, first=True), workers=1
    )
    assert (row["A_from"], row["mode"]) == (None, NONE)
    assert not list(
        tracing_rows(Tracing(structures_scene([BLOCK], TWO[:1]), 0.5), workers=1)
    )


def test_a_limit_that_is_none_is_refused():
    with pytest.raises(UsageError, match="a-max: found inf"):
        Tracing(structures_scene([BLOCK], TWO), math.inf)
    with pytest.raises(UsageError, match="the search varies the scale"):
        Tracing(structures_scene([BLOCK], TWO, Axis("A", np.array([1.0, 2.0]))))


@pytest.mark.slow
def test_the_command(rocking, refused, tmp_path):
    (tmp_path / "b.yaml").write_text("kind: block\nwidth: 0.12 m\nheight: 0.5 m\n")
    for name in ("a.txt", "b.txt"):
        (tmp_path / name).write_text(rows(wave(30, 3.0), 1, "{:.9e}"))
    call = (
        "--motion",
        "a.txt",
        "b.txt",
        "--unit",
        "m/s2",
        "--dt",
        "0.05",
        "--a-max",
        "1.1",
    )
    done = rocking("envelope", "b.yaml", *call, "--first", "--json", "--notes")
    one, other = done.records
    assert one | {"record": "b"} == other
    assert "model: nonlinear" in done.stderr
    done = rocking(
        "envelope",
        *call,
        "--alpha",
        "8deg",
        "--grid",
        "T=0.6",
        "--eta",
        "block",
        "--model",
        "linear",
        "--csv",
        "-q",
    )
    assert done.stdout.startswith("record,alpha [rad],T [s],A_from,A_to,mode,")
    assert "--alpha goes with records" in refused(
        2, "envelope", "b.yaml", "--grid", "f_g=1", "--alpha", "8deg"
    )
    assert "does not go with records" in refused(
        2, "envelope", "b.yaml", *call, "--closed-form"
    )


RECORDS = tuple(
    recorded([0.0, a, 0.0, -a, 0.0, b, 0.0], 0.1, f"R{n}")
    for n, (a, b) in enumerate(((1.0, 0.0), (1.0, 0.7), (0.5, 1.0)))
)


def test_quantiles_lie_between_the_order_statistics():
    scene = angles_scene(
        Axis("alpha", np.array([0.2])), Axis("T", np.array([3.0])), RECORDS, 0.9
    )
    body = scene.structures[0]
    rows = [{"alpha": 0.2, "T": 3.0, "A_from": a} for a in (3.0, None, 1.0, 2.0, 5.0)]
    (row,) = overturning_spectrum(scene, rows)
    scale = body.alpha / math.tan(body.alpha)
    assert [row[f"pga_ratio_{q}"] for q in (16, 50)] == pytest.approx(
        [1.64 * scale, 3.0 * scale], rel=1e-12
    )
    assert row["pga_ratio_84"] is None
    assert (row["overturned"], row["records"], row["p"]) == (
        4,
        5,
        pytest.approx(2.0 * math.pi / 3.0),
    )


def test_its_figure_draws_the_median_and_the_band_of_each_angle():
    def row(alpha, p, *ratios):
        return {
            "alpha": alpha,
            "p": p,
            **{f"pga_ratio_{q}": x for q, x in zip((16, 50, 84), ratios, strict=True)},
        }

    rows = [
        row(0.1, 1, 2, 3, 4),
        row(0.1, 2, 1, 2, None),
        row(0.2, 1, 3, 4, 5),
        row(0.2, 2, 2, 3, 4),
    ]
    (axes,) = overturning_spectra(Figure(), rows, Units())
    assert [line.get_ydata().tolist() for line in axes.lines] == [
        [3.0, 2.0],
        [4.0, 3.0],
    ]
    assert len(axes.collections) == 2

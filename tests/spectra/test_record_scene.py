"""Spectra of records: what the axes mean, against single responses; and that a set is
swept, resumed, cut and merged like a pulse.
"""

from __future__ import annotations

import math
import pickle

import h5py
import numpy as np
import pytest
import xarray
from support.documents import built, same_file
from support.record_layouts import wave
from support.refusals import refuses
from support.soak import quick
from support.synthetic_records import recorded

from rocking_cli import (
    Axis,
    Method,
    SpectraFile,
    UsageError,
    dimensionless_oscillator,
    intensity,
    merge,
    overturned,
    response,
)
from rocking_cli.dynamics.response import response_with_speed
from rocking_cli.motions.recording import Recording
from rocking_cli.reports.summary import summary_lines
from rocking_cli.spectra.file.same_scene import first_difference
from rocking_cli.spectra.record_scene import (
    angles_scene,
    block_of,
    scene_of_words,
    structures_scene,
)
from rocking_cli.spectra.scene import cut_into_units
from rocking_cli.spectra.sweep import spectrum_of, write_scene
from rocking_cli.spectra.sweep_options import SweepOptions

NONLINEAR = Method("nonlinear", 1e-8)
ALPHAS, PERIODS = (
    Axis("alpha", np.radians([10.0, 15.0])),
    Axis("T", np.array([1.0, 2.5, 6.0])),
)
BLOCK = built("kind: block\nwidth: 0.4 m\nheight: 2 m\nrestitution: 0.6")
SPIRE = built("kind: parameters\np: 2\nalpha: 0.15\neta: 0.5\nlambda: 0.2")


def recording(name: str, count: int, peak: float, factor: float = 1.0) -> Recording:
    return recorded(wave(count, peak), 0.02, name, factor)


RECORDS = recording("a", 70, 3.0), recording("b", 50, -4.0, -1.5)


def alone(structure, motion, acceleration, method):
    """The response of one structure to a record scaled to these peaks [m/s2]."""
    amplitude = structure.dimensionless_amplitude(np.atleast_1d(acceleration))
    return response(
        method.system_of(structure),
        motion,
        amplitude,
        np.array([1.0 / structure.p]),
        structure.eta,
    )


@pytest.mark.parametrize("name", ["scale", "a_g", "A"])
def test_columns_scale_each_record_under_each_structure(name):
    values = np.array([0.6, 2.2])
    some = RECORDS if name == "scale" else RECORDS[:1]
    found = spectrum_of(
        structures_scene([BLOCK, SPIRE], some, Axis(name, values)),
        SweepOptions(workers=1, check=0),
    )
    assert found.outcome.shape == (len(some), 2, 2)
    for i, recording in enumerate(some):
        for j, structure in enumerate((BLOCK, SPIRE)):
            own = {
                "scale": recording.acceleration * values,
                "a_g": values,
                "A": structure.ground_acceleration(values),
            }[name]
            expected = alone(structure, recording.motion, own, Method())
            assert np.array_equal(found.outcome[i, j], expected.outcome)
            assert found.theta_ratio[i, j] == pytest.approx(
                expected.theta_ratio, rel=1e-12, nan_ok=True
            )


def test_a_factor_is_part_of_the_record():
    """Its sign turns it over; its size is what a column `scale` multiplies."""
    there, here = RECORDS[1].motion, recording("b", 50, 4.0, 1.5).motion
    assert RECORDS[1].acceleration == pytest.approx(6.0, rel=1e-14, abs=0.0)
    assert there.acceleration == here.acceleration
    times = 0.02 * np.arange(49) + 0.007
    assert there.value(times) == pytest.approx(here.value(times), abs=1e-14)


@pytest.mark.parametrize("eta", quick((0.5, None), 0.5))
def test_rocking_spectra_over_alpha_and_size(eta):
    scene = angles_scene(ALPHAS, PERIODS, RECORDS, eta, NONLINEAR)
    found = spectrum_of(scene, SweepOptions(workers=1, check=0))
    for j, alpha in enumerate(ALPHAS.values.tolist()):
        expected = 1.0 - 1.5 * math.sin(alpha) ** 2 if eta is None else eta
        for k, period in enumerate(PERIODS.values.tolist()):
            p = 2.0 * math.pi / period
            radius = 0.75 * 9.81 / p**2  # of a block, from p^2 = 3g/(4R)
            block = built(
                f"kind: block\nradius: {radius!r}\nalpha: {alpha!r}\nrestitution:"
                f" {expected!r}"
            )
            by_itself = alone(
                block, RECORDS[0].motion, RECORDS[0].acceleration, NONLINEAR
            )
            assert found.outcome[0, j, k] == by_itself.outcome[0]
            assert found.theta_ratio[0, j, k] == pytest.approx(
                by_itself.theta_ratio[0], abs=1e-7, nan_ok=True
            )
    system, recording = NONLINEAR.system_of(scene.structures[1]), RECORDS[0]
    amplitude = scene.structures[1].dimensionless_amplitude(recording.acceleration)
    _, speed = response_with_speed(
        system, recording.motion, amplitude, PERIODS.values / (2.0 * math.pi)
    )
    assert found.velocity_ratio is not None
    assert found.velocity_ratio[0, 1] == pytest.approx(
        speed * ALPHAS.values[1], rel=1e-14, nan_ok=True
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "method", [pytest.param(Method(), marks=pytest.mark.soak), Method("nonlinear")]
)
def test_records_share_a_run_and_are_those_of_each_alone(method):
    """Of other lengths, steps and peaks, one with its samples far apart."""
    steps = {"b": (90, 0.005), "c": (24, 0.8), "d": (33, 0.03)}
    several = [
        recorded(wave(count, 4.0 + count % 7), dt, name)
        for name, (count, dt) in steps.items()
    ]
    axes = (
        Axis("alpha", np.radians([6.0, 50.0])),
        Axis("T", np.linspace(0.6, 9.0, 4)),
    )
    together, *alone = (
        spectrum_of(
            angles_scene(*axes, x, 0.6, method), SweepOptions(workers=1, check=0)
        )
        for x in (several, *zip(several))
    )
    for i, one in enumerate(alone):
        for name in ("theta_ratio", "outcome", "impacts_at_least", "velocity_ratio"):
            np.testing.assert_array_equal(
                getattr(together, name)[i], getattr(one, name)[0]
            )
    assert len(set(together.outcome.flat)) > 3


def test_blocks_of_all_angles_go_in_one_run_and_are_those_of_each_alone():
    short = (recording("a", 18, 6.0),)
    scene, own = (
        angles_scene(Axis("alpha", x), PERIODS, short, 0.5, NONLINEAR)
        for x in (ALPHAS.values, ALPHAS.values[1:])
    )
    assert (
        len({scene.system_of(s).march_key(scene.mixed) for s in scene.structures}) == 1
    )
    together, alone = (
        spectrum_of(x, SweepOptions(workers=1, check=0, quantities=("condition",)))
        for x in (scene, own)
    )
    for name in (
        "theta_ratio",
        "outcome",
        "impacts_at_least",
        "velocity_ratio",
        "condition",
    ):
        np.testing.assert_array_equal(
            getattr(together, name)[:, 1:], getattr(alone, name)
        )
    assert np.nanmin(alone.condition) > 0.0


def test_a_file_of_records_is_labelled(tmp_path):
    scene = angles_scene(ALPHAS, PERIODS, RECORDS, 0.5)
    write_scene(scene, tmp_path / "s.h5", SweepOptions(workers=1, check=0))
    with xarray.open_dataset(tmp_path / "s.h5") as data:
        assert (
            data.theta_ratio.dims
            == data.velocity_ratio.dims
            == ("record", "alpha", "T")
        )
        assert data.record.values.tolist() == ["a", "b"]
        measured = intensity(RECORDS[1].record)
        second = data.theta_ratio.sel(record="b")
        assert float(second.factor) == -1.5
        for name in ("pga", "pgv", "pgd", "arias", "cav", "d5_75", "d5_95"):
            assert float(second[name]) == getattr(measured, name)
            assert "units" in data[name].attrs
        assert (int(second.npts), float(second["dt"]), str(second.sha256.values)) == (
            50,
            0.02,
            "b" * 64,
        )
        assert data.p.values == pytest.approx(
            2.0 * np.pi / PERIODS.values, rel=1e-14, abs=0.0
        )
        assert data.tan_alpha.dims == data.eta.dims == ("alpha",)
    with SpectraFile(tmp_path / "s.h5") as file:
        assert file.array("outcome").shape == scene.shape
        assert next(file.cells())["record"] == "a"
        with pytest.raises(UsageError, match="expected the spectrum of a pulse"):
            file.motion()


def test_shards_and_workers_change_no_bit(tmp_path):
    scene = structures_scene([BLOCK], RECORDS, Axis("scale", np.linspace(0.5, 2.0, 4)))
    write_scene(
        scene, tmp_path / "whole.h5", SweepOptions(workers=2, chunk_cells=2, check=0)
    )
    parts = [tmp_path / f"{i}.h5" for i in (1, 2)]
    for i, path in enumerate(parts, 1):
        write_scene(
            scene, path, SweepOptions(workers=1, chunk_cells=2, check=0, shard=(i, 2))
        )
    assert merge(parts, tmp_path / "merged.h5").chunks == 2 * 2
    same_file(tmp_path / "merged.h5", tmp_path / "whole.h5")


def test_the_scene_states_a_hash_and_no_sample(tmp_path):
    write_scene(
        structures_scene([BLOCK], RECORDS),
        tmp_path / "s.h5",
        SweepOptions(workers=1, check=0),
    )
    with h5py.File(tmp_path / "s.h5") as file:
        assert len(file.attrs["scene"]) < 1500
    others = (RECORDS[0], Recording(RECORDS[1].record, 2.0))
    one, other = (
        structures_scene([BLOCK], some).identity() for some in (RECORDS, others)
    )
    assert first_difference(one, other)[0] == "records[1]"


def test_bad_scenes_are_refused():
    for arguments, words in (
        (([], RECORDS), "no structure"),
        (([BLOCK], []), "no record"),
        (([dimensionless_oscillator(eta=0.9)], RECORDS), "has no units"),
        (([BLOCK], RECORDS, PERIODS), "with structures, which have their own size"),
    ):
        with pytest.raises(UsageError, match=words):
            structures_scene(*arguments)
    with pytest.raises(UsageError, match="below a right one"):
        Axis("alpha", np.array([1.0, 1.6]))
    with pytest.raises(ValueError, match="eta"):
        block_of(1.3, None)


def test_what_travels_with_a_unit_is_its_own_records():
    many = [recording(chr(97 + i), 400, 3.0) for i in range(20)]
    scene = structures_scene([BLOCK], many)
    units = list(cut_into_units(scene, (1, 1)))[3:5]
    some = scene.only(units)
    assert len(pickle.dumps(some)) < len(pickle.dumps(scene)) / 8
    for unit in units:
        (few,), (all_of_them,) = (list(one.cells_of(unit)) for one in (some, scene))
        assert few.motion.value(1.0) == all_of_them.motion.value(1.0)


@pytest.mark.parametrize(
    ("words", "dimensions", "model"),
    [
        (
            {"axes": "scale=1:2:3"},
            {"record": 2, "structure": 1, "scale": 3},
            "nonlinear",
        ),
        ({"model": "linear"}, {"record": 2, "structure": 1, "scale": 1}, "linear"),
        (
            {"axes": "T=1:8:4", "alphas": "10deg,0.2rad,20deg"},
            {"record": 2, "alpha": 3, "T": 4},
            "nonlinear",
        ),
        (
            {"axes": "p=1:4:3,tan_alpha=0.1:0.3:2"},
            {"record": 2, "alpha": 2, "T": 3},
            "nonlinear",
        ),
    ],
)
def test_scenes_in_words(words, dimensions, model):
    scene = scene_of_words([] if "alpha" in dimensions else [BLOCK], RECORDS, **words)
    frame = scene.frame()
    assert {
        name: len(values) for name, values in frame.dimensions.items()
    } == dimensions
    assert scene.method.model == model
    if "alphas" in words:
        assert frame.dimensions["alpha"] == pytest.approx(
            [math.radians(10.0), 0.2, math.radians(20.0)]
        )
    if "p=" in words.get("axes", ""):
        assert frame.extra["p"][1] == pytest.approx([4.0, 2.5, 1.0], rel=1e-14, abs=0.0)
        assert frame.extra["tan_alpha"][1] == pytest.approx(
            [0.1, 0.3], rel=1e-14, abs=0.0
        )


def test_without_geometry_the_default_is_linear():
    assert scene_of_words([BLOCK, SPIRE], RECORDS).method.model == "linear"


REFUSED = [
    (([BLOCK], {"axes": "scale=1,A=2"}), "expected one axis: scale, A or a_g"),
    (
        ([BLOCK], {"axes": "T=1:2:2"}),
        "alpha or T with structures, which have their own",
    ),
    (
        ([BLOCK], {"alphas": "10deg"}),
        "alpha or T with structures, which have their own",
    ),
    (([], {"alphas": "10deg"}), "found alpha; expected .* together"),
    (([], {"alphas": "10deg", "axes": "A=3,p=3"}), "found A and p and alpha; expected"),
    (([], {"axes": "T=1:2:2"}), "together"),
    (
        ([], {"axes": "T=1:2:2", "alphas": "10deg", "etas": (0.9, 0.8)}),
        "found 2 values",
    ),
    (([], {"axes": "T=1:2:2", "alphas": "10deg,10deg"}), "an angle twice"),
    (
        ([], {"axes": "T=1:2:2", "alphas": "10 kg"}),
        "`alpha`: found '10 kg'; expected an angle",
    ),
    (([], {"axes": "T=1:2:2", "alphas": "95deg"}), "below a right one"),
    (([], {"axes": "T=1:2:2,alpha=0.1", "alphas": "5deg"}), "does not go with alpha"),
    (([BLOCK], {"axes": "f_g=1"}), "a record runs in its own time"),
    (([BLOCK], {"axes": "q=1"}), "unknown axis 'q'"),
]
test_words_that_make_no_scene = refuses(
    lambda given: scene_of_words(given[0], RECORDS, **given[1]), UsageError, REFUSED
)


def test_a_linear_sweep_tells_where_the_nonlinear_equation_ends_otherwise():
    scene = structures_scene([BLOCK, SPIRE], RECORDS, Axis("scale", np.array([1.6])))
    summary = spectrum_of(scene, SweepOptions(workers=1, check=4)).summary
    by_hand = 0
    for recording in RECORDS:
        ends = [
            alone(BLOCK, recording.motion, 1.6 * recording.acceleration, m).outcome[0]
            for m in (Method(), Method("nonlinear"))
        ]
        by_hand += int(overturned(ends[0]) != overturned(ends[1]))
    assert (summary.checked_cells, summary.compared, summary.differing) == (
        4,
        2,
        by_hand,
    )
    assert any(
        f"{by_hand} of 2 checked cells have another outcome" in line
        for line in summary_lines(summary, "s.h5")
    )

"""Columns that are computed where they are asked for: to the last bit what arrays hold."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest
from support.documents import built
from support.record_layouts import wave

from rocking_cli import Method
from rocking_cli.dynamics.response import response, response_with_demands
from rocking_cli.dynamics.speeds import response_with_speed
from rocking_cli.dynamics.weight import weighed
from rocking_cli.motions import blocks, polyline
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.columns import Column, Instants
from rocking_cli.motions.polyline import record_motion
from rocking_cli.motions.records import Record
from rocking_cli.motions.segments import Segments
from rocking_cli.responses.history import history

COUNTS = [2, 8, 9, 10, 65, 66, 701]


def both(samples, monkeypatch, dt=0.01, scale=-1.5):
    """A record's motion with arrays, and without."""
    record = Record("r", "text", "N", dt, np.array(samples, dtype=float), None, "m/s2", "r", "")
    kept = record_motion(record, scale)
    with monkeypatch.context() as patch:
        patch.setattr(polyline, "_ARRAYS", 0)
        computed = record_motion(record, scale)
    assert isinstance(computed.start, Column)
    assert not isinstance(kept.start, Column)
    monkeypatch.setattr(blocks, "_PART", 64)
    return kept, computed


def equal(found, wanted):
    for field in dataclasses.fields(wanted):
        np.testing.assert_array_equal(np.asarray(getattr(found, field.name)), getattr(wanted, field.name), err_msg=field.name)


def same_answers(answer, system, computed, kept, cells):
    found, wanted = ((x, {}) if answer is response else x for x in (answer(system, motion, *cells) for motion in (computed, kept)))
    for name in ("theta_ratio", "outcome", "impacts"):
        np.testing.assert_array_equal(getattr(found[0], name), getattr(wanted[0], name), err_msg=f"{answer.__name__} {name}")
    assert found[0].work == wanted[0].work
    np.testing.assert_equal(found[1], wanted[1])


@pytest.mark.parametrize("count", COUNTS)
def test_segments_and_what_follows_from_them(count, monkeypatch):
    kept, computed = both(wave(count, 2.0) if count > 2 else [1.0, 2.0], monkeypatch)
    equal(computed.segments, kept.segments)
    for own, others in ((computed, kept), (computed.scaled(-3.0), kept.scaled(-3.0))):
        a, b = own.segments, others.segments
        for x, y in ((a.variation, b.variation), (a.largest_later, b.largest_later), *zip(a._blocks, b._blocks, strict=True)):
            np.testing.assert_array_equal(np.asarray(x), y)
        assert (a.largest, a.sloped, a.straight, own.peak, own.duration) == (b.largest, b.sloped, b.straight, others.peak, others.duration)
        np.testing.assert_array_equal(a.later_max[np.arange(len(a))[::-1]], b.later_max[::-1])
        assert np.all(np.asarray(a.variation.least(np.arange(len(a)))) <= b.variation)
    end = kept.duration
    equal(computed.segments.followed_by_rest(7.0), kept.segments.followed_by_rest(7.0))
    equal(computed.still_until(end + 7.0).segments, kept.still_until(end + 7.0).segments)
    assert tuple(computed.pieces) == kept.pieces == tuple(pickle.loads(pickle.dumps(computed)).pieces)
    assert (computed.pieces[-1], computed.pieces[:3], len(computed.pieces)) == (kept.pieces[-1], kept.pieces[:3], len(kept.pieces))
    phase = np.append(np.linspace(-0.1, end + 0.1, 301), kept.start)
    for own, others in ((computed, kept), (computed.still_until(9.0), kept.still_until(9.0))):
        np.testing.assert_array_equal(own.value(phase), others.value(phase))
    np.testing.assert_array_equal(np.asarray(computed.samples.values)[:-1], kept.samples.values[:-1])
    np.testing.assert_allclose(computed.samples.values[-1], kept.samples.values[-1], rtol=0, atol=4e-16)
    assert computed.samples.step == kept.samples.step


def test_a_record_that_was_sampled_more_finely(monkeypatch):
    samples = wave(137, 2.0)
    kept, computed = both(np.interp(np.arange(5 * 136 + 1) / 5.0, np.arange(137), samples), monkeypatch)
    assert computed.coarsest.samples.step == kept.coarsest.samples.step
    equal(computed.coarsest.segments, kept.coarsest.segments)
    once, other = both(samples, monkeypatch)
    assert (other.coarsest, once.coarsest) == (other, once)


@pytest.mark.parametrize(
    ("count", "model", "more"),
    [
        (20, "linear", ""),
        (20, "nonlinear", ""),
        *(
            pytest.param(400, m, x, marks=pytest.mark.soak)
            for m in ("linear", "nonlinear")
            for x in ("", "damping: 0.02", "one_sided: true")
        ),
    ],
)
def test_responses_are_the_same_to_the_last_bit(count, model, more, monkeypatch):
    """Of every engine: flights, walks, marches for speeds and forces, and of one cell that is listened to."""
    kept, computed = both(np.append(wave(max(count, 60), 4.0), 0.0), monkeypatch)
    structure = built(f"kind: block\nwidth: 0.5 m\nheight: 2 m\n{more}")
    system, omega = Method(model).system_of(structure), 1.0 / structure.p
    cells = np.linspace(1.05, 6.0, count // 5), np.linspace(0.1, omega, count // 5), structure.eta
    for answer in (response, response_with_speed, response_with_demands)[: 3 if count > 20 else 1]:
        few = tuple(x[::10] if np.ndim(x) else x for x in cells) if answer is response_with_demands else cells
        same_answers(answer, system, computed, kept, few)
    if count == 20:
        return
    found, wanted = (history(system, m, 2.0, omega, structure.eta, duration=40.0) for m in (computed, kept))
    assert found.events == wanted.events


@pytest.mark.parametrize("step", [0.01, 0.005, 0.007, 1.0 / 3.0, 0.1])
@pytest.mark.parametrize(("first", "by"), [(0, 1), (3, 1), (0, 7)])
def test_the_instant_before_a_phase(step, first, by):
    """On an instant, a digit before it, between two, and outside."""
    instants = Instants(5000, step, first, by)
    kept = np.asarray(instants)
    for phase in (kept, np.nextafter(kept, -1.0), kept + 0.4 * step, np.array([-1.0, kept[0] - step, kept[-1] + 9.0 * step * by])):
        wanted = np.clip(np.searchsorted(kept, phase, side="right") - 1, 0, kept.size - 1)
        np.testing.assert_array_equal(instants.begun(phase), wanted)


def beside(across, up, monkeypatch, scale=0.6):
    """Two records at once with arrays, and without; across, up: samples and their step."""
    ways = zip(both(*across[:1], monkeypatch, dt=across[1]), both(*up[:1], monkeypatch, dt=up[1], scale=0.8), strict=True)
    return [with_vertical(one, other, scale) for one, other in ways]


def ending(count, peak):
    """A wave that ends at 0."""
    return np.append(wave(count - 1, peak), 0.0)


VERTICALS = {
    "alike": (ending(701, 1.2), 0.01),
    "longer": (ending(801, 1.2), 0.01),
    "shorter": (ending(137, 1.2), 0.01),
    "finer": (ending(1401, 1.2), 0.005),
    "finer and longer": (ending(1733, 1.2), 0.005),
    "finer and shorter": (ending(1001, 1.2), 0.005),
    "coarser": (ending(176, 1.2), 0.04),
    "of another step": (wave(1101, 1.2), 0.007),
}


@pytest.mark.parametrize("up", VERTICALS)
def test_a_vertical_motion_beside_one(up, monkeypatch):
    kept, computed = beside((ending(701, 4.0), 0.01), VERTICALS[up], monkeypatch)
    assert isinstance(computed.across.start, Column)
    assert isinstance(computed.vertical.constant, Column)
    for name in ("duration", "acceleration", "peak"):
        assert getattr(computed, name) == getattr(kept, name)
    assert computed.vertical.peak == kept.vertical.peak
    assert (computed.samples is None) == (kept.samples is None) == (up in ("finer and shorter", "of another step"))  # two steps in one
    if kept.samples is not None:
        assert kept.samples.step == computed.samples.step
        np.testing.assert_allclose(np.asarray(computed.samples.values), kept.samples.values, rtol=0, atol=4e-16)
        np.testing.assert_array_equal(np.asarray(computed.samples.values)[:-1], kept.samples.values[:-1])
    for own, others in ((computed, kept), (computed.still_until(20.0), kept.still_until(20.0))):
        found, wanted = (weighed(motion, 0.3, 0.2) for motion in (own, others))
        for a, b in ((found, wanted), (found.followed_by_rest(7.0), wanted.followed_by_rest(7.0))):
            for name in ("start", "s_start", "later_max", "later_min"):
                assert isinstance(getattr(a, name), Column)
            for x, y in ((a, b), *((getattr(a, name), getattr(b, name)) for name in ("vertical", "right", "left", "edges"))):
                for field in dataclasses.fields(Segments):
                    np.testing.assert_array_equal(np.asarray(getattr(x, field.name)), getattr(y, field.name), err_msg=field.name)
            np.testing.assert_array_equal(np.asarray(a.inward[0]), b.inward[0])
            np.testing.assert_array_equal(np.asarray(a.inward[1]), b.inward[1])
            mixed = np.array([[0, 2 * len(a) - 1], [len(a), len(a) - 1]])
            np.testing.assert_array_equal(a.edges.s_end[mixed], b.edges.s_end[mixed])


def test_a_motion_that_goes_on_beyond_a_jump_at_the_end_of_the_other_has_no_samples(monkeypatch):
    for motion in beside((np.append(wave(700, 4.0), 2.0), 0.01), VERTICALS["longer"], monkeypatch):
        assert motion.samples is None


@pytest.mark.parametrize(
    ("up", "model", "more", "scale"),
    [
        ("alike", "nonlinear", "", 0.6),
        *(
            pytest.param(up, model, more, scale, marks=pytest.mark.soak)
            for up in VERTICALS
            for model in ("linear", "nonlinear")
            for more, scale in (("", 0.6), ("damping: 0.02", 0.6), ("one_sided: true", 0.6), ("", 2.4))
        ),
    ],
)
def test_responses_with_a_vertical_motion_are_the_same_to_the_last_bit(up, model, more, scale, monkeypatch):
    """Also where the weight comes near to none, or to none at all."""
    kept, computed = beside((ending(701, 4.0), 0.01), VERTICALS[up], monkeypatch, scale)
    structure = built(f"kind: block\nwidth: 0.5 m\nheight: 2 m\n{more}")
    system, omega = Method(model).system_of(structure), 1.0 / structure.p
    cells = np.linspace(1.05, 6.0, 8), np.linspace(0.3 * omega, omega, 8), structure.eta
    for answer in (response, response_with_demands):
        same_answers(answer, system, computed, kept, cells)
    found, wanted = (history(system, m, 2.0, omega, structure.eta, duration=40.0) for m in (computed, kept))
    assert found.events == wanted.events

"""Floors of linear buildings against an independent program and Runge-Kutta."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking_cli import (
    RockingParameters,
    check,
    load_records,
    load_structures,
    read_record,
    time_history,
)
from rocking_cli.errors import DocumentError, UsageError
from rocking_cli.motions import Motion, pulse
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.buildings import (
    CHORD,
    TAIL,
    Building,
    floor_of,
    floor_record,
    parse_building,
)
from rocking_cli.motions.polyline import Polyline
from rocking_cli.motions.records.writing import at2_text
from rocking_cli.structures.building_modes import FloorMode, parse_mode

SYNTHETIC = "configs/motions/synthetic.at2"
ONE = Building((FloorMode(0.4, 0.05, 1.3),))
TWO = Building((*ONE.modes, FloorMode(0.13, 0.05, -0.4)))
G = 9.81


def record():
    return read_record(SYNTHETIC).motion


# from an independent program, 2026: a [m/s2] at 3, 5 and 7 s, bound of the chord over
# the peak without refinement, largest acceleration also between the samples
RECORDS = [
    (ONE, (2.9153593, 4.6115882, -1.5176348), 0.0024724933, 8.4626207),
    (TWO, (2.9233675, 4.5599216, -1.461912), 0.0031316627, 8.4863768),
]


@pytest.mark.parametrize(("building", "values", "chord", "peak"), RECORDS)
def test_a_record_agrees_with_an_independent_program(building, values, chord, peak):
    found = floor_of(record(), building)
    a_g = found.acceleration
    at = a_g * found.value(np.array([3.0, 5.0, 7.0]))
    assert at == pytest.approx(values, abs=5e-8)
    parts = 2  # the bound falls with the square of the step
    assert found.floor.chord == pytest.approx(chord / parts**2, rel=1e-3)
    assert found.largest * a_g == pytest.approx(peak, rel=CHORD)
    assert found.samples is not None
    assert found.ground_peak == 1.0


# from an independent program (closed form), 2026: a_g and f_g, T, xi, gamma_psi, a
# [m/s2] at 0.2, 0.5, 1 and 2 s, largest acceleration
SINES = [
    (0.4, 0.05, 1.3, (5.4912148, -8.7330269, -3.0190596, 1.4060221), 8.7364657),
    (0.2, 0.02, 1.0, (3.5949399, -3.7788859, -0.78615508, -0.41581657), 4.7658181),
]


@pytest.mark.parametrize(("period", "xi", "gamma_psi", "values", "peak"), SINES)
def test_a_sine_agrees_with_its_closed_form(period, xi, gamma_psi, values, peak):
    building = Building((FloorMode(period, xi, gamma_psi),))
    found = floor_of(pulse("sine"), building, 0.35 * G, math.tau * 1.5)
    times = np.array([0.2, 0.5, 1.0, 2.0])
    # 0.2 s and 0.5 s are ends of steps, of which a cycle has 400
    assert 0.35 * G * found.value(times) == pytest.approx(values, abs=1e-4 * peak)
    assert 0.35 * G * found.value(times[:2]) == pytest.approx(values[:2], abs=5e-8)
    assert 0.35 * G * found.largest == pytest.approx(peak, rel=6e-5)


PULSES = ["cosine", "rectangular", "mavroeidis-papageorgiou"]


@pytest.mark.parametrize("name", PULSES)
def test_pulses_agree_with_a_runge_kutta_method_and_their_chord(name):
    ground, a_g, omega = pulse(name), 2.0, math.tau * 1.3
    found = floor_of(ground, TWO, a_g, omega)
    marks = np.append(ground.marks / omega, found.marks[-1])
    worst = 0.0
    state = np.zeros(4)
    for start, stop in pairwise(marks.tolist()):
        inside = found.marks[(found.marks > start + 1e-9) & (found.marks < stop - 1e-9)]
        middle = 0.5 * (inside[:-1] + inside[1:])
        inside = np.sort(np.append(inside[::10], middle[::10]))

        def across(t, low=start, high=stop):
            phase = omega * np.clip(t, low + 1e-12, high - 1e-12)
            return ground.value(phase)

        def rates(t, y, across=across):
            pulls = [
                -2.0 * m.damping * math.tau / m.period * y[2 * i + 1]
                - (math.tau / m.period) ** 2 * y[2 * i]
                - float(across(t))
                for i, m in enumerate(TWO.modes)
            ]
            return [y[1], pulls[0], y[3], pulls[1]]

        span = (start, stop)
        method = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-12}
        asked = np.append(inside, stop)
        integrated = solve_ivp(rates, span, state, t_eval=asked, **method).y
        state, path = integrated[:, -1], integrated[:, :-1]
        wanted = across(inside).copy()
        for i, m in enumerate(TWO.modes):
            w = math.tau / m.period
            u, v = path[2 * i], path[2 * i + 1]
            pull = -2.0 * m.damping * w * v - w * w * u - across(inside)
            wanted += m.gamma_psi * pull
        error = np.abs(found.value(inside) - wanted)
        worst = max(worst, float(error.max()))
        ends = np.isin(inside, found.marks)
        assert error[ends].max() < 1e-8
    assert worst <= found.floor.chord * found.largest * (1.0 + 1e-6) + 1e-9
    assert found.floor.chord <= CHORD


def test_the_tail_ends_with_a_thousandth_of_the_peak():
    found = floor_of(record(), TWO)
    period = 0.4
    last = found.marks > found.duration - period
    left = np.abs(found.value(found.marks[last]))
    swing = math.exp(math.tau * 0.05)  # of one period
    assert 0.5 * TAIL < left.max() / found.largest < TAIL * swing


def test_a_stiff_building_moves_with_the_ground():
    found = floor_of(record(), Building((FloorMode(0.002, 0.05),)))
    assert found.value(record().marks[:-1]) == pytest.approx(
        record().value(record().marks[:-1]), abs=2e-3
    )


def test_two_modes_are_the_sum_of_their_parts():
    """a - x_g'' is linear in gamma_psi."""
    ground = record()
    other = Building((TWO.modes[1],))
    at = ground.marks[:-1]
    both, one, two = (floor_of(ground, b).value(at) for b in (TWO, ONE, other))
    assert both == pytest.approx(one + two - ground.value(at), abs=1e-12)


def test_the_vertical_motion_is_that_of_the_ground():
    (one,) = load_records(SYNTHETIC)
    moved = with_vertical(floor_of(one.motion, ONE), one.motion, 0.5)
    at = np.linspace(0.0, 15.9, 100)
    assert moved.vertical.value(at) == pytest.approx(0.5 * one.motion.value(at))
    assert moved.floor.chord < CHORD
    sine: Motion = with_vertical(pulse("sine"), pulse("cosine"), 0.5)
    floor = floor_of(sine, ONE, 1.0, math.tau)
    at = floor.marks[: 401 - 1 : 7]
    wanted = sine.vertical.value(at * math.tau)
    assert floor.vertical.value(at) == pytest.approx(wanted, abs=1e-9)


def test_a_recording_keeps_the_measures_of_the_ground():
    (one,) = load_records(SYNTHETIC, scale=-0.5)
    moved = one.on_floor(ONE)
    assert (moved.acceleration, moved.intensity.pga) == (
        one.acceleration,
        one.intensity.pga,
    )
    assert moved.label == "synthetic on floor of T 0.4 s"
    assert moved.motion.acceleration == one.acceleration
    values = floor_of(one.motion, ONE).value(np.array([3.0]))
    assert moved.motion.value(np.array([3.0])) == pytest.approx(values, rel=1e-12)
    assert moved.identity() != one.identity()
    reversed_ = moved.motion.scaled(-1.0)
    assert reversed_.floor.ground.value(3.0) == -one.motion.value(3.0)


def test_a_floor_is_written_and_read_again(tmp_path):
    floor, chord = floor_record(read_record(SYNTHETIC), TWO)
    path = tmp_path / "floor.at2"
    path.write_text(at2_text(floor))
    again = read_record(path)
    assert (again.dt, again.npts) == (floor.dt, floor.npts)
    assert again.acceleration == pytest.approx(floor.acceleration, rel=1e-14)
    assert chord == floor_of(record(), TWO).floor.chord


@pytest.mark.parametrize(
    ("texts", "found"),
    [
        (["T=0.4"], "T=0.4: no key 'xi'"),
        (["T=0,xi=0.05"], "T: found 0; expected a period from 0.001 to 1000 s"),
        (["T=1,xi=0.05,gamma_psi=-1e4"], "gamma_psi: found -1e4; expected a number"),
        (["T=1,xi=0.05,gamma_psi=0"], "found 0; expected a number from.*than zero"),
        (["T=0.4,xi=0"], "xi: found 0; expected a ratio"),
        (["T=0.4,xi=5%"], "xi: found 5%.*did you mean 0.05"),
        (["T=0.4,xi=0.05,psi=1"], "unknown key 'psi'"),
        (["T=0.4,xi=0.05,T=0.5"], "found a key twice"),
        (["T=0.4+-0.1,xi=0.05"], "found a key twice, or with a spread"),
        (["T=0.4,xi=0.05", "T=400 ms,xi=0.02"], "two modes of T = 0.4 s"),
        (["T=0.4 m,xi=0.05"], "T: found 0.4 m; expected a time"),
        (["T=nan,xi=0.05"], "T: found nan"),
        ([""], "unknown key ''"),
    ],
)
def test_refusals(texts, found):
    with pytest.raises(UsageError, match=found):
        parse_building(texts)


def test_a_floor_of_a_code_states_its_participation():
    assert parse_mode("T=400 ms,xi=0.05,gamma_psi=1.3", "floor") == ONE.modes[0]
    for text in ("T=0.4,xi=0.05", "T=0.4,xi=5,gamma_psi=1.3"):
        with pytest.raises(UsageError, match=r"`floor`: T=0.4,xi=.*expected"):
            parse_mode(text, "floor")


def test_a_floor_that_needs_too_many_steps_is_refused(monkeypatch):
    monkeypatch.setattr("rocking_cli.motions.buildings.MOST", 2500)
    with pytest.raises(UsageError, match="needs more than 2500 steps"):
        floor_of(record(), ONE)
    monkeypatch.setattr("rocking_cli.motions.buildings.MOST", 5000)
    with pytest.raises(UsageError, match="vibrates on for more than 5000 steps"):
        floor_of(record(), Building((FloorMode(2.0, 0.001),)))


def test_a_polyline_that_jumps_stays_exact():
    """Two lines with a jump between them."""
    t = np.array([0.0, 0.3, 0.7])
    ground = Polyline("jump", t[:-1], t[1:], np.array([1.0, -1.0]), np.zeros(2), 1.0)
    found = floor_of(ground, ONE)
    first = 1.0 + 1.3 * -1.0  # u'' = -x_g'' at rest
    assert found.value(0.0) == pytest.approx(first, abs=1e-12)
    jump = float(found.value(0.3) - found.value(0.3 - 1e-9))
    assert jump == pytest.approx((1.0 - 1.3) * -2.0, abs=1e-6)


@pytest.mark.parametrize(
    ("motion", "grid", "ground"),
    [
        ("sine", "a_g=0.2g,f_g=1.5", {"a_g": 0.2 * 9.81, "omega": math.tau * 1.5}),
        (SYNTHETIC, None, {}),
    ],
)
def test_a_body_whose_document_has_the_building_is_that_on_the_floor(
    motion, grid, ground
):
    floor = floor_of(motion, "T=0.4,xi=0.05,gamma_psi=1.3", **ground)
    keyed = "block:0.8x2,name=K,building=[{T: 0.4, xi: 0.05, gamma_psi: 1.3}]"
    found = check(keyed, motion, grid, a_max=None)
    stated = "a_g=0.2g" if grid else None
    assert found.row() == check("block:0.8x2,name=K", floor, stated, a_max=None).row()
    assert found.floor_pga == pytest.approx(
        floor.largest * (ground.get("a_g") or floor.acceleration)
    )
    if grid:
        history = time_history(keyed, motion, grid)
        on_floor = time_history("block:0.8x2,name=K", floor, stated)
        assert list(history.rows()) == list(on_floor.rows())


def test_the_parameters_of_a_body_keep_its_building():
    keyed = "block:0.8x2,building=[{T: 0.4, xi: 0.05, gamma_psi: 1.3}]"
    (body,) = load_structures(keyed)
    assert body.building == ONE.modes
    again = RockingParameters.from_row(body.row())
    assert again.building == ONE.modes
    (read,) = load_structures(json.dumps(body.row()))
    assert read.building == ONE.modes


@pytest.mark.parametrize(
    ("modes", "said"),
    [
        ("[{T: 0.4}]", "no key 'xi'"),
        ("[{T: 0, xi: 0.05}]", "a period from 0.001 to 1000 s"),
        ("[{T: 1, xi: 5}]", "above 0 and below 1"),
        ("[{T: 1, xi: 0.05, gamma_psi: 0}]", "other than zero"),
        ("[{T: 1, xi: 0.05}, {T: 1, xi: 0.1}]", "two modes of T = 1 s"),
        ("[{T: 1, xi: 0.05, gama_psi: 1}]", "did you mean 'gamma_psi'"),
    ],
)
def test_faults_of_the_key(modes, said):
    with pytest.raises(DocumentError, match=said):
        load_structures(f"{{kind: block, width: 1, height: 4, building: {modes}}}")

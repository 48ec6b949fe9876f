"""What must hold for every system under every motion: the claims on the table of
`support/conformance.py`.

Each claim is made of every system under one sine; under the other motions of the
systems that are marched otherwise, and in the soak of all. The sweeps are shared.
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from support.conformance import (
    AMPLITUDES,
    MOTIONS,
    OMEGA,
    SLOW,
    SLOWER,
    SYSTEMS,
    answer,
    integrated,
    mirrored,
    scaled,
    store,
    structure_of,
    sweep,
    swept,
    takes_a_vertical_motion,
)

from rocking_cli import (
    Outcome,
    boundaries,
    build_structure,
    check,
    parse_documents,
    parse_grid,
    response,
    sine,
    spectrum,
    time_history,
    trace_envelope,
)
from rocking_cli.dynamics.method import governing_method
from rocking_cli.dynamics.outcome import falls
from rocking_cli.responses.check import verdicts
from rocking_cli.structures.family import Variation

TOLERANCE = 1e-8  # of theta/alpha: 1e-9 times the condition of a cell that stands
# Other motions outside the soak: a record by each equation and with damping, a sum of
# sinusoids, jumps, and a varying weight.
ALSO = {
    "short record": ("parameters", "unequal edges"),
    "ricker": ("parameters",),
    "rectangular impulse": ("parameters", "symmetric"),
    "pulse with a vertical one": ("symmetric",),
    "one sine, reversed": ("tied on one side",),
}


# Systems that combine what others have: outside the soak, they answer as their oracle.
COMBINED = (
    "stocky, damped",
    "tied, damped",
    "dampers",
    "stocky, tied on two sides",
    "stocky, tied, damped",
    "stocky, prestressed",
    "stocky, tendon",
    "frame",
    "point mass",
)
# Systems of other ties than those that mirror images and lanes are asked of.
TIES = ("rupturing tie", "yielding tie", "tendon")


def pairs(but: tuple[str, ...], soaked: tuple[str, ...]) -> Iterator[Any]:
    """(system, motion, True for the whole sweep) of a claim, but not of these systems;
    `soaked` in the soak alone.
    """
    for system in SYSTEMS:
        if system in but:
            continue
        for motion in MOTIONS:
            if "vertical" in motion and not takes_a_vertical_motion(system):
                continue
            if system not in soaked and (
                motion == "one sine" or system in ALSO.get(motion, ())
            ):
                yield system, motion, False
            yield pytest.param(system, motion, True, marks=pytest.mark.soak)


def claim(
    but: tuple[str, ...] = (), soaked: tuple[str, ...] = (*SLOW, *COMBINED)
) -> Any:
    """A claim on the pairs of the table."""
    table = list(pairs(but, soaked))
    return pytest.mark.parametrize(("system", "motion", "whole"), table)


def assert_same(one, other, tolerance):
    """Two sweeps have equal outcomes, and rotations within a tolerance."""
    assert one.outcome.tolist() == other.outcome.tolist()
    np.testing.assert_allclose(
        one.theta_ratio, other.theta_ratio, rtol=tolerance, atol=tolerance
    )


# An arch as a linkage has its own integration, in responses/test_arch_history.py.
@claim(but=("arch",), soaked=SLOW)
def test_a_system_answers_as_an_integration_that_shares_no_code(system, motion, whole):
    found = sweep(system, motion)
    for i in found.picked(whole):
        outcome = Outcome(int(found.outcome[i]))
        flag, ratio = integrated(found, i) if whole else answer(system, motion, i)
        assert outcome.flag.startswith(flag), i
        assert found.theta_ratio[i] == pytest.approx(ratio, abs=TOLERANCE, nan_ok=True)


@claim()
def test_scale_and_units_change_nothing(system, motion, whole):
    """Of a body four times as long and twice as heavy, with its motion in g and in
    seconds.
    """
    found = sweep(system, motion)
    low, high = (float(x) / 9.81 for x in found.a_g[[0, -1]])
    pace = "" if found.omega is None else f",T_g={SLOWER * math.tau / found.omega!r}"
    grid = parse_grid(
        f"a_g={low!r}g:{high!r}g:{AMPLITUDES}:log{pace}",
        own_time=found.omega is None,
    )
    larger = swept(scaled(found.document), MOTIONS[motion](SLOWER), grid)
    assert_same(larger, found, TOLERANCE)


@claim(soaked=(*SLOW, *COMBINED, *TIES))
def test_a_body_turned_round_under_the_reversed_motion_does_the_same(
    system, motion, whole
):
    """A one-sided body cannot be turned round: its motion in the other sense is
    another one.
    """
    found = sweep(system, motion)
    reversed_motion = found.motion.scaled(-1.0)
    grid = found.grid()
    if found.structure.one_sided:
        other = swept(found.document, reversed_motion, grid)
        assert other.theta_ratio.tolist() != found.theta_ratio.tolist()
        return
    turned = swept(mirrored(found.document), reversed_motion, grid)
    assert_same(turned, found, 1e-12)
    if mirrored(found.document) != found.document:
        still = swept(found.document, reversed_motion, grid)
        assert still.theta_ratio.tolist() != found.theta_ratio.tolist()


@claim(soaked=(*SLOW, *COMBINED, *TIES))
def test_a_lane_alone_is_as_in_a_batch(system, motion, whole):
    """Its digits do not depend on other lanes; its outcome not on the peaks, and on
    floats its rotation within the tolerance.
    """
    found = sweep(system, motion)
    march = governing_method(found.structure).system_of(found.structure)
    amplitude, omega, eta = found.cells()
    for i in found.picked(whole)[-1 if not whole else 0 :]:
        cell = march, found.motion, amplitude[i], omega, eta
        alone, floats = response(*cell), response(*cell, how="floats")
        bare = response(*cell, peaks=False)
        assert alone.theta_ratio.tobytes() == found.theta_ratio[i].tobytes()
        assert alone.outcome == floats.outcome == bare.outcome == found.outcome[i]
        assert np.isnan(bare.theta_ratio)
        assert float(floats.theta_ratio) == pytest.approx(
            found.theta_ratio[i], abs=TOLERANCE, nan_ok=True
        )


@claim()
def test_check_and_response_find_the_outcome_of_the_spectrum(system, motion, whole):
    """The events of `response` too: the last one says how the body ends; no rotation of
    its rows is above its peak.
    """
    found = sweep(system, motion)
    for i in found.picked(whole):
        outcome, ratio = Outcome(int(found.outcome[i])), found.theta_ratio[i]
        verdict = check(found.structure, found.motion, found.demand(i), a_max=None)
        history = time_history(found.structure, found.motion, found.demand(i))
        (summary,) = history.summaries()
        events = [row["event"] for row in history.events()]
        assert verdict.outcome.flag == outcome.flag
        assert summary["outcome"] == outcome.flag
        # A loss of contact ends the events only of a body that does not overturn.
        lost, fell = outcome == Outcome.LOST_CONTACT, outcome.overturned
        assert ("lost contact" in events, "overturning" in events) == (lost, fell)
        assert not (lost or fell) or events[-1] in ("lost contact", "overturning")
        if fell:
            after_impact = outcome == Outcome.OVERTURNED_AFTER_IMPACT
            assert ("impact" in events) == after_impact
        assert (verdict.theta_ratio is None) == math.isnan(ratio)
        assert (summary["theta_ratio"] is None) == math.isnan(ratio)
        if math.isnan(ratio):
            continue
        for other in (verdict.theta_ratio, summary["theta_ratio"]):
            assert other == pytest.approx(ratio, abs=TOLERANCE)
        (path,) = history.histories.values()
        instants = np.append(np.linspace(0.0, path.end, 401), path.steps())
        rotation = np.abs(path.at(instants)[0]).max()
        assert rotation == pytest.approx(ratio, abs=TOLERANCE)


# Searches along the amplitude take seconds: outside the soak of these systems.
FEW = ("one-sided", "stocky, one-sided", "parameters")


def searched(few: tuple[str, ...]) -> Iterator[Any]:
    """Every system along whose amplitude a search takes less than minutes; `few`
    outside the soak.
    """
    for system in SYSTEMS:
        if system not in SLOW:
            yield pytest.param(system, marks=[pytest.mark.soak] * (system not in few))


@pytest.mark.parametrize("system", list(searched(FEW)))
def test_check_is_as_the_envelope_and_the_envelope_as_the_spectrum(system):
    """An amplitude near the end of an interval may lie on either side of it, by the
    width of the narrowest one that is looked for.
    """
    found = sweep(system, "one sine")
    structure, method = found.structure, governing_method(found.structure)
    amplitude = structure.dimensionless_amplitude(found.a_g[: found.first_fall + 2])
    limit = 1.001 * float(amplitude[-1])
    intervals = trace_envelope(
        structure,
        found.motion,
        [OMEGA / structure.p],
        method=method,
        a_max=limit,
        sign="+",
        workers=1,
    )
    for a, code in zip(amplitude, found.outcome, strict=False):
        modes = {
            x.mode
            for x in intervals
            if x.a_from <= a <= (math.inf if x.a_to is None else x.a_to)
        }
        assert modes == ({Outcome(int(code)).mode} if falls(code) else set()), a
    verdict = check(structure, found.motion, found.demand(0), a_max=limit)
    if not intervals:
        assert verdict.first_overturning_a is None
        return
    first = structure.ground_acceleration(min(x.a_from for x in intervals))
    # four digits, rounded down, where many narrow intervals overturn
    digits = 1e-3 if verdict.share_of_falls else 2e-9
    assert verdict.first_overturning_a == pytest.approx(first, rel=digits)
    assert verdict.capacity_demand == pytest.approx(first / found.a_g[0], rel=digits)


@pytest.mark.parametrize("system", list(searched(FEW[:2])))
def test_solve_says_nowhere_from_the_first_amplitude_that_falls(system):
    """A range of one value: the document itself."""
    found = sweep(system, "one sine")
    (document,) = parse_documents(str(found.document), "f.yaml")
    first = found.first_fall
    for i, says in (
        ((first - 1, "stands everywhere"), (first, "stands nowhere"))
        if first < AMPLITUDES
        else ()
    ):
        (row,), _ = boundaries(
            document,
            Variation("gravity", (build_structure(document).gravity,), None),
            [(found.motion, found.demand(i))],
            workers=1,
        )
        assert row.side == says


SEVERAL = ("unequal edges", "stocky, one-sided", "damped", "tied on one side")


def test_one_process_is_as_several():
    """Spectra of systems in chunks, envelopes and verdicts."""
    structures = [structure_of(SYSTEMS[name]) for name in SEVERAL]
    grid = parse_grid("A=1.02:5:3:log,Omega=2:6:2")
    one, two = (
        spectrum(structures, sine(), grid, workers=workers, chunk_cells=cells, check=0)
        for workers, cells in ((1, 1000), (2, 3))
    )
    assert one.outcome.tobytes() == two.outcome.tobytes()
    assert one.theta_ratio.tobytes() == two.theta_ratio.tobytes()
    assert len(set(one.outcome.ravel().tolist())) > 2

    stated = sweep("parameters", "one sine").structure
    traced, other = (
        trace_envelope(stated, sine(), [2.0, 3.0], a_max=4.0, workers=workers)
        for workers in (1, 2)
    )
    assert traced == other

    demands = [(stated, sine(), parse_grid(f"A=1.5,Omega={w}")) for w in (3, 4)]
    alone = [check(*demand, a_max=3.0) for demand in demands]
    heard: list[tuple[float, int]] = []
    for workers in (1, 2):
        told = (lambda *x: heard.append(x)) if workers == 1 else None
        found = verdicts(demands, a_max=3.0, workers=workers, progress=told)
        assert list(found) == alone
    thirds = [(i + 1) / 3 for i in range(3 * len(demands))]  # three stages of each
    assert [done for done, _ in heard] == pytest.approx(thirds, rel=1e-12)
    assert {total for _, total in heard} == {len(demands)}


if __name__ == "__main__":
    # those outside the soak, which are tuples without marks; and those of the record of
    # every system, which spectra/test_error_bound.py asks for
    asked = [one[:2] for one in pairs(("arch",), SLOW) if type(one) is tuple]
    asked += [(system, "short record") for system in SYSTEMS if system not in SLOW]
    store(dict.fromkeys(asked))

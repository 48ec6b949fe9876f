"""Fragility of structures whose numbers have spreads, against closed forms.

A rectangular pulse overturns the linear oscillator from alpha g/(1 - exp(-p t_d)) on,
so that with a normal alpha the share of each pulse is Phi, and that of a set of pulses
its mean.
"""

import math

import numpy as np
import pytest

import rocking_cli as rk
from rocking_cli.dynamics.method import LINEAR
from rocking_cli.fragility.bootstrap import Resampling
from rocking_cli.fragility.drawn import drawn_exposure
from rocking_cli.fragility.exposure import MotionSet
from rocking_cli.fragility.measures import site_pulses
from rocking_cli.fragility.study import studies
from rocking_cli.motions.intensity_measures import measure_of
from rocking_cli.spectra.sweep_options import SweepOptions

DURATIONS = (0.3, 0.5, 0.8, 1.2)  # s
P, ALPHA, SD, G = 2.66, 0.245, 0.01, 9.81
LEVELS = np.array([0.28, 0.34]) * G


@pytest.fixture
def motions(tmp_path):
    path = tmp_path / "pulses.csv"
    rows = [f"1 g,{t} s,rectangular" for t in DURATIONS]
    path.write_text("\n".join(["a_g,T_g,pulse", *rows]))
    return MotionSet(site_pulses(path), measure_of("PGA"), LEVELS, LINEAR)


@pytest.fixture
def oscillator():
    text = f"parameters:p={P},alpha={ALPHA}+-{SD},eta=0.9,a_scale=1"
    (found,) = rk.load_structures(text)
    return found


def exact_share(level, duration):
    limit = level * -math.expm1(-P * duration) / G
    return 0.5 * math.erfc((ALPHA - limit) / SD / math.sqrt(2.0))


def test_each_motion_has_the_share_of_its_own_draws(motions, oscillator):
    found = drawn_exposure(oscillator, motions, 256, seed=0)
    known, beyond = found.counts(None)
    exact = [[exact_share(level, t) for level in LEVELS] for t in DURATIONS]
    assert known == pytest.approx(1.0)
    # Even points: within a few of 256 draws, far inside of 1/sqrt(256).
    assert beyond == pytest.approx(np.array(exact), abs=0.01)
    # 0.38913185 and 0.67354844: the means over the pulses (independent program, 2026).
    assert beyond.mean(axis=0) == pytest.approx([0.38913185, 0.67354844], abs=3e-3)


def test_the_motions_alone_have_their_own_dispersion(motions, oscillator):
    settings = {"sweep": SweepOptions(), "draws": (64, 0)}
    (study,) = studies([oscillator], motions, ["stripes"], Resampling(0), **settings)
    plain = study.exposure.counts(None)[1].mean(axis=0)
    # At the mean alpha each pulse overturns or does not: 2 and 3 of 4.
    assert plain.tolist() == [0.5, 0.75]
    fit = study.fit("stripes", None)
    assert fit.points[LEVELS[0]] == pytest.approx(0.38913185, abs=6e-3)
    assert fit.row()["beta_motions"] == fit.beta_motions != fit.curve.beta

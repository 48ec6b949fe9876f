"""Bounds of the samples over stretches of them."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli.dynamics.samples.exact import SLACK, stretches


@pytest.mark.parametrize("count", [2, 3, 17, 300])
def test_each_bound_is_below_its_stretch_and_not_below_a_stretch_a_quarter_longer(count):
    samples = np.random.default_rng(count).standard_normal(count)
    slack = SLACK * np.abs(samples).max()
    levels = 1 + int(np.ceil(np.log2(count)))
    bounds = stretches(samples, levels)
    n = np.arange(count)
    for face, outward in ((0, -samples), (bounds.face, samples)):
        for level in range(levels):
            found = bounds.at(np.full(count, face), np.full(count, level), n)
            reach, late = 1 << level, 1 << max(0, level - 3)
            least = np.array([outward[i : i + reach + 1].min() for i in n])
            wide = np.array([outward[i // late * late : i // late * late + late + reach].min() for i in n])
            assert np.all(found <= least - 0.9 * slack)
            assert np.all(found >= wide - 1.1 * slack)

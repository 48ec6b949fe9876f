"""What is said of a demand that the march gives up."""

import numpy as np
import pytest

from rocking_cli import Outcome, dimensionless_oscillator, sine
from rocking_cli.dynamics.method import LINEAR
from rocking_cli.dynamics.shared_march import SharedMarch
from rocking_cli.envelopes.capacity import CapacitySearch
from rocking_cli.envelopes.withstanding import withstand


@pytest.mark.parametrize(("failed", "said"), [(2.0, None), (2.0 - 2e-12, True)])
def test_only_the_outcome_of_the_demand_itself_must_be_known(failed, said, monkeypatch):
    def march(row, amplitude):
        fails = np.abs(amplitude - failed) < 1e-13
        return np.where(fails, Outcome.FAILED, Outcome.ROCKED), np.zeros_like(row)

    monkeypatch.setattr(SharedMarch, "of_rows", lambda *_: march)
    body = dimensionless_oscillator(eta=0.9)
    search = CapacitySearch(body, sine(), 2.0, 5.0, LINEAR, 20.0)
    assert withstand([search], 1.5, scanned=False) == [said]

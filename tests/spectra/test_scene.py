"""Which model goes with which structure."""

from __future__ import annotations

import pytest

from rocking_cli import Method, UsageError, parse_documents
from rocking_cli import build_structure as build


def test_model_is_refused_where_it_does_not_hold():
    (document,) = parse_documents("kind: parameters\np: 2\nalpha: 0.1\neta: 0.9\nlambda: 0.3")
    with pytest.raises(UsageError, match="a rigid body, whose a_scale is 1"):
        Method("nonlinear").system_of(build(document))
    with pytest.raises(UsageError, match="unknown model"):
        Method("quadratic")
    with pytest.raises(UsageError, match="tolerance"):
        Method("nonlinear", 0.5)

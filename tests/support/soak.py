"""Which values of a parameter the quick tests take."""

from collections.abc import Iterable
from typing import Any

import pytest


def quick(every: Iterable[Any], *some: Any) -> list[Any]:
    """Every value as a parameter of a test; all but these run in the soak alone."""
    return [x if x in some else pytest.param(x, marks=pytest.mark.soak) for x in every]

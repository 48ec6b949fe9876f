"""What became of a cell."""

from __future__ import annotations

from enum import IntEnum


class Outcome(IntEnum):
    """Outcome codes as they stand in the spectra file; the names in lower case are its flag meanings."""

    NOT_COMPUTED = 0
    NO_UPLIFT = 1
    ROCKED = 2
    OVERTURNED_NO_IMPACT = 3
    OVERTURNED_AFTER_IMPACT = 4
    FAILED = 5

    @property
    def flag(self) -> str:
        """The word that files and tables use."""
        return self.name.lower()

"""Outcomes of cells, each with its code and sentence, and tests for those that
overturned, fall or are safe.
"""

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, Self

import numpy as np

from ..errors import UsageError

LOST = "lost contact"  # the event
# |theta|/alpha from which a body counts as overturned when the ground falls away, and
# at which its history ends
FALLEN = 3.0


class _Code(IntEnum):
    """A code with the words that say it."""

    sentence: str  # what has happened, in words

    def __new__(cls, code: int, sentence: str = "") -> Self:
        member = int.__new__(cls, code)
        member._value_ = code
        member.sentence = sentence
        return member

    @property
    def flag(self) -> str:
        """The word that files and tables use."""
        return self.name.lower()

    def __eq__(self, other: object) -> bool:
        """True for the same code, or for its word."""
        return self.flag == other if isinstance(other, str) else int(self) == other

    __hash__ = int.__hash__


class Outcome(_Code):
    """What became of a body: the outcome codes of `Response` and of spectra files.

    `flag` is the word that files and tables use, to which an outcome is equal;
    `sentence` says it in words; `overturned`, `falls` and `safe` sort the outcomes.
    The functions `overturned` and `safe` do so for arrays.

    Examples
    --------
    >>> found = Outcome(4)
    >>> found.flag, found.sentence, found.overturned
    ('overturned_after_impact', 'overturns after an impact', True)
    """

    NOT_COMPUTED = 0, "not computed"
    NO_UPLIFT = 1, "no uplift"
    ROCKED = 2, "rocks and survives"
    OVERTURNED_NO_IMPACT = 3, "overturns without impact"
    OVERTURNED_AFTER_IMPACT = 4, "overturns after an impact"
    FAILED = 5, "failed"
    LOST_CONTACT = 6, "loses contact with the ground"
    LEANING = 7, "comes to rest leaning, held by its ties"
    SLID = 8, "slides and never rocks"

    @property
    def mode(self) -> str:
        """The word for this outcome in an envelope's intervals: `no_impact`,
        `after_impact`, `failed`.
        """
        return self.flag.removeprefix("overturned_")

    @property
    def overturned(self) -> bool:
        """True if the body is known to have overturned; False for a failed cell."""
        return self in (Outcome.OVERTURNED_NO_IMPACT, Outcome.OVERTURNED_AFTER_IMPACT)

    @property
    def falls(self) -> bool:
        """True if the body overturned, lost contact (it may then not come back
        upright), or was left leaning.
        """
        return self.overturned or self in (Outcome.LOST_CONTACT, Outcome.LEANING)

    @property
    def safe(self) -> bool:
        """True if the body is known to have stayed upright, whether it lifted off or
        not, or slid.
        """
        return self in (Outcome.NO_UPLIFT, Outcome.ROCKED, Outcome.SLID)


class Difference(_Code):
    """Comparison of the linear with the nonlinear outcome of a cell, which counts as
    right: codes of the file's `difference`. The linear equation is unsafe if its body
    stands where the nonlinear one falls (`Outcome.falls`).
    """

    NOT_COMPUTED = 0, "one of them failed"
    AGREES = 1, "linear agrees"
    LINEAR_UNSAFE = 2, "linear stands, the body falls"
    LINEAR_FALSE_ALARM = 3, "linear falls, the body stands"


_OVERTURNED, _FALLS, _SAFE = np.array(
    [(o.overturned, o.falls, o.safe) for o in Outcome]
).T


def difference(nonlinear: Any, linear: Any) -> Any:
    """Codes of `Difference`, uint8, from the codes of `Outcome` under each equation;
    arrays of one shape.
    """
    known = (falls(nonlinear) | safe(nonlinear)) & (falls(linear) | safe(linear))
    verdict = np.where(
        falls(nonlinear) & safe(linear), Difference.LINEAR_UNSAFE, Difference.AGREES
    )
    verdict = np.where(
        safe(nonlinear) & falls(linear), Difference.LINEAR_FALSE_ALARM, verdict
    )
    return np.where(known, verdict, Difference.NOT_COMPUTED).astype(np.uint8)


def overturned(codes: Any) -> Any:
    """True for outcomes of bodies that overturned.

    Parameters
    ----------
    codes
        codes of `Outcome`, of any shape

    Returns
    -------
    bool or array of bool
        in the shape of `codes`

    Raises
    ------
    UsageError
        for codes that are none of `Outcome`

    Notes
    -----
    A cell that failed or lost contact is neither overturned nor safe.

    Examples
    --------
    >>> overturned(linear_response(sine(), [1.5, 12.0], 6.0, 0.9).outcome).tolist()
    [False, True]
    """
    return _found_in(_OVERTURNED, codes)


def falls(codes: Any) -> Any:
    """True for codes of `Outcome`, of any shape, that are `falls`.

    >>> falls(linear_response(sine(), [1.5, 12.0], 6.0, 0.9).outcome)
    array([False,  True])
    """
    return _FALLS[codes]


def safe(codes: Any) -> Any:
    """True for outcomes of bodies that are known to have stayed upright.

    Parameters
    ----------
    codes
        codes of `Outcome`, of any shape

    Returns
    -------
    bool or array of bool
        in the shape of `codes`

    Raises
    ------
    UsageError
        for codes that are none of `Outcome`

    Notes
    -----
    A cell that failed or lost contact is neither overturned nor safe.

    Examples
    --------
    >>> safe(linear_response(sine(), [1.5, 12.0], 6.0, 0.9).outcome).tolist()
    [True, False]
    """
    return _found_in(_SAFE, codes)


def _found_in(table: Any, codes: Any) -> Any:
    """Return the entries of a table by code. Raises UsageError for other codes than
    those of `Outcome`.
    """
    try:
        return table[codes]
    except (IndexError, ValueError):
        raise UsageError(
            f"`codes`: found {str(codes)[:60]!r}; expected codes of Outcome, 0 to"
            f" {len(table) - 1}"
        ) from None


@dataclass
class Work:
    """Numbers of cells, impacts and steps: how many were computed, and how many a proof
    made unnecessary.
    """

    cells: int = 0  # cells in all
    no_uplift: int = 0  # cells below uplift, which no step is computed for
    # cells whose overturning was certain before it was computed to its end
    certain_overturning: int = 0
    free_phase: int = 0  # cells whose motion after the shaking was not computed
    rests_skipped: int = 0  # rests to the next uplift, passed in one step
    sequences_closed: int = 0  # sequences of impacts whose last part was summed
    impacts: int = 0  # impacts that were computed
    steps: int = 0  # steps that were computed

    def __add__(self, other: Self) -> "Work":
        return Work(
            **{
                f.name: getattr(self, f.name) + getattr(other, f.name)
                for f in fields(self)
            }
        )

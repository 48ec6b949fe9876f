"""The check by a code beside the dynamics of the same demand."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..structures.parameters import RockingParameters
from .check import Demand
from .code_check import CodeCheck, code_check, first_beyond
from .verdict import Verdict


@dataclass(frozen=True)
class CodeVerdict:
    """A check by the code, and the demand on the body in the dynamics."""

    check: CodeCheck  # amplitudes that the methods of the code accept
    demand: Demand | None  # None under the spectrum of a file alone
    carried: bool  # True if its document states a building, its floor of the code

    @property
    def motion(self) -> str:
        """The name of the motion, or of the file."""
        return self.check.demand if self.demand is None else self.demand[1].name

    @property
    def verified(self) -> bool:
        """True if each limit state that is asked is verified."""
        return all(map(self.check.verified, self.check.asked))

    @property
    def least(self) -> float:
        """The least amplitude over the demand that a limit state accepts, 0 for one
        without an answer.
        """
        ratios = (at.ratio for at in self.check.reached().values())
        return 0.0 if self.check.unanswered else min(ratios)

    def beyond(self, verdict: Verdict) -> float | None:
        """Return what `first_beyond` finds below the capacity; None of a body that
        slides.
        """
        if self.demand is None or verdict.slide is not None:
            return None
        return first_beyond(*self.demand, most=verdict.first_overturning_a)


def code_verdicts(
    structures: Sequence[RockingParameters],
    demands: Sequence[Demand],
    code: Mapping[str, Any],
) -> Iterator[CodeVerdict]:
    """Yield the check by the code of each demand, or without one of each structure;
    code: arguments of `code_check`.
    """
    if not demands:
        for one in structures:
            yield CodeVerdict(code_check(one, **code), None, bool(one.building))
    # the demands are those on the floors already
    floors = {one.name: one.building for one in structures}
    for structure, motion, grid in demands:
        standing = replace(structure, building=floors.get(structure.name, ()))
        check = code_check(standing, motion, grid, **code)
        yield CodeVerdict(check, (structure, motion, grid), bool(standing.building))

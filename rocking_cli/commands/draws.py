"""The options --draws and --seed: draws of structures whose numbers have spreads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from . import options
from .command import partly
from .printing import note

if TYPE_CHECKING:
    from ..envelopes.amplitudes import Limit
    from ..responses.check import Demand
    from ..structures import RockingParameters


@dataclass(frozen=True)
class Draws:
    """The draws of a call."""

    draws: int | None = options.draws()
    seed: int = options.seed()

    def rows(self, structures: Iterable[RockingParameters]) -> Iterator[dict[str, Any]]:
        """Yield a row for each quantity of each structure that has a spread: its mean,
        standard deviation and quantiles over the draws.
        """
        from ..structures.draws import draws, summaries

        for structure in structures:
            if structure.drawn_from is None:
                continue
            found = list(draws(structure.drawn_from, self.draws or 2, self.seed))
            faults = [draw.fault for draw in found if draw.fault]
            first = faults[0] if faults else None
            note_left_out(structure.name, len(faults), len(found), first)
            for row in summaries(found):
                yield {"name": structure.name, **row}


def require_spreads(draws: int | None, structures: Iterable[RockingParameters]) -> None:
    """Raise click.UsageError if there are draws, and no structure has a number with a
    spread.
    """
    if draws is not None and not any(s.drawn_from for s in structures):
        raise click.UsageError(
            "--draws: no number of the structures has a spread, such as width: 0.5 m"
            " +- 10 mm"
        )


class DrawnRows:
    """The draws of the demands of `rocking check`: their columns and lines."""

    def __init__(self, draws: Draws, limit: Limit | None) -> None:
        self._draws = draws
        self._limit = limit  # of the search, None without one
        self.said: list[str] = []  # a line for each demand with draws
        self.falls = False  # True if a draw of a demand falls

    def columns(self, demand: Demand) -> dict[str, Any]:
        """Return the columns of a demand; none without --draws. A structure without a
        spread has empty ones.
        """
        structure, motion, shaking = demand
        if self._draws.draws is None:
            return {}
        from ..envelopes.amplitudes import limit_of
        from ..reports.wording import draws_in_words
        from ..responses.uncertainty import drawn_columns, drawn_verdict

        if structure.drawn_from is None:
            return dict.fromkeys(drawn_columns(self._limit is not None))
        limit = self._limit
        found = drawn_verdict(
            structure,
            motion,
            shaking,
            n=self._draws.draws,
            seed=self._draws.seed,
            a_max=None if limit is None else limit_of(limit, structure),
        )
        draws = found.share.draws + found.left_out
        note_left_out(structure.name, found.left_out, draws, found.fault)
        partly(found.failed > 0)
        self.said.append(draws_in_words(structure.name, found))
        self.falls |= found.share.share > 0.0
        return found.row()

    def fall_opposite(self, demands: Iterable[Demand]) -> bool:
        """Return True if a draw with unequal sides falls in the opposite direction, and
        say of which structure.
        """
        if self._draws.draws is None:
            return False
        from ..dynamics.method import has_direction
        from ..reports.wording import draws_in_words
        from ..responses.uncertainty import drawn_verdict
        from ..structures.draws import draws

        n, seed = self._draws.draws, self._draws.seed
        for structure, motion, shaking in demands:
            if structure.drawn_from is None:
                continue
            # equal means may have unequal sides in the draws
            some = [one.parameters for one in draws(structure.drawn_from, 2, seed)]
            if not any(has_direction(one) for one in (structure, *some) if one):
                continue
            opposite = motion.scaled(-1.0)
            found = drawn_verdict(
                structure, opposite, shaking, n=n, seed=seed, a_max=None
            )
            if found.share.share > 0.0:
                said = draws_in_words(structure.name, found)
                note(f"in the opposite direction (--scale -1) {said}")
                return True
        return False


def note_one_demand(ranged: str) -> None:
    """Say that the draws have no worst azimuth or frequency of their own."""
    note(
        f"all draws are at the worst {ranged} of the means; at another one more of"
        " them may fall"
    )


def note_left_out(name: str, left_out: int, draws: int, fault: str | None) -> None:
    """Print how many draws make no structure, and why the first of them makes none."""
    if not left_out:
        return
    partly()
    note(
        f"{name}: {left_out} of {draws:,} draws make no structure and are left out:"
        f" {fault}"
    )

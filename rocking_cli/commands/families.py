"""Families of structures: the option --vary of several commands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..documents.quantities import headed
from ..structures import with_distinct_names
from ..structures.family import Member, family, members, parse_variation
from ..structures.parameters import VARIED
from .printing import form, note

if TYPE_CHECKING:
    from ..documents.document import Document
    from ..structures import RockingParameters

Family = tuple[list["RockingParameters"], dict[str, dict[str, float]], int]  # structures, columns by name, members without a solution


def families(documents: Sequence[Document], vary: tuple[str, ...]) -> Family:
    """The members of the families of all documents, which are noted where they have no solution.

    The columns hold the varied values in SI units, as `varied_width`, in tables and CSV with the unit.
    """
    from .options import remark_on

    variations = [parse_variation(text) for text in vary]
    members(variations)
    every = [member for document in documents for member in family(document, variations)]
    found = with_distinct_names([member.parameters for member in every if member.parameters is not None])
    columns = {}
    for structure in found:
        values, units = (structure.details[key] for key in VARIED)
        columns[structure.name] = {headed(f"varied_{k}", "" if form() == "json" else units[k]): value for k, value in values.items()}
    for member in every:
        if member.parameters is None:
            note_no_solution(member)
    remark_on(found)
    return found, columns, len(every) - len(found)


def note_no_solution(member: Member) -> None:
    """Print why a member of a family has no solution."""
    varied = ", ".join(f"{key} = {value:g}" for key, value in member.shown.items())
    note(f"no solution for {varied}: {member.fault}")

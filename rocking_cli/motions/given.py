"""What Python gives as a motion and its demand: objects, or what the command line
takes, the name of a pulse, the path of a file, the text of a grid.
"""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, Union

from ..documents.files import several
from ..errors import ArgumentError, MotionError, UsageError
from .grid import Grid, as_recorded, parse_grid
from .motion import Motion

if TYPE_CHECKING:
    from ..documents.document import Document
    from .recording import Recording


class HasMotion(Protocol):
    """Something with a motion of its own: a `Record` or a `Recording`.

    Functions that take a `Motion` take one of these too; it then needs no grid.

    Examples
    --------
    >>> (recording,) = load_records("configs/motions/synthetic.at2")
    >>> (column,) = load_structures("configs/block.yaml")
    >>> check(column, recording, a_max=None).motion
    'synthetic'
    """

    @property
    def motion(self) -> Motion:
        """The motion."""


# A document is named only: what has no document does not import their reader.
AnyMotion = Union[Motion, HasMotion, "Document", str, Path]
Shake = tuple[AnyMotion, Grid | str]  # a motion with its grid


def motion_from(given: AnyMotion) -> Motion:
    """Return the motion of what was given: an object, a document, the name of a pulse,
    the path of a motion document or record, or the text of a motion document. Raises
    UsageError, DocumentError and MotionError as `read_motion` and `pulse` do.
    """
    found = read_if_named(given)
    own = found if isinstance(found, Motion) else found.motion
    if isinstance(own, Motion):
        return own
    raise ArgumentError(
        f"found a {type(found).__name__} for a motion; expected a Motion, a Record, a"
        " Recording, a Document, the name of a pulse or the path of a motion"
    )


def read_if_named(given: AnyMotion) -> Motion | HasMotion:
    """Return the motion, or the record with a motion of its own, of what was given.
    Raises as `motion_from`.
    """
    if isinstance(given, str | Path):
        return _named(given)
    if isinstance(given, Motion) or hasattr(given, "motion"):
        return given
    from .motion_document import build_motion

    return build_motion(given)


def _named(given: str | Path) -> Motion | HasMotion:
    """Return the motion that a text or a path stands for. Raises as `motion_from`."""
    from ..documents.files import is_document_text
    from ..documents.parsing import parse_documents
    from .motion_document import motion_of
    from .pulses import PULSES, pulse
    from .reading import read_one

    text = str(given)
    if isinstance(given, str) and is_document_text(given):
        return motion_of(parse_documents(given))
    word = not any(mark in text for mark in (".", "/", os.sep)) and text != "-"
    if isinstance(given, str) and (
        text in PULSES or (word and not os.path.exists(text))
    ):
        # a pulse, also of an installed package, or a word that is misspelt
        try:
            return pulse(text)
        except MotionError as error:
            raise MotionError(f"{error}; or the path of a motion") from None
    return read_one(given, {})


def recordings_from(
    given: str | Path | Sequence[HasMotion | str | Path],
) -> "tuple[Recording, ...]":
    """Return the records of what was given, those of a path as `load_records` reads
    them, with distinct labels. Raises UsageError and DocumentError as it does, and
    ArgumentError for what is no record.
    """
    from .reading import load_records
    from .recording import Recording, with_distinct_labels
    from .records.record import Record

    found: list[Recording] = []
    for one in several(given):
        if isinstance(one, str | Path):
            found += load_records(one)
        elif isinstance(one, Record):
            found.append(Recording(one))
        elif isinstance(one, Recording):
            found.append(one)
        else:
            raise ArgumentError(
                f"found a {type(one).__name__} for a record; expected a Record, a"
                " Recording or a path"
            )
    return with_distinct_labels(found)


def motions_of(
    given: AnyMotion | Sequence[AnyMotion],
) -> list[Motion | HasMotion]:
    """Return `read_if_named` of each motion, of one or several."""
    return [read_if_named(one) for one in several(given)]


def demand_of(
    motion: AnyMotion, shaking: Grid | str | None = None
) -> tuple[Motion, Grid]:
    """Return the motion and its grid of one cell, which may be a text; a record without
    a grid has its own amplitude.

    Raises UsageError for another motion without a grid, and for a grid of several
    cells.
    """
    found, grid = with_grid(motion, shaking)
    grid.require_one_cell()
    return found, grid


def demands_of(
    given: AnyMotion | Sequence[AnyMotion | Shake],
    shaking: Grid | str | None = None,
) -> list[tuple[Motion, Grid]]:
    """Return each motion with its grid of one cell: that beside it, or `shaking`.
    Raises as `demand_of`.
    """
    return [
        demand_of(*one) if isinstance(one, tuple) else demand_of(one, shaking)
        for one in several(given)
    ]


def with_grid(motion: AnyMotion, grid: Grid | str | None) -> tuple[Motion, Grid]:
    """Return the motion and its grid, which may be a text; a record without a grid has
    its own amplitude.

    Raises UsageError for another motion without a grid.
    """
    found = motion_from(motion)
    if isinstance(grid, str):
        grid = parse_grid(grid, own_time=found.acceleration is not None)
    if grid is not None:
        return found, grid
    if found.acceleration is None:
        raise UsageError(
            f"{found.name}: no grid; expected one, such as 'a_g=0.3g,f_g=1', which only"
            " a record does not need"
        )
    return found, as_recorded(found.acceleration)

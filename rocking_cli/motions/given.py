"""What Python gives as a motion and its demand: objects, or what the command line
takes, the name of a pulse, the path of a file, the text of a grid.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, Union

from ..errors import ArgumentError, UsageError
from .grid import Grid, as_recorded, parse_grid
from .motion import Motion

if TYPE_CHECKING:
    from ..documents.document import Document


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
    return found if isinstance(found, Motion) else _own_motion(found)


def read_if_named(given: AnyMotion) -> Motion | HasMotion:
    """Return the motion, or the record with a motion of its own, of what was given.
    Raises as `motion_from`.
    """
    if isinstance(given, str | Path):
        from .named import named_motion

        return named_motion(given)
    if isinstance(given, Motion) or hasattr(given, "motion"):
        return given
    from .motion_document import build_motion

    return build_motion(given)


def motions_of(
    given: AnyMotion | Sequence[AnyMotion],
) -> list[Motion | HasMotion]:
    """Return `read_if_named` of each motion, of one or several."""
    if isinstance(given, str) or not isinstance(given, Sequence):
        return [read_if_named(given)]
    return [read_if_named(one) for one in given]


def _own_motion(given: HasMotion) -> Motion:
    """Return the motion of a record. Raises ArgumentError for another object with such
    an attribute.
    """
    if isinstance(found := given.motion, Motion):
        return found
    raise ArgumentError(
        f"found a {type(given).__name__} for a motion; expected a Motion, a Record, a"
        " Recording, a Document, the name of a pulse or the path of a motion"
    )


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
    several: Sequence[AnyMotion | Shake]
    if isinstance(given, str) or not isinstance(given, Sequence):
        several = [given]
    else:
        several = given
    return [
        demand_of(*one) if isinstance(one, tuple) else demand_of(one, shaking)
        for one in several
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

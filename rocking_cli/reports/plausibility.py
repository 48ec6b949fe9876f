"""Remarks on numbers that are valid but probably wrong, such as a missing unit or a
very small restitution.
"""

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..documents.quantities import DEFAULT_GRAVITY, split_quantity

if TYPE_CHECKING:
    from ..motions.grid import Grid
    from ..structures.parameters import RockingParameters

LARGEST, SMALLEST = 100.0, 0.02  # m; half diagonals of blocks that were built or tested
_SPAN = re.compile(r"([^,=:]+):([^,=:]+):")
_ACCELERATION = re.compile(r"\b(a_g|PGA)\s*=\s*([^,]+)", re.IGNORECASE)
# several times the largest recorded acceleration
MOST_ACCELERATION = 10.0 * DEFAULT_GRAVITY


def structure_remarks(structure: "RockingParameters") -> Iterator[str]:
    """Yield remarks on the size and restitution of a structure; the size is that of the
    block with equal p, R = 3 g/(4 p^2).
    """
    if structure.dimensionless:
        return
    yield from structure.remarks
    radius = 0.75 * (structure.gravity / structure.p) / structure.p  # p^2 may overflow
    if not SMALLEST <= radius <= LARGEST and not structure.remarks:
        size = "large" if radius > LARGEST else "small"
        yield (
            f"{structure.name}: as {size} as a block of {2.0 * radius:.3g} m from"
            " corner to corner; a length without a unit is in m"
        )
    if not structure.one_sided and structure.eta < 0.3:
        lost = 1.0 - structure.eta**2
        yield (
            f"{structure.name}: eta = {structure.eta:.3g}, so that every impact takes"
            f" {lost:.0%} of the energy; tests mostly show less"
        )


def span_remarks(text: str) -> Iterator[str]:
    """Yield remarks on spans START:STOP:N in a text that state a unit for only one
    bound.
    """
    for bounds in _SPAN.findall(text):
        start, stop = map(split_quantity, bounds)
        for one, other in ((start, stop), (stop, start)):
            if (
                one is not None
                and other is not None
                and one[0]
                and not one[1]
                and other[1]
            ):
                yield (
                    f"{':'.join(bounds)}: {one[0]:g} without a unit is in SI, not in"
                    f" {other[1]}"
                )


def bare_remarks(text: str) -> Iterator[str]:
    """Yield a remark on each acceleration without a unit in a text, as m/s2 and as g:
    NAME=VALUE, or STOP of NAME=START:STOP:N.
    """
    for name, written in _ACCELERATION.findall(text):
        stop = split_quantity(written.split(":")[1 if ":" in written else 0])
        if (
            stop is not None
            and stop[0]
            and not stop[1]
            and abs(stop[0]) <= MOST_ACCELERATION
        ):
            x, g = stop[0], DEFAULT_GRAVITY
            yield (
                f"{name}={written}: {x:g} without a unit is {x:g} m/s2 = {x / g:.3g} g;"
                f" {x:g} g would be {x * g:.4g} m/s2"
            )


def grid_remarks(grid: "Grid") -> Iterator[str]:
    """Yield remarks on the amplitudes of a grid that are probably wrong."""
    highest = float(grid.amplitude.values[-1])
    if grid.amplitude.name == "a_g" and highest > MOST_ACCELERATION:
        yield (
            f"a_g = {highest:.4g} m/s2 is {highest / DEFAULT_GRAVITY:.3g} g; a number"
            " without a unit is in m/s2"
        )

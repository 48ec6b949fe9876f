"""Outcome maps and slices in characters, for a terminal of 80 columns and 24 rows."""

import textwrap

import numpy as np

from ...documents.quantities import headed
from ...dynamics.outcome import Outcome
from ...errors import UsageError
from ...spectra.file.reader import SpectraFile
from ..units import Units
from .colours import SIGNS
from .slices import Slice, of_record, plane, slice_of

WIDTH, HEIGHT = 80, 24  # of the terminal, with a line for the prompt
_MARGIN = 11  # columns for the numbers at the left


def text_map(
    file: SpectraFile, name: str | None, cut: str | None, units: Units
) -> list[str]:
    """Return the outcome map of a structure (or record), or a slice, as up to 23 lines
    of up to 80 characters.
    """
    (_, places), *both = file.frame.dimensions.items()
    if cut:
        return _slice_text(slice_of(file, cut), units)
    place = place_of(file, name)
    if any(isinstance(values, list) for _, values in both):
        return _slice_text(of_record(file, place), units)
    (across, x), (up, y), block = plane(file, place)
    (across, x), (up, y) = _in_units(across, x, units), _in_units(up, y, units)
    outcomes = block["outcome"]
    head = _signs(str(places[place]), outcomes)
    rows = _spread(y.size - 1, 0, HEIGHT - len(head) - 3)
    columns = _spread(0, x.size - 1, WIDTH - _MARGIN)
    return [
        *head,
        *(
            f"{y[r]:>9.3g} |"
            + "".join(SIGNS[Outcome(int(outcomes[r, c]))] for c in columns)
            for r in rows
        ),
        " " * 10 + "+" + "-" * columns.size,
        f"{up:>9}   {across} {x[0]:.4g} to {x[-1]:.4g}",
    ]


def _in_units(name: str, values: np.ndarray, units: Units) -> tuple[str, np.ndarray]:
    """Return the heading of an axis, such as `a_g [g]`, and its values in these
    units.
    """
    shown, unit, factor = units.column(name)
    return headed(shown, unit), values / factor


def _signs(name: str, outcomes: np.ndarray) -> list[str]:
    """Return the name of a map and the meaning of its characters as lines."""
    items = (
        f"{name}:",
        *(f"'{SIGNS[o]}' {o.sentence}" for o in Outcome if np.any(outcomes == o)),
    )
    # No item is broken.
    first, *signs = (item[:WIDTH].replace(" ", "\xa0") for item in items)
    return [
        line.replace("\xa0", " ")
        for line in textwrap.wrap(f"{first} {'  '.join(signs)}", WIDTH)
    ]


def _spread(first: int, last: int, room: int) -> np.ndarray:
    """Return up to `room` indices from `first` to `last`, spread evenly."""
    return np.linspace(first, last, min(room, abs(last - first) + 1)).astype(int)


def place_of(file: SpectraFile, name: str | None) -> int:
    """Return the index of a structure or record, 0 without a
    name. Raises UsageError.
    """
    word, names = next(iter(file.frame.dimensions.items()))
    if name is None:
        return 0
    if name not in names:
        raise UsageError(
            f"{file.path}: no {word} {name!r}; expected {', '.join(map(str, names))}"
        )
    return list(names).index(name)


def _slice_text(found: Slice, units: Units) -> list[str]:
    """Return bars of theta_max/alpha, for as many structures as fit with
    two rows each.
    """
    along, x = _in_units(found.along, found.x, units)
    where = ""
    if found.where != "record":
        name, unit, factor = units.column(found.where)
        where = f" at {name} = {found.coordinate / factor:.6g} {unit}".rstrip()
    lines = [
        f"theta_max/alpha{where} over {along} {x[0]:.4g} to {x[-1]:.4g}; blank: fell"
    ]
    room = HEIGHT - 2
    shown = min(len(found.names), max(1, room // 5))
    tall = max(1, room // shown - 3)
    for name, theta in list(zip(found.names, found.theta, strict=True))[:shown]:
        picked = theta[_spread(0, theta.size - 1, WIDTH - _MARGIN)]
        lines += [
            name.replace(r"$\eta$", "eta").replace(r"\$", "$"),
            *_bars(picked, tall),
        ]
    return [line[:WIDTH] for line in lines]


def _bars(values: np.ndarray, height: int) -> list[str]:
    """Return bars of this height in rows of characters; none for NaN."""
    top = float(np.nanmax(np.append(values, 1e-300)))
    filled = [-1 if np.isnan(v) else round(height * v / top) for v in values]
    marks = [
        f"{top * r / height:>9.3g} |" + "".join("*" if f == r else " " for f in filled)
        for r in range(height, -1, -1)
    ]
    return [*marks, " " * 10 + "+" + "-" * len(filled)]

"""The grid of a sweep: an amplitude axis and a frequency axis, both with units or both
dimensionless.
"""

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arguments import check_fields
from ..documents.quantities import (
    DEFAULT_GRAVITY,
    quantity_at,
    split_quantity,
    with_a_point,
)
from ..documents.spans import spaced, split_span
from ..errors import UsageError, counted, did_you_mean
from ..structures.parameters import RockingParameters
from .motion import Motion

MAX_CELLS = 10**10
MAX_VALUES = 10**7
# omega_g/p; theta is then about 1e-20 alpha, and above 1e13 an outcome is only rounding
MOST_OMEGA = 1e10

_PULSE_AXES = {
    "A": ("A", "number"),
    "Omega": ("Omega", "number"),
    "a_g": ("a_g", "acceleration"),
    "omega_g": ("omega_g", "angular frequency"),
    "f_g": ("omega_g", "frequency"),
    "T_g": ("omega_g", "time"),
}
_RECORD_AXES = {
    "scale": ("scale", "number"),
    "A": ("A", "number"),
    "a_g": ("a_g", "acceleration"),
    "T": ("T", "time"),
    "p": ("T", "angular frequency"),
    "alpha": ("alpha", "angle"),
    "tan_alpha": ("alpha", "number"),
}
MEANT = {
    "pga": "a_g",
    "a": "A",
    "w": "omega_g",
    "f": "f_g",
    "frequency": "f_g",
    "period": "T_g",
    "t": "T_g",
}
_FORM = "NAME=START:STOP:N[:log] or NAME=VALUE"
_SPAN = "START:STOP:N[:log] or a single VALUE"
# units and long name of each axis in a file
AXES = {
    "A": ("1", "dimensionless amplitude a_scale a_g / (alpha g)"),
    "Omega": ("1", "dimensionless frequency omega_g / p"),
    "a_g": ("m s-2", "amplitude of ground acceleration"),
    "omega_g": ("rad s-1", "angular frequency of ground motion"),
    "scale": ("1", "factor of the records"),
    "T": ("s", "2 pi / p, a measure of size and no period"),
    "alpha": ("rad", "critical angle"),
}
_FROM_ZERO = ("A", "a_g", "scale")
# axes that go together; the last pair is that of records
_PAIRS = (("A", "Omega"), ("a_g", "omega_g"), ("A", "omega_g"))


@dataclass(frozen=True, eq=False)
class Axis:
    """An axis of a grid.

    `parse_grid` makes the axes of a text. Raises UsageError for values that are not
    valid.

    Attributes
    ----------
    name: its name in the file, one of AXES
    values: rising, in SI units, (n,)

    Examples
    --------
    >>> import numpy as np
    >>> Axis("Omega", np.array([2.0, 4.0, 8.0])).stated()[:3]
    [2.0, 8.0, 3]
    """

    name: str  # its name in the file, one of AXES
    values: np.ndarray  # rising, in SI units, (n,)

    def __post_init__(self) -> None:
        v = self.values
        if self.name not in AXES:
            raise UsageError(f"axis {self.name!r} is not one of {', '.join(AXES)}")
        if (
            v.ndim != 1
            or not v.size
            or not np.all(np.isfinite(v))
            or np.any(np.diff(v) <= 0.0)
        ):
            raise UsageError(f"axis {self.name}: its values must be finite and rise")
        if v[0] < 0.0 or (v[0] == 0.0 and self.name not in _FROM_ZERO):
            raise UsageError(
                f"axis {self.name}: its values must be"
                f" positive{', or zero' if self.name in _FROM_ZERO else ''}"
            )
        if self.name == "alpha" and v[-1] >= 0.5 * math.pi:
            raise UsageError(
                f"axis alpha: found {v[-1]:g} rad; expected angles below a right one"
            )

    def __repr__(self) -> str:
        first, last = f"{self.values[0]:.4g}", f"{self.values[-1]:.4g}"
        span = first if self.values.size == 1 else f"{first} to {last}"
        unit = {"1": "", "m s-2": " m/s2", "rad s-1": " rad/s"}
        return (
            f"Axis({self.name}: {counted(self.values.size, 'value')},"
            f" {span}{unit.get(AXES[self.name][0], ' ' + AXES[self.name][0])})"
        )

    def stated(self) -> list[float | int]:
        """Return [first value, last value, number of values, CRC-32 of the values], to
        compare two axes.
        """
        v = self.values
        return [float(v[0]), float(v[-1]), v.size, zlib.crc32(v.tobytes())]


@dataclass(frozen=True, eq=False)
class Grid:
    """The cells of a sweep: the axes A and Omega, or a_g and omega_g.

    For a record also A and omega_g. `parse_grid` makes one of a text; a grid of one
    cell is the demand of `check` and `time_history`. `scaled` and `cell` give A and
    Omega of a structure. Raises UsageError for other pairs of axes.

    Attributes
    ----------
    amplitude: A [-] or a_g [m/s2]
    frequency: Omega [-] or omega_g [rad/s]

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> a, omega = parse_grid("a_g=0.35g,f_g=1.5").cell(column)
    >>> f"A = {a:.4f}, Omega = {omega:.4f}"
    'A = 1.4287, Omega = 3.5277'
    """

    amplitude: Axis  # A [-] or a_g [m/s2]
    frequency: Axis  # Omega [-] or omega_g [rad/s]

    def __post_init__(self) -> None:
        check_fields(self)
        names = self.amplitude.name, self.frequency.name
        if names not in _PAIRS:
            raise UsageError(
                f"axes {' and '.join(names)} do not go together: give A and Omega, or"
                " a_g and omega_g"
            )

    @property
    def dimensionless(self) -> bool:
        """True if the axes are A and Omega."""
        return self.frequency.name == "Omega"

    @property
    def shape(self) -> tuple[int, int]:
        """(number of frequencies, number of amplitudes)."""
        return self.frequency.values.size, self.amplitude.values.size

    def scaled(self, structure: RockingParameters) -> tuple[np.ndarray, np.ndarray]:
        """Return the values of the axes for one structure.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        tuple of two arrays
            A = a_scale a_g/(alpha g) [-], (amplitudes,), and Omega = omega_g/p [-],
            (frequencies,)

        Raises
        ------
        UsageError
            for an Omega above 1e10
        """
        a = self.amplitude.values
        a = a if self.amplitude.name == "A" else structure.dimensionless_amplitude(a)
        return a, scaled_frequency(self.frequency, structure)

    def cell(self, structure: RockingParameters) -> tuple[float, float]:
        """Return A and Omega of a grid of one cell for one structure.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        tuple of two floats
            A [-] and Omega [-]

        Raises
        ------
        UsageError
            for a grid of several cells, and for an Omega above 1e10
        """
        self.require_one_cell()
        amplitude, omega = self.scaled(structure)
        return float(amplitude[0]), float(omega[0])

    def require_one_cell(self) -> None:
        """Raise UsageError for a grid of several cells."""
        if math.prod(self.shape) == 1:
            return
        frequencies, amplitudes = self.shape
        found = f"found a grid of {frequencies} frequencies and {amplitudes} amplitudes"
        one = "parse_grid('a_g=0.3g,f_g=1')"
        raise UsageError(
            f"`shaking`: {found}; expected one of each, such as {one}; spectrum()"
            " computes a grid"
        )


def scaled_frequency(axis: Axis, structure: RockingParameters) -> np.ndarray:
    """Return the Omega values of an axis Omega or omega_g for one structure. Raises
    UsageError beyond `MOST_OMEGA`.
    """
    omega = axis.values if axis.name == "Omega" else axis.values / structure.p
    if (highest := float(np.max(omega))) > MOST_OMEGA:
        found = (
            f"found Omega = omega_g/p = {highest:.3g}; expected a value up to"
            f" {MOST_OMEGA:g}"
        )
        raise UsageError(
            f"{structure.name}: {found}; above it the rotation is below double"
            " precision"
        )
    return omega


def parse_axes(text: str, *, records: bool = False) -> dict[str, Axis]:
    """Return the axes by name of a text such as `a_g=0.1g:1g:50,omega_g=1:20:40:log`;
    records: those of records. Raises UsageError.
    """
    axes: dict[str, Axis] = {}
    known = _RECORD_AXES if records else _PULSE_AXES
    for part in text.split(","):
        key, equals, span = (x.strip() for x in part.partition("="))
        if not equals or not span:
            raise UsageError(
                f"`grid`: found {part.strip()!r}; expected {_FORM}, with commas between"
                f" axes{with_a_point(text)}"
            )
        if key not in known:
            why = (
                ", since a record runs in its own time"
                if key in _PULSE_AXES
                else did_you_mean(key, known, MEANT)
            )
            raise UsageError(
                f"`grid`: unknown axis {key!r}; expected {', '.join(known)}{why}"
            )
        name, dimension = known[key]
        values = parse_span(f"`grid` {key}", span, dimension)
        if values[0] < 0.0 or (values[0] == 0.0 and key not in _FROM_ZERO):
            how = (
                " or zero; `scale` -1 gives the motion the other direction"
                if key in _FROM_ZERO
                else ""
            )
            raise UsageError(
                f"`grid` {key}: found {span!r}; expected positive values{how}"
            )
        if key == "f_g":
            values = 2.0 * math.pi * values
        elif key in ("T_g", "p"):
            values = (2.0 * math.pi / values)[::-1]
        elif key == "tan_alpha":
            values = np.arctan(values)
        if name in axes:
            raise UsageError(f"`grid`: axis {name} is given twice")
        axes[name] = Axis(name, values)
    return axes


def written_axes(text: str) -> str:
    """Return the names of the axes as the user wrote them."""
    return " and ".join(part.partition("=")[0].strip() for part in text.split(","))


# rad/s; then the phase of a record is its time in s
OWN_TIME = Axis("omega_g", np.array([1.0]))


def as_recorded(acceleration: float) -> Grid:
    """Return the grid of one cell of a record with this PGA [m/s2]."""
    return Grid(Axis("a_g", np.array([acceleration])), OWN_TIME)


def demand_in_words(shakes: Sequence[tuple[Motion, Grid]]) -> str:
    """Return a text on the amplitude and frequency of motions, each with a grid of one
    cell.
    """
    values = [float(grid.amplitude.values[0]) for _, grid in shakes]
    motion, grid = shakes[0]
    name, own_time = grid.amplitude.name, motion.acceleration is not None

    def span(unit: float, digits: int) -> str:
        return " to ".join(
            dict.fromkeys(f"{x / unit:.{digits}g}" for x in (min(values), max(values)))
        )

    text = f"{'PGA' if own_time and name == 'a_g' else name} {span(1.0, 5)}"
    if name == "a_g":
        text += f" m/s2 = {span(DEFAULT_GRAVITY, 3)} g"
    if not own_time:
        values = [float(grid.frequency.values[0]) for _, grid in shakes]
        text += (
            f", Omega {span(1.0, 5)}"
            if grid.dimensionless
            else f", f_g {span(math.tau, 5)} Hz"
        )
    motions = len({id(motion) for motion, _ in shakes})
    return f"{text}{f', {motions} motions' if motions > 1 else ''}"


def parse_grid(text: str, *, own_time: bool = False) -> Grid:
    """Return the grid that a text states.

    Parameters
    ----------
    text
        two axes with a comma between them, each NAME=START:STOP:N,
        NAME=START:STOP:N:log or NAME=VALUE: A and Omega, or a_g and one of omega_g,
        f_g, T_g; a bound may have a unit, such as 0.3g
    own_time
        True: the grid of a record, which has one axis, A or a_g

    Returns
    -------
    Grid
        a_g in m/s2, omega_g in rad/s

    Raises
    ------
    UsageError
        for a text of another form, an unknown axis, a value that is not positive, or
        more than 1e10 cells

    Examples
    --------
    >>> grid = parse_grid("a_g=0.1g:1g:50,f_g=0.5:5:40")
    >>> grid.shape  # frequencies, amplitudes
    (40, 50)
    >>> f"{grid.amplitude.values[-1]:.2f} m/s2, {grid.frequency.values[-1]:.3f} rad/s"
    '9.81 m/s2, 31.416 rad/s'
    """
    axes = parse_axes(text)
    if own_time:
        if len(axes) != 1 or next(iter(axes)) not in ("A", "a_g"):
            raise UsageError(
                f"`grid`: found {written_axes(text)}; expected A or a_g, since a record"
                " runs in its own time"
            )
        axes["omega_g"] = OWN_TIME
    for amplitude, frequency in _PAIRS[: 3 if own_time else 2]:
        if axes.keys() == {amplitude, frequency}:
            grid = Grid(axes[amplitude], axes[frequency])
            if (cells := math.prod(grid.shape)) <= MAX_CELLS:
                return grid
            found = f"{cells:.3g} cells ({9e-9 * cells:.3g} GB)"
            raise UsageError(
                f"`grid`: {found} are more than the limit of {MAX_CELLS:.0e} in one"
                " file; split the grid"
            )
    raise UsageError(
        f"`grid`: found {written_axes(text)}; expected A and Omega, or a_g and one of"
        " omega_g, f_g, T_g"
    )


def parse_angles(text: str) -> Axis:
    """Return the axis alpha of `10,15,20deg` (a unit serves the numbers to its left) or
    START:STOP:N. Raises UsageError.
    """
    if ":" in text:
        return Axis("alpha", parse_span("`alpha`", text, "angle"))
    unit, found = "", []
    for part in reversed(text.split(",")):
        parts = split_quantity(part)
        unit = parts[1] if parts is not None and parts[1] else unit
        stated = part.strip() if parts is None or parts[1] else f"{part} {unit}".strip()
        found.append(
            quantity_at(
                "`alpha`", stated, "angle", hint=", or several with commas between them"
            )
        )
    values = np.unique(found)
    if values.size < len(found):
        raise UsageError(
            f"`alpha`: found {text!r}, which states an angle twice; expected distinct"
            " angles"
        )
    if values[0] <= 0.0:
        raise UsageError(f"`alpha`: found {text!r}; expected positive angles")
    return Axis("alpha", values)


def parse_span(key: str, span: str, dimension: str) -> np.ndarray:
    """Return the values of START:STOP:N[:log] or of a single VALUE, in SI units, of any
    sign. Raises UsageError.
    """
    if ":" not in span:
        return np.array([quantity_at(key, span, dimension)])
    first, last, count, log = split_span(key, span, _SPAN, 2, MAX_VALUES)
    start, stop = (quantity_at(key, x, dimension) for x in (first, last))
    if start >= stop:
        raise UsageError(
            f"{key}: found START {first} and STOP {last}; expected START below STOP"
            f" (a single value is written {key}={first})"
        )
    return spaced(key, start, stop, count, log)

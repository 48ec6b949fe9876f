"""The check of a local mechanism by the Italian code: Circolare 21 gennaio 2019 n. 7,
section C8.7.1.2.1.

    a = alpha g/(e* FC) (C8.7.1.3),
    T_s = k pi sqrt(d_s/a(d_s)), k = 1.68 at SLV and 1.56 at SLC (C8.7.1.10, 11)

A motion reaches a limit state at the amplitude whose spectral displacement is d_s, or
at uplift if that amplitude is larger.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, Decimal
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..digits import digits_apart
from ..documents.quantities import DEFAULT_GRAVITY
from ..dynamics.method import governing_method
from ..dynamics.outcome import Outcome
from ..dynamics.response import response
from ..envelopes.first_falls import Climb, lowest_falls
from ..errors import UsageError
from ..motions import Motion
from ..motions.design_spectra import (
    AnySpectrum,
    FloorSpectrum,
    MotionSpectrum,
    SpectrumFile,
    read_spectrum,
)
from ..motions.floors import on_floors
from ..motions.given import AnyMotion, demand_of
from ..motions.grid import Grid
from ..showing import Shown
from ..structures.building_modes import FloorMode
from ..structures.given import Structure, structure_from
from ..structures.mechanics.capacity_curve import CapacityCurve, capacity_curves
from ..structures.parameters import RockingParameters

Q = 2.0  # behaviour factor of the linear check
ROTATION = 0.40  # of alpha, which is d_SLV of a slender body
# of amplitudes: step of a search, width of its answer; amplitudes that are looked at
# together
_RATIO, _EXACT, _AT_ONCE = (5e-3, 1e-4, 20)
METHODS = {"code_linear": f"q = {Q:g}", "code_slv": "SLV", "code_slc": "SLC"}


# the columns that `rocking check --code` adds
CODE_COLUMNS = (
    *(column for key in METHODS for column in (key, f"{key}_ratio")),
    *("theta_04_a", "theta_04_ratio", "e_star", "d_slv", "t_slv", "d_slc", "t_slc"),
)


class LimitState(NamedTuple):
    """A limit state of the displacement method."""

    share: float  # of d0 [-]
    factor: float  # secant period over pi sqrt(d/a) [-]
    damping: float  # of the demand [-]


SLV, SLC = LimitState(0.40, 1.68, 0.08), LimitState(0.60, 1.56, 0.10)
STATES = {"slv": SLV, "slc": SLC}  # by their names in columns


class CodeDemand(NamedTuple):
    """The demand of a limit state."""

    name: str  # of the motion or the file
    amplitude: float  # of the motion, or the peak of the file [m/s2]
    spectrum: AnySpectrum  # of the motion or the file, or of a floor above it


class Reached(NamedTuple):
    """A limit state of a mechanism."""

    state: LimitState  # the limit state
    displacement: float  # d [m]
    acceleration: float  # a [m/s2]
    period: float  # secant period T [s]
    demand: float  # on the displacement [m]
    amplitude: float  # of the motion that reaches it [m/s2]
    broken: bool  # True if a tie decides it by its break
    of: CodeDemand  # of the spectrum

    @property
    def ratio(self) -> float:
        """The amplitude over that of the demand."""
        return self.amplitude / self.of.amplitude


@dataclass(frozen=True, repr=False)
class CodeCheck(Shown):
    """A structure checked by the Italian code, as `code_check` returns it.

    Amplitudes are those of the motion, or the peak of a spectrum file. Of several
    directions these are the least amplitudes, and the curve with the least code_slv. A
    limit state without a spectrum, or with one that ends before its period, is None,
    and `unanswered` says why. `accepted` gives the amplitude that each method accepts,
    `row` the columns that `rocking check --code` adds.

    Attributes
    ----------
    structure: its name
    demand: name of the motion or the file, of two files both
    demand_a: amplitude of the motion or the file [m/s2], of two files that of SLV
    factor: a over alpha, g/(e* FC) [m/s2]
    linear: amplitude that q = 2 accepts [m/s2]
    slv: limit state of life safety
    slc: limit state of collapse
    curve: of the mechanism
    asked: the demand of each limit state, by "SLV" or "SLC"
    unanswered: why the spectrum of a limit state gives no answer, by "SLV" or "SLC"
    on_floor: True for the spectrum of a floor, if the dynamics are on the ground

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> found = code_check(column, sine(), parse_grid("a_g=0.3g,T_g=0.4"))
    >>> {key: round(a, 3) for key, a in found.accepted().items()}
    {'code_linear': 4.905, 'code_slv': 5.264, 'code_slc': 7.502}
    """

    structure: str  # its name
    demand: str  # name of the motion or the file, of two files both
    # amplitude of the motion or the file [m/s2], of two files that of SLV
    demand_a: float
    factor: float  # a over alpha, g/(e* FC) [m/s2]
    # amplitude that q = 2 accepts [m/s2], under the spectrum of SLV; None without it
    linear: float | None
    slv: Reached | None  # limit state of life safety
    slc: Reached | None  # limit state of collapse
    curve: CapacityCurve  # of the mechanism
    asked: dict[str, CodeDemand]  # the demand of each limit state, by "SLV" or "SLC"
    # why the spectrum of a limit state gives no answer, by "SLV" or "SLC"
    unanswered: dict[str, str]
    # True for the spectrum of a floor, if the dynamics are on the ground
    on_floor: bool

    def _shown(self) -> dict[str, Any]:
        found = {"structure": self.structure, "demand": self.demand}
        return {**found, "demand_a": self.demand_a, **self.row()}

    def row(self, beyond: float | None = None) -> dict[str, Any]:
        """Return the columns that `rocking check --code` adds.

        Parameters
        ----------
        beyond
            the amplitude that `first_beyond` found [m/s2], None without one

        Returns
        -------
        dict
            values [SI] by column
        """
        found: dict[str, Any] = {}
        accepted, ratios = self.accepted(), self.ratios()
        for key in METHODS:
            found |= {key: accepted.get(key), f"{key}_ratio": ratios.get(key)}
        ratio = None if beyond is None else beyond / self.demand_a
        found |= {"theta_04_a": beyond, "theta_04_ratio": ratio}
        found["e_star"] = self.curve.e_star
        for key, at in (("slv", self.slv), ("slc", self.slc)):
            found[f"d_{key}"] = None if at is None else at.displacement
            found[f"t_{key}"] = None if at is None else at.period
        return found

    def reached(self) -> dict[str, Reached]:
        """Return the limit states that have an answer, by "SLV" and "SLC".

        Returns
        -------
        dict of str to Reached
        """
        both = {"SLV": self.slv, "SLC": self.slc}
        return {key: at for key, at in both.items() if at is not None}

    def accepted(self) -> dict[str, float]:
        """Return the amplitude [m/s2] that each method accepts, by its column, of those
        that have an answer.

        Returns
        -------
        dict of str to float
        """
        linear = {} if self.linear is None else {"code_linear": self.linear}
        states = self.reached().items()
        return linear | {f"code_{key.lower()}": at.amplitude for key, at in states}

    def ratios(self) -> dict[str, float]:
        """Return each amplitude of `accepted` over that of its demand [-].

        Returns
        -------
        dict of str to float
        """
        linear = (
            {} if self.linear is None else {"code_linear": self.linear / self.demand_a}
        )
        states = self.reached().items()
        return linear | {f"code_{key.lower()}": at.ratio for key, at in states}

    def verified(self, state: str) -> bool:
        """Return whether a limit state, "SLV" or "SLC", is verified; False without an
        answer.

        Parameters
        ----------
        state
            "SLV" or "SLC"

        Returns
        -------
        bool
        """
        at = self.reached().get(state)
        return at is not None and at.ratio >= 1.0

    def sentence(self, key: str) -> str:
        """Return a verdict of the code, such as `SLV: not verified (0.62)`.

        Parameters
        ----------
        key
            the method: "code_linear", "code_slv" or "code_slc"

        Returns
        -------
        str
            with the accepted amplitude over the demand, rounded down
        """
        ratio, said = self.ratios().get(key), f"{METHODS[key]}: {self.verdict(key)}"
        if ratio is None:
            why = self.unanswered.get(METHODS[key], "it has no spectrum")
            return f"{said} ({why})"
        shown = Decimal(repr(ratio)).quantize(Decimal("0.01"), ROUND_FLOOR)
        return f"{said} ({shown})"

    def verdict(self, key: str) -> str:
        """Return "verified", "not verified" or "not known".

        Parameters
        ----------
        key
            the method, as of `sentence`

        Returns
        -------
        str
        """
        ratio = self.ratios().get(key)
        if ratio is None:
            return "not known"
        return "verified" if ratio >= 1.0 else "not verified"

    def promises(self, fall: float | None, beyond: float | None) -> list[str]:
        """Return a sentence on each method that accepts more than the dynamics do.

        Parameters
        ----------
        fall
            the lowest amplitude that overturns the body [m/s2], None without one
        beyond
            the amplitude that `first_beyond` found [m/s2], None without one

        Returns
        -------
        list of str
            none on a floor spectrum, since the dynamics are those on the ground
        """
        lines = []
        for key, a in {} if self.on_floor else self.accepted().items():
            if fall is not None and a > fall:
                less, there = fall, "the body overturns"
            elif key == "code_slv" and beyond is not None and a > beyond:
                less, there = beyond, f"theta exceeds {ROTATION:g} alpha"
            else:
                continue
            more, less = a / DEFAULT_GRAVITY, less / DEFAULT_GRAVITY
            digits = digits_apart(more, less, 3)
            lines.append(
                f"the {METHODS[key]} method accepts {more:#.{digits}g} g, {there} at"
                f" {less:#.{digits}g} g"
            )
        return lines


def code_check(
    structure: Structure,
    motion: AnyMotion | None = None,
    shaking: Grid | str | None = None,
    *,
    site: SpectrumFile | str | Path | None = None,
    site_slc: SpectrumFile | str | Path | None = None,
    floor: Sequence[FloorMode] = (),
    confidence: float = 1.0,
) -> CodeCheck:
    """Check a structure by the Italian code "ntc2018", with its capacity curve.

    It is the check of local mechanisms of Circolare 21 gennaio 2019 n. 7, C8.7.1.2.1.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"; with
        a geometry
    motion
        the motion whose spectrum is the demand: an object, the name of a pulse, or a
        path; None with a spectrum
    shaking
        amplitude and frequency of the motion, a grid of one cell or its text; a record
        does not need it
    site
        the design spectrum of SLV, or the path of its file, in place of the motion's,
        with which the motion is not used
    site_slc
        that of SLC, which has another return period; without one of the two its limit
        state is not checked
    floor
        the modes of the building that carries the body, on a ground with this spectrum;
        by default those of the structure
    confidence
        confidence factor FC of the code [-], from 1

    Returns
    -------
    CodeCheck
        amplitudes [m/s2] that the linear check (q = 2), SLV and SLC accept

    Raises
    ------
    UsageError
        for a structure without geometry, without a motion and a spectrum, or an
        amplitude of zero

    Notes
    -----
    The code compares displacements of an equivalent oscillator; `check` integrates the
    motion. `CodeCheck.promises` says where the code accepts more.

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> found = code_check(column, sine(), parse_grid("a_g=0.3g,T_g=0.4"))
    >>> accelerations = found.linear, found.slv.amplitude, found.slc.amplitude
    >>> [round(acceleration / 9.81, 3) for acceleration in accelerations]
    [0.5, 0.537, 0.765]
    """
    structure = structure_from(structure)
    if not 1.0 <= confidence < math.inf:
        raise UsageError(
            f"`fc`: found {confidence:g}; expected a confidence factor from 1, such as"
            " 1.35"
        )
    sites = {"slv": site, "slc": site_slc}
    # from the dynamics, which are those on the ground
    apart = bool(floor) and not structure.building
    floor = floor or structure.building
    structure = replace(structure, building=())
    if isinstance(motion, Motion) and motion.floor is not None:
        apart = False
    asked = {key: _of_file(one, floor) for key, one in sites.items() if one is not None}
    if not asked:
        if motion is None:
            raise UsageError("no demand; expected a motion, or the spectrum of a site")
        asked = dict.fromkeys(STATES, _of_motion(structure, motion, shaking, floor))
    found = [
        _checked(structure, curve, asked, confidence, apart)
        for curve in capacity_curves(structure)
    ]
    weakest = min(found, key=lambda one: one.ratios().get("code_slv", math.inf))
    linear = [one.linear for one in found if one.linear is not None]
    unanswered = {key: why for one in found for key, why in one.unanswered.items()}
    slc = [one.slc for one in found if one.slc is not None]
    return replace(
        weakest,
        linear=min(linear, default=None),
        slv=None if "SLV" in unanswered else weakest.slv,
        slc=(
            min(slc, key=lambda at: at.amplitude)
            if slc and "SLC" not in unanswered
            else None
        ),
        unanswered=unanswered,
    )


def _of_file(site: SpectrumFile | str | Path, floor: Sequence[FloorMode]) -> CodeDemand:
    """Return the demand of the spectrum of a file, on a floor if it has modes."""
    found = read_spectrum(site) if isinstance(site, str | Path) else site
    spectrum = FloorSpectrum(found, tuple(floor)) if floor else found
    return CodeDemand(found.name, found.pga, spectrum)


def _of_motion(
    structure: RockingParameters,
    motion: AnyMotion,
    shaking: Grid | str | None,
    floor: Sequence[FloorMode],
) -> CodeDemand:
    """Return the demand of the spectrum of a motion, on a floor if it has modes. Raises
    UsageError.
    """
    motion, shaking = demand_of(motion, shaking)
    a, omega = shaking.cell(structure)
    amplitude = float(structure.ground_acceleration(a))
    if not amplitude > 0.0:
        raise UsageError("the amplitude is 0; expected a positive one")
    ground, pace = motion, omega * structure.p
    if floor and motion.floor is not None:  # the code makes its own floor
        ground, pace = motion.floor.ground, motion.floor.omega
    found = MotionSpectrum.of(ground, amplitude, pace)
    spectrum = FloorSpectrum(found, tuple(floor)) if floor else found
    return CodeDemand(motion.name, amplitude, spectrum)


def _checked(
    structure: RockingParameters,
    curve: CapacityCurve,
    asked: Mapping[str, CodeDemand],
    confidence: float,
    apart: bool,
) -> CodeCheck:
    """Return the check of one direction of a structure; asked: the demand of each limit
    state, by the names of `STATES`.
    """
    factor = structure.gravity / (curve.e_star * confidence)
    uplift = {
        key: of.amplitude * factor * float(curve.multiplier[0]) / of.spectrum.pga
        for key, of in asked.items()
    }
    reached: dict[str, Reached] = {}
    unanswered = {}
    for key, of in asked.items():
        try:
            reached[key] = _reached(curve, factor, STATES[key], of, uplift[key])
        except UsageError as error:  # the spectrum ends before the period
            unanswered[key.upper()] = str(error)
    first = next(iter(asked.values()))
    return CodeCheck(
        structure.name,
        " and ".join(dict.fromkeys(of.name for of in asked.values())),
        first.amplitude,
        factor,
        Q * uplift["slv"] if "slv" in asked else None,
        reached.get("slv"),
        reached.get("slc"),
        curve,
        {key.upper(): of for key, of in asked.items()},
        unanswered,
        apart,
    )


def _reached(
    curve: CapacityCurve,
    factor: float,
    state: LimitState,
    of: CodeDemand,
    uplift: float,
) -> Reached:
    d, alpha, broken = curve.limit(state.share)
    period = state.factor * math.pi * math.sqrt(d / (alpha * factor))
    asked = of.spectrum.demand(period, state.damping)
    return Reached(
        state,
        d,
        alpha * factor,
        period,
        asked,
        max(uplift, of.amplitude * d / asked),
        broken,
        of,
    )


def first_beyond(
    structure: Structure,
    motion: AnyMotion,
    shaking: Grid | str | None = None,
    share: float = ROTATION,
    *,
    most: float | None = None,
) -> float | None:
    """Return the lowest amplitude under which a body turns beyond a share of alpha, or
    falls.

    The governing equation decides, as for `check`. Amplitudes 0.5 % apart are tried: a
    narrower interval may be missed.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    shaking
        the demand, a grid of one cell or its text; a record does not need it
    share
        |theta|/alpha that counts as beyond [-]; 0.4 is that of SLV
    most
        upper end of the search, an a_g [m/s2]; None for ten times the demand

    Returns
    -------
    float or None
        a_g [m/s2]; None if there is no such amplitude up to `most`

    Raises
    ------
    UsageError
        for a grid of several cells, or an equation that does not hold for the structure

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> round(first_beyond(column, sine(), parse_grid("a_g=0.3g,T_g=0.4")) / 9.81, 3)
    0.571
    """
    body = structure_from(structure)
    ((structure, moved, shaking),) = on_floors([(body, *demand_of(motion, shaking))])
    demand, omega = shaking.cell(structure)
    system = governing_method(structure, dimensionless=shaking.dimensionless).system_of(
        structure
    )
    low = system.least_uplift(moved)
    top = 10.0 * demand if most is None else structure.dimensionless_amplitude(most)

    def march(row: np.ndarray, amplitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = response(system, moved, amplitude, omega, how="floats")
        with np.errstate(invalid="ignore"):
            beyond = found.theta_ratio > share  # counts as a fall
        found.outcome[beyond] = Outcome.OVERTURNED_AFTER_IMPACT
        return found.outcome, found.impacts_at_least

    climb = Climb(np.array([low]), np.array([top]), np.array([low]), _RATIO)
    found = lowest_falls(march, climb, _EXACT, stretch=_AT_ONCE)
    first = float(found.amplitude[0])
    return float(structure.ground_acceleration(first)) if math.isfinite(first) else None

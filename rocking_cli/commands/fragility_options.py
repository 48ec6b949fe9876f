"""The options of `rocking fragility`, and the levels, limit states and methods that
they state.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import ArgumentError
from . import options
from .command import flag, option
from .parameter_types import NUMBER, InputPath, Registered, quantity

if TYPE_CHECKING:
    import numpy as np

    from ..motions.intensity_measures import Measure


@dataclass(frozen=True)
class FragilityOptions:
    """What to fit, under which motions, and what to print and write."""

    pulses: str | None = option(
        "--pulses",
        "Site pulses instead of records: CSV of a_g, f_g, weight.",
        type=InputPath(),
    )
    im: str = option(
        "--im",
        "Intensity measure of the curves.",
        default="PGA",
        type=Registered("motions.intensity_measures.MEASURES"),
    )
    levels: str | None = option(
        "--levels",
        "Levels: START:STOP:N[:log] or a list, with units: 0.1g:1g:10.",
        metavar="LEVELS",
    )
    limits: str = option(
        "--limit",
        "Limit states: |theta|/alpha beyond these.",
        default="0.1,0.5,1,overturning",
    )
    methods: str = option(
        "--method", "One or more of stripes, first and cloud.", default="stripes"
    )
    exact: bool = flag(
        "--exact",
        "Trace every interval that overturns, for exact shares of overturning motions"
        " at every intensity.",
    )
    efficiency: bool = flag(
        "--efficiency",
        "Print the dispersion for every measure instead; with --exact, from the traced"
        " first overturnings.",
    )
    cells: bool = flag(
        "--cells",
        "Print every motion at every level over PGA and PGV/PGA instead, for rocking"
        " plot.",
    )
    curve: bool = flag(
        "--curve",
        "Print points of the curves with their bands instead, for rocking plot.",
    )
    counts: str | None = option(
        "--counts",
        "Fit given counts: CSV of im, n, z; im may state its unit, as PGA [g].",
        type=InputPath(),
    )
    hazard: str | None = option(
        "--hazard",
        "Annual rates with this hazard curve: CSV of OpenQuake, or two columns.",
        type=InputPath(),
    )
    site: str | None = option(
        "--site",
        "The site of the hazard curve, if the file has several.",
        metavar="LON,LAT",
    )
    standing: float | None = option(
        "--standing",
        "Time the body has stood, such as 10000yr, to test the hazard curve.",
        type=quantity("number of years"),
        metavar="TIME",
    )
    export: str | None = option(
        "--export",
        "Write -o for this program: NRML (.xml), or CSV and JSON (.csv).",
        type=click.Choice(["openquake", "pelicun"]),
    )
    by: str | None = option(
        "--by",
        "A curve for each value of this label of a table, of all its structures.",
        metavar="COLUMN",
    )
    samples: int = option(
        "--bootstrap",
        "Samples for the bands; 0: no bands.",
        type=click.IntRange(0, 100_000),
        default=1000,
    )
    draws: int | None = options.draws()
    seed: int = options.seed()
    output: Path | None = options.output(
        "The curves as a figure (.png, .svg, .pdf), the HDF5 file of all cells"
        " (records), or the file of --export."
    )

    @property
    def figure(self) -> Path | None:
        """The figure of the curves, None if -o is another file."""
        if self.output is None or self.export is not None:
            return None
        return self.output if self.output.suffix.lower() in options.FIGURES else None

    def levels_of(self, measure: Measure) -> np.ndarray:
        """Return the levels that --levels states, in SI. Raises UsageError."""
        import numpy as np

        from ..documents.quantities import parse_quantity, with_a_point
        from ..fragility.fits import check_levels
        from ..motions.grid import parse_span

        text = self.levels
        if text is None:
            raise click.UsageError(
                f"no --levels; expected START:STOP:N[:log] of {measure.name}, or a"
                " list, such as 0.1g:1g:10"
            )
        if ":" in text:
            options.remark_on(spans=f"{measure.name}={text}")
            return check_levels(parse_span("--levels", text, measure.dimension))
        if with_a_point(text) and "0" in text.split(","):
            raise click.UsageError(
                f"--levels: found {text!r}; expected positive levels, with commas"
                f" between them{with_a_point(text)}"
            )

        def level(part: str) -> float:
            return parse_quantity(part, measure.dimension)

        return check_levels(np.array(_each("--levels", text, level)))

    def unit_of_levels(self) -> str:
        """Return the first unit that --levels states, an empty text without one."""
        from ..documents.quantities import unit_of

        levels = re.split("[:,]", self.levels or "")
        return next(filter(None, map(unit_of, levels)), "")

    def limit_states(self) -> list[float | None]:
        """Return the limit states of --limit: values of |theta|/alpha, None for
        overturning. Raises click.UsageError.
        """
        expected = "positive values of |theta|/alpha, overturning, or slide=LENGTH"
        return list(dict.fromkeys(_each("--limit", self.limits, _limit, expected)))

    def limit_of_counts(self) -> float | None:
        """Return the one limit state of --limit that --counts has counted. Raises
        click.UsageError.
        """
        expected = "a positive value of |theta|/alpha, or overturning"
        states = _each("--limit", self.limits, _limit, expected)
        if len(states) != 1:
            raise click.UsageError(
                f"--limit: found {self.limits!r}; expected the one limit state that"
                " --counts has counted"
            )
        return states[0]

    def methods_of_fits(self) -> list[str]:
        """Return the methods of --method. Raises click.UsageError."""
        from ..fragility.study import METHODS

        def method(word: str) -> str:
            if word not in METHODS:
                raise ArgumentError(word)
            return word

        found = _each("--method", self.methods, method, ", ".join(METHODS))
        return list(dict.fromkeys(found))

    def check_standing(self, overturning: bool) -> None:
        """Raise click.UsageError for a --standing of no positive time, or without the
        limit state overturning.
        """
        if self.standing is None or (self.standing > 0.0 and overturning):
            return
        state = "--limit" if self.counts is not None else "the limit state"
        raise click.UsageError(
            f"--standing goes with a positive time and {state} overturning"
        )


def _each(
    flag: str, text: str, read: Callable[[str], Any], expected: str = ""
) -> list[Any]:
    """Return read(word) for each word between commas. Raises UsageError, which names
    `expected`, if read raises ArgumentError.
    """
    found: list[Any] = []
    for part in map(str.strip, text.split(",")):
        try:
            found.append(read(part))
        except ArgumentError as error:
            raise click.UsageError(
                f"{flag}: found {part!r}; expected {expected or error}"
            ) from None
    return found


def _limit(text: str) -> float | None:
    """Return the limit state that a text states: a value of |theta|/alpha, None for
    overturning, or a displacement such as slide=50mm. Raises UsageError.
    """
    if text.startswith("slide"):
        from ..fragility.fitted_curve import SlideLimit
        from ..responses.sliding import parse_slide

        return SlideLimit(parse_slide("--limit", text, "slide=LENGTH"))
    value = None if text == "overturning" else NUMBER.read(text)
    if value is not None and not 0.0 < value < 1e3:
        raise ArgumentError(text)
    return value

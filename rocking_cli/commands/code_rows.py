"""What `rocking check --code` adds to the rows, the figure and the lines of a check."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..dynamics.method import governing_method
from ..errors import UsageError
from ..motions.buildings import Building
from ..motions.design_spectra import read_spectrum
from ..reports.figures.capacities import code_demand_in_words
from ..reports.wording import verified_in_words
from ..responses.check import Demand
from ..responses.code_check import (
    CODE_COLUMNS,
    SLC,
    SLV,
    CodeCheck,
    code_check,
)
from ..responses.code_verdict import CodeVerdict, code_verdicts
from ..responses.verdict import Verdict
from ..structures import RockingParameters
from ..structures.building_modes import parse_mode
from ..structures.mechanics.capacity_curve import require_geometry
from .command import partly
from .options import FigureFile
from .printing import detail, emit, note

_FILES = re.compile(r"(slv|slc)=([^,]+)(?:,(slv|slc)=([^,]+))?")


def spectra_of(text: str) -> dict[str, str]:
    """Return the files of --spectrum by limit state: FILE is that of SLV, else
    slv=FILE,slc=FILE or one of the two. Raises UsageError.
    """
    if not text.startswith(("slv=", "slc=")):
        return {"slv": text}
    found = _FILES.fullmatch(text)
    if found is None or found[1] == found[3]:
        raise UsageError(
            f"--spectrum: found {text!r}; expected FILE, or slv=FILE,slc=FILE"
        )
    both = {found[1]: found[2], found[3]: found[4]}
    return {state: source for state, source in both.items() if state}


class CodeRows:
    """The checks by the code in one call."""

    def __init__(
        self,
        spectrum: str | None,
        floor: Sequence[str],
        fc: float | None,
        building: Building | None,
        structures: Sequence[RockingParameters],
    ) -> None:
        """Read the options; building: that of the dynamics. Raises DocumentError, and
        UsageError if --floor states another building than the dynamics or a structure.
        """
        self.files = {} if spectrum is None else spectra_of(spectrum)
        read = {key: read_spectrum(source) for key, source in self.files.items()}
        # arguments of `code_check`
        self.given: dict[str, Any] = {
            "site": read.get("slv"),
            "site_slc": read.get("slc"),
            "floor": [parse_mode(text, "floor") for text in floor],
            "confidence": 1.0 if fc is None else fc,
        }
        self.checks: dict[tuple[str, str], CodeVerdict] = {}  # by structure and motion
        # of bodies that no equation of motion describes
        self.unmoved: list[CodeVerdict] = []
        self.lines: list[str] = []  # remarks to print below the table
        self.details: list[str] = []  # those that change no decision
        self.building = building  # below the body in the dynamics
        self.structures = structures
        self.floors = {s.name: s.building for s in structures if s.building}
        # of each structure
        self.verdicts: dict[str, list[Verdict]] = {}
        modes = self.given["floor"]
        if modes and self.floors:
            raise UsageError(
                "--floor does not go with a structure whose document has the key"
                f" building, its floor of the code too: {next(iter(self.floors))}"
            )
        if modes and building is not None and set(modes) != set(building.modes):
            raise UsageError(
                "--floor and --building state two floors; expected the same modes in"
                " both, for the code and for the dynamics"
            )

    def alone(
        self,
        structures: Sequence[RockingParameters],
        varied: Mapping[str, Mapping[str, Any]],
        figure: FigureFile,
    ) -> None:
        """Print a row for each structure under the spectrum of a file; the call has no
        motion.
        """
        require_geometry(structures)
        found = [code_check(structure, **self.given) for structure in structures]
        self._remark(found)
        emit(
            ({**_head(one), **one.row()} for one in found),
            table_units="g,mm,deg",
            unseen=CODE_COLUMNS[6:],
            above=("motion", "demand_a"),
            varied=varied,
        )
        figure.draw(found)
        detail(*self.details)
        note(*self.lines)

    def dynamic(self, demands: Sequence[Demand]) -> list[Demand]:
        """Check every demand by the code, and return the demands on bodies that an
        equation of motion describes.
        """
        require_geometry([structure for structure, _, _ in demands])
        found = []
        for one in code_verdicts(self.structures, demands, self.given):
            assert one.demand is not None
            structure, motion, grid = one.demand
            self.checks[structure.name, motion.name] = one
            try:
                governing_method(structure, dimensionless=grid.dimensionless).system_of(
                    structure
                )
                found.append(one.demand)
            except UsageError as error:
                self.unmoved.append(one)
                self.lines.append(f"no dynamics: {error}")
        self._remark([one.check for one in self.checks.values()])
        return found

    def columns(self, verdict: Verdict, searched: bool) -> dict[str, Any]:
        """Return the columns of the code for the row of a verdict; searched: search for
        theta_04_a too.
        """
        one = self.checks[verdict.structure, verdict.motion]
        self.verdicts.setdefault(verdict.structure, []).append(verdict)
        beyond = one.beyond(verdict) if searched else None
        several = (
            f"{verdict.structure} under {verdict.motion}: "
            if len(self.checks) > 1
            else ""
        )
        self.lines += [
            several + line
            for line in one.check.promises(verdict.first_overturning_a, beyond)
        ]
        return one.check.row(beyond)

    def others(self) -> Iterator[dict[str, Any]]:
        """Yield a row for each body that no equation of motion describes."""
        for one in self.unmoved:
            yield {**_head(one.check), "motion": one.motion, **one.check.row()}

    def said(self) -> list[str]:
        """Print what changes no decision, and return the other lines, under several
        records with the mean theta_ratio of each body without ties, of which d/d0 is at
        most theta/alpha.
        """
        detail(*self.details)
        found = []
        for name, verdicts in self.verdicts.items():
            structure = next(s for s in self.structures if s.name == name)
            if (
                len(verdicts) < 2
                or self.given["floor"]
                or name in self.floors
                or structure.mechanism
                or structure.restraints
                or structure.sides
            ):
                continue
            fallen = sum(
                v.falls or v.theta_ratio is None or v.theta_ratio >= 1.0
                for v in verdicts
            )
            mean = sum(v.theta_ratio or 0.0 for v in verdicts) / len(verdicts)
            met = [
                key
                for key, state in (("SLV", SLV), ("SLC", SLC))
                if not fallen and mean <= state.share
            ]
            result = (
                f"{fallen} pass alpha"
                if fallen
                else f"none passes alpha, the mean of theta_ratio is {mean:.3g}"
            )
            states = " and ".join(met) or "neither SLV nor SLC"
            found.append(
                f"{name}: dynamics (C8.7.1.2.1.9), {len(verdicts)} motions: {result}:"
                f" {states} met"
            )
        return [*self.lines, *found]

    def _remark(self, checks: Sequence[CodeCheck]) -> None:
        demands = list(dict.fromkeys(check.demand for check in checks))
        where = " on a floor" if self.given["floor"] else ""
        on = (
            code_demand_in_words(checks)
            if len(demands) == 1
            else f"{len(demands)} motions"
        )
        self.details.append(
            f"code: Circolare 7/2019 C8.7.1, FC = {self.given['confidence']:g},"
            f" spectrum of {on}{where}",
        )
        self.lines += verified_in_words(checks)
        for check in checks:
            for state, why in check.unanswered.items():
                partly()
                self.lines.append(f"{check.structure}: {state} is not known: {why}")
        if list(self.files) == ["slv"]:
            self.lines.append(
                "SLC is not checked: the spectrum is that of SLV, and SLC has another"
                " return period; --spectrum slv=FILE,slc=FILE states both"
            )
        if where and self.building is None:
            self.lines.append(
                "the dynamics are those under the motion of the ground, not of the"
                " floor"
            )
        elif where:
            self.details.append(
                "the row of the code and the dynamics describe the same floor: the code"
                " by its floor spectrum, the dynamics by the motion of the floor"
            )
        elif self.building is not None and self.files:
            self.details.append(
                "the row of the code is that of the spectrum on the ground, the"
                " dynamics are those on the floor; --floor gives the code the same"
                " floor"
            )
        if broken := dict.fromkeys(
            check.structure for check in checks if check.slv and check.slv.broken
        ):
            self.lines.append(
                "a tie or a tendon breaks before 0.4 d0, and decides d_slv:"
                f" {', '.join(broken)}"
            )


def _head(check: CodeCheck) -> dict[str, Any]:
    return {
        "structure": check.structure,
        "motion": check.demand,
        "demand_a": check.demand_a,
    }

"""What every page holds: the template, its tables of verdicts, and how it was made."""

import hashlib
import math
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal
from importlib.metadata import version
from importlib.resources import files
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..documents.files import whole_text
from ..documents.quantities import DEFAULT_GRAVITY
from ..errors import UsageError, did_you_mean
from ..motions.grid import Grid
from ..motions.recording import Recording
from ..publishing import published
from ..responses.verdict import Verdict
from ..structures import RockingParameters
from .tables import Above
from .wording import tally

if TYPE_CHECKING:
    from jinja2 import Template

HEADS = {
    "structure": "structure",
    "motion": "motion",
    "model": "model",
    "outcome": "sentence",
    "θ max/α": "theta_ratio",
    "top moves [mm]": "top_displacement",
    "demand [g]": "demand_a",
    "uplift [g]": "uplift_a",
    "overturns from [g]": "first_overturning_a",
    "capacity over demand": "capacity_demand",
    "safe up to [g]": "safe_to",
    "linear says": "outcome_linear.sentence",
    "friction needed": "friction_needed",
    "least vertical force": "fz_min",
}
"""The columns of the table of verdicts, and the attribute of a verdict in each."""

RANGED = {
    "worst_f_g": ("least capacity at [Hz]", 1.0),
    "largest_f_g": ("largest rotation at [Hz]", 1.0),
    "azimuth": ("least capacity at [deg]", math.degrees(1.0)),
    "largest_azimuth": ("largest rotation at [deg]", math.degrees(1.0)),
}
"""The columns of a range: the attribute of `ranged` (heading, unit)."""

# decimals and rounding of the columns whose heading ends so
_FORMS = (
    ("over demand", (2, ROUND_FLOOR)),
    ("overturns from [g]", (3, ROUND_FLOOR)),
    ("safe up to [g]", (3, ROUND_FLOOR)),
    ("least vertical force", (2, ROUND_FLOOR)),
    ("friction needed", (2, ROUND_CEILING)),
    ("[deg]", (1, ROUND_HALF_EVEN)),
    ("[mm]", (1, ROUND_HALF_EVEN)),
    ("", (3, ROUND_HALF_EVEN)),
)


WRITTEN_WITH = ("a report needs", "jinja2", "matplotlib")  # the arguments of `require`


Labels = Mapping[str, Mapping[str, str]]  # of each structure, by name


@dataclass(frozen=True)
class Asked:
    """What a page says of its own making, and what it holds besides the verdicts."""

    command: str  # the call that made it
    made: str  # date
    title: str | None = None  # None: the names of the structures
    author: str | None = None  # of the page
    place: str | None = None  # of the structures
    summary: bool = False  # begin with a sentence on each structure, and the contents
    by_capacity: bool = False  # the least capacity first
    draws: tuple[int, int] | None = None  # number and seed, of numbers with spreads
    fragility: bool = True  # curves of records
    # the demands at both ends of a range of frequencies, none without a range
    ends: tuple[Grid, ...] = ()
    # arguments of `code_check`, None without a check by a code
    code: Mapping[str, Any] | None = None
    demand: str = ""  # the strength of the shaking in words
    opposite: str = ""  # a remark on that direction
    remarks: Sequence[str] = ()  # sentences below the table of verdicts
    recordings: Sequence[Recording] = ()  # the set of records
    # other files that were read: of a vertical motion, of the spectra of the code
    inputs: Sequence[str] = ()


def write(target: str | Path, text: str, overwrite: bool) -> None:
    """Write a file as a whole. Raises UsageError, OutputError."""
    with published(Path(target), overwrite) as file:
        file.write(whole_text(text).encode())


def lead(verdicts: Sequence[Verdict], asked: Asked) -> str:
    """Return the first sentence of a page: what falls, and under which motions."""
    motions = ", ".join(dict.fromkeys(v.motion for v in verdicts))
    under = "" if asked.summary else f"{motions}: "  # a summary has it in `demand`
    return f"{tally(verdicts)}, under {under}{asked.demand}."


def rendered(
    asked: Asked, structures: Sequence[RockingParameters] = (), **values: Any
) -> str:
    """Return the page with these values of its template; what is not given is left out.
    structures: those whose documents are inputs of the page.
    """
    left_out: dict[str, Any] = {
        **dict.fromkeys(("lead", "beside", "code", "capacities")),
        **{key: [] for key in ("overview", "sections", "draws", "by")},
        "heading": "What stands and what falls",
        "drawn": "Capacity over demand of each structure",
    }
    return _template().render(
        left_out
        | {
            "place": ", ".join(filter(None, (asked.place, asked.author))),
            "command": asked.command,
            "made": asked.made,
            "versions": _versions(),
            "opposite": asked.opposite,
            "remarks": asked.remarks,
            "hashes": _hashes(structures, asked),
        }
        | values
    )


def _template() -> "Template":
    """Return the page without its values; it escapes every text."""
    from jinja2 import Environment, StrictUndefined

    text = (files(__package__) / "page.html").read_text(encoding="utf-8")
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    return environment.from_string(text)


def _versions() -> list[tuple[str, str]]:
    """Return (name, version) of this program and of those that it computes with."""
    packages = ("numpy", "scipy", "h5py", "matplotlib", "jinja2")
    return [
        ("rocking", __version__),
        ("Python", platform.python_version()),
        *((package, version(package)) for package in packages),
    ]


def labels_of(structures: Sequence[RockingParameters], by: str | None = None) -> Labels:
    """Return the labels of structures; one without a label has an empty text. Raises
    UsageError if none has the label `by`.
    """
    keys = dict.fromkeys(key for s in structures for key in s.labels)
    if by is not None and by not in keys:
        known = ", ".join(keys) or "none"
        raise UsageError(
            f"`by`: found {by!r}; expected a label of the structures:"
            f" {known}{did_you_mean(by, list(keys))}"
        )
    return {s.name: {k: str(s.labels.get(k, "")) for k in keys} for s in structures}


def labelled(
    cells: Mapping[str, str | float | None], labels: Labels
) -> dict[str, str | float | None]:
    """Return a row with the labels of its structure behind the name."""
    name = str(cells["structure"])
    own = {
        f"label {key}" if key in cells else key: text
        for key, text in labels.get(name, {}).items()
    }
    return {"structure": name, **own, **cells}


def details(verdicts: Sequence[Verdict], labels: Labels) -> list[dict[str, Any]]:
    """Return the rows of the table of verdicts; labels: of each structure."""
    rows = []
    several = len({v.motion for v in verdicts}) > 1
    for v in verdicts:
        cells = dict(zip(HEADS, attrgetter(*HEADS.values())(v), strict=True))
        cells |= {
            RANGED[key][0]: None if x is None else RANGED[key][1] * float(x)
            for key, x in v.ranged.items()
            if key in RANGED
        }
        if not several:
            del cells["motion"]
        cells = labelled(cells, labels)
        rows.append(verdict_row(cells, v))
    return rows


def _hashes(
    structures: Sequence[RockingParameters], asked: Asked
) -> list[tuple[str, str]]:
    """Return (name, SHA-256) of each input: that of its file, or of the text of a
    document without a file.
    """
    inputs: dict[str, bytes] = {}
    for document in (s.document for s in structures):
        if document is not None:
            text = document.text.encode()
            inputs[document.source] = inputs.get(document.source, b"") + text
    found = {
        source: hashlib.sha256(content).hexdigest()
        for source, content in inputs.items()
    }
    for source in (*inputs, *asked.inputs):
        if Path(source).is_file():
            with open(source, "rb") as file:
                found[source] = hashlib.file_digest(file, "sha256").hexdigest()
    found |= {r.record.source: r.record.sha256 for r in asked.recordings}
    return list(found.items())


def verdict_row(values: dict[str, str | float | None], v: Verdict) -> dict[str, Any]:
    """Return the template's values for a row of a table of verdicts; values: of each
    column by its heading.
    """
    if v.capacity_above is not None:
        values["capacity over demand"] = Above(v.capacity_above)
    return page_row(values, v.falls)


def page_row(values: Mapping[str, str | float | None], falls: bool) -> dict[str, Any]:
    """Return the template's values for a row; falls: True for a red one."""
    cells = [
        {"head": head, "text": _cell(head, x), "number": not isinstance(x, str)}
        for head, x in values.items()
    ]
    return {"falls": falls, "cells": cells}


def _cell(head: str, x: str | float | None) -> str:
    """Return a value of a column as a text. All numbers of a column have as many
    decimals; what is compared is rounded to the safe side.
    """
    if x is None or isinstance(x, str):
        return x or "–"
    places, rounding = next(form for ends, form in _FORMS if head.endswith(ends))
    unit = DEFAULT_GRAVITY if "[g]" in head else 1e-3 if "[mm]" in head else 1.0
    least = Decimal(1).scaleb(-places)
    shown = Decimal(repr(x / unit)).quantize(least, rounding)
    if not shown and x > 0.0:
        return f"< {least}"
    return f"> {shown}" if isinstance(x, Above) else f"{shown}"

"""Writes fragility curves as files for other programs: NRML 0.5 of OpenQuake, CSV and
JSON of pelicun.

A fit is lognormal. OpenQuake takes the mean and the standard deviation of the level,
not of its logarithm: mean = median exp(beta^2/2), stddev = mean sqrt(exp(beta^2) - 1).
An exact share is written as points joined by straight lines, from each of its rises to
the next: its running maximum, since these programs want probabilities that do not fall.
The lines lie above the share.
"""

import csv
import io
import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..errors import UsageError
from ..motions.intensity_measures import Measure, measure_of
from ..publishing import check_target, published
from .exposure import share_overturned
from .fits import Curve
from .fitted_curve import Fit
from .hazard_files import OF_OPENQUAKE, openquake_unit
from .study import Study

FORMS = {"openquake": ".xml", "pelicun": ".csv"}  # and the suffix of each
_NRML = "http://openquake.org/xmlns/nrml/0.5"
_DEMANDS = {
    "PGA": ("Peak Ground Acceleration", "g"),
    "PGV": ("Peak Ground Velocity", "cmps"),
}
# limit states that are no rotation, in words
_LIMITS = {"overturning": "overturning", "counted": "limit state of the counts"}
# columns of the CSV of pelicun for each limit state
_PELICUN_COLUMNS = ("Family", "Theta_0", "Theta_1", "DamageStateWeights")
_NEAR = 1e-3  # the share rises from 0 within this part below its first level
_SHARE = "running maximum of the exact share of overturning motions"


@dataclass(frozen=True, eq=False)
class Share:
    """The exact share of overturning motions, straight lines between points."""

    structure: str  # name of the structure
    no_damage: float  # level up to which the body stays at rest [SI], 0 if unknown
    x: Array  # intensities of the points [SI], (n,)
    p: Array  # share of the motions at the points [-], (n,)
    limit: str = "overturning"  # the limit state


State = Fit | Share


def share_of(study: Study) -> Share:
    """Return the exact share of overturning motions for a file. Raises UsageError if no
    motion overturns the structure.
    """
    x, share = share_overturned(study.intervals or (), study.motions.weight)
    most = np.maximum.accumulate(share)
    rises = np.flatnonzero(np.diff(most, prepend=0.0) > 1e-9)
    if not rises.size:
        raise UsageError(
            f"{study.structure.name}: no motion overturns it at these levels; found"
            " nothing to export"
        )
    # the last of equal levels
    far = rises[np.append(x[rises[1:]] > x[rises[:-1]] * (1.0 + 1e-6), True)]
    first = (1.0 - _NEAR) * x[rises[0]]
    return Share(
        study.structure.name,
        min(study.no_damage, first),
        np.append(first, x[far]),
        np.append(0.0, most[far]),
    )


def export_fragility(
    curves: Sequence[Fit],
    target: str | Path,
    form: str = "openquake",
    *,
    im: str = "PGA",
    overwrite: bool = False,
) -> list[str]:
    """Write fragility curves for another program.

    Parameters
    ----------
    curves
        one for each structure and limit state, with levels in SI; limit states that a
        structure lacks are left out
    target
        the file
    form
        "openquake" (NRML 0.5) or "pelicun" (CSV, and JSON of the same name)
    im
        the intensity measure of the levels
    overwrite
        True: replace an existing file

    Returns
    -------
    list of str
        a sentence on each difference between the file and the curves

    Raises
    ------
    UsageError
        for a measure that the program does not know, two curves of one limit state, or
        a file that exists
    OutputError
        when the file cannot be written

    Examples
    --------
    >>> curve = fit_stripes([1.0, 1.5, 2.0], [54, 54, 54], [2, 25, 43])
    >>> import numpy as np
    >>> fit = Fit("Column", "PGA", "overturning", "stripes", curve, None, np.ones(1))
    >>> export_fragility([fit], "column.xml")
    []
    """
    measure = measure_of(im)
    check_export(Path(target), form, measure, overwrite)
    return write(curves, Path(target), form, measure, overwrite)


def write(
    states: Sequence[State], target: Path, form: str, measure: Measure, overwrite: bool
) -> list[str]:
    """Write fits or exact shares after `check_export`; return a sentence on each
    difference between the file and the curves.
    """
    if not states:
        raise UsageError("found no fragility curve to export")
    grouped: dict[str, dict[str, State]] = {}
    for state in states:
        if state.limit in grouped.setdefault(state.structure, {}):
            raise UsageError(
                f"{state.structure}, {state.limit}: found two curves; expected one, of"
                " one method"
            )
        grouped[state.structure][state.limit] = state
    # A file has the same limit states for every structure; others are left out.
    every = sorted({state.limit for state in states}, key=_order)
    common = [
        limit for limit in every if all(limit in found for found in grouped.values())
    ]
    if not common:
        raise UsageError(f"found no limit state that all of {', '.join(grouped)} have")
    remarks = [
        f"{limit}: not all structures have this limit state; left out of {target}"
        for limit in every
        if limit not in common
    ]
    if shares := [state for state in states if isinstance(state, Share)]:
        remarks.append(f"{target}: holds the {_SHARE}")
    kept = [[found[limit] for limit in common] for found in grouped.values()]
    if form == "openquake":
        files = {target: _nrml(kept, measure)}
    else:
        files = dict(
            zip(
                (target, target.with_suffix(".json")),
                _pelicun(kept, measure),
                strict=True,
            )
        )
        if any(share.p[-1] < 1.0 for share in shares):
            remarks.append(
                f"{target}: a share below 1 at its last rise is set to 1 at 1.001 times"
                " that level, as pelicun needs"
            )
    for path, text in files.items():
        with published(path, overwrite) as file:
            file.write(text.encode())
    return remarks


def check_export(target: Path, form: str, measure: Measure, overwrite: bool) -> None:
    """Refuse, before any work is done, an export that cannot be written. Raises
    UsageError.
    """
    if form not in FORMS:
        raise UsageError(f"`export`: found {form!r}; expected {' or '.join(FORMS)}")
    if form == "pelicun":
        known = measure.name in _DEMANDS or measure.name.startswith("SA(")
        expected = "PGA, PGV or SA(T)"
    else:
        spectral = bool(measure.periods) and "," not in measure.name
        known = measure.name in OF_OPENQUAKE or spectral
        expected = f"{', '.join(OF_OPENQUAKE)}, SA(T) or AvgSA(T)"
    if not known:
        raise UsageError(
            f"`im`: found {measure.name}; expected a measure that {form} knows:"
            f" {expected}"
        )
    check_target(target, overwrite, (FORMS[form],))
    if form == "pelicun":
        check_target(target.with_suffix(".json"), overwrite)


def _names(texts: Iterable[str]) -> list[str]:
    """Return distinct names that have only letters, digits, - and _."""
    found: list[str] = []
    for text in texts:
        name = re.sub(r"[^A-Za-z0-9_-]+", "_", text)
        found.append(
            next(
                own
                for own in chain([name], (f"{name}_{n}" for n in count(2)))
                if own not in found
            )
        )
    return found


def _order(limit: str) -> float:
    """Return the place of a limit state: rotations in rising order, then the others."""
    return math.inf if limit in _LIMITS else float(limit)


def _of_limit(limit: str) -> str:
    """Return a limit state in the words of an exported file."""
    return _LIMITS.get(limit, f"rotation beyond {limit} of the critical angle")


def _number(x: float) -> str:
    return f"{x:.9g}"


def _nrml(structures: Sequence[Sequence[State]], measure: Measure) -> str:
    """Return the text of an NRML file: a function for each structure."""
    first = structures[0]
    limits = _names(
        state.limit if state.limit in _LIMITS else f"theta_{state.limit}"
        for state in first
    )
    root = ET.Element("nrml", xmlns=_NRML)
    model = ET.SubElement(
        root,
        "fragilityModel",
        id="rocking",
        assetCategory="contents",
        lossCategory="contents",
    )
    description = "; ".join(
        f"{name}: {_of_limit(state.limit)}"
        for name, state in zip(limits, first, strict=True)
    )
    share = f" ({_SHARE})" if isinstance(first[0], Share) else ""
    text = f"Rocking structures{share}. {description}"
    ET.SubElement(model, "description").text = text
    ET.SubElement(model, "limitStates").text = " ".join(limits)

    names = _names(states[0].structure for states in structures)
    for name, states in zip(names, structures, strict=True):
        function = ET.SubElement(model, "fragilityFunction", id=name)
        _fill(function, dict(zip(limits, states, strict=True)), measure)
    ET.indent(root)
    return (
        "<?xml version='1.0'"
        f" encoding='utf-8'?>\n{ET.tostring(root, encoding='unicode')}\n"
    )


def _fill(function: ET.Element, states: dict[str, State], measure: Measure) -> None:
    """Write the limit states of one structure, by their names in the file, into its
    function.
    """
    scale = openquake_unit(measure)
    name = "IA" if measure.name == "Arias" else measure.name
    # SA(1) is written as SA(1.0)
    imt = re.sub(r"\((.*)\)", lambda found: f"({float(found[1])})", name)
    imls = ET.SubElement(function, "imls", imt=imt)
    no_damage = min(state.no_damage for state in states.values()) / scale
    if no_damage > 0.0:
        imls.set("noDamageLimit", _number(no_damage))

    curves = []
    for limit, state in states.items():
        if isinstance(state, Share):
            function.set("format", "discrete")
            imls.text = " ".join(map(_number, state.x / scale))
            poes = ET.SubElement(function, "poes", ls=limit)
            poes.text = " ".join(map(_number, state.p))
        else:
            curves.append(state.curve)
            _add_lognormal(function, limit, state.curve, scale)
    if curves:
        function.set("format", "continuous")
        function.set("shape", "logncdf")
        lowest = min(c.median * math.exp(-4.0 * c.beta) for c in curves)
        least = no_damage or lowest / scale
        most = max(c.median * math.exp(3.0 * c.beta) for c in curves) / scale
        imls.set("minIML", _number(least))
        imls.set("maxIML", _number(max(most, 2.0 * least)))


def _add_lognormal(
    function: ET.Element, limit: str, curve: Curve, scale: float
) -> None:
    """Write a lognormal curve by the mean and the standard deviation of the level;
    scale: the unit of the levels [SI].
    """
    mean = curve.median / scale * math.exp(0.5 * curve.beta**2)
    deviation = mean * math.sqrt(math.expm1(curve.beta**2))
    ET.SubElement(
        function, "params", ls=limit, mean=_number(mean), stddev=_number(deviation)
    )


def _pelicun(
    structures: Sequence[Sequence[State]], measure: Measure
) -> tuple[str, str]:
    """Return the texts of (the CSV, the JSON)."""
    names = _names(states[0].structure for states in structures)
    model: dict[str, object] = {
        "_GeneralInformation": {
            "ShortName": "Rocking structures",
            "Description": "Fragility curves of rocking structures",
        }
    }
    for name, states in zip(names, structures, strict=True):
        share = f", the {_SHARE}" if isinstance(states[0], Share) else ""
        model[name] = {
            "Description": f"{states[0].structure}{share}",
            "SuggestedComponentBlockSize": "1 EA",
            "RoundUpToIntegerQuantity": "True",
            "LimitStates": {
                f"LS{i}": {f"DS{i}": {"Description": _of_limit(state.limit)}}
                for i, state in enumerate(states, 1)
            },
        }
    table = _pelicun_table(names, structures, measure)
    return table, json.dumps(model, indent=2) + "\n"


def _pelicun_table(
    names: Sequence[str], structures: Sequence[Sequence[State]], measure: Measure
) -> str:
    """Return the text of the CSV: a row for each structure."""
    period = "" if measure.name in _DEMANDS else f"|{measure.periods[0]:.2f}"
    demand, unit = _DEMANDS.get(measure.name, (f"Spectral Acceleration{period}", "g"))
    scale = openquake_unit(measure)
    heading = [
        "ID",
        "Incomplete",
        "Demand-Type",
        "Demand-Unit",
        "Demand-Offset",
        "Demand-Directional",
    ]
    for i in range(1, len(structures[0]) + 1):
        heading += [f"LS{i}-{column}" for column in _PELICUN_COLUMNS]

    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(heading)
    for name, states in zip(names, structures, strict=True):
        row = [name, "0", demand, unit, "0", "0"]
        for state in states:
            row += _pelicun_cells(state, scale)
        writer.writerow(row)
    return table.getvalue()


def _pelicun_cells(state: State, scale: float) -> list[str]:
    """Return the cells _PELICUN_COLUMNS of a limit state; scale: the unit of the levels
    [SI].
    """
    if not isinstance(state, Share):
        curve = state.curve
        return ["lognormal", _number(curve.median / scale), _number(curve.beta), ""]
    x, p = state.x, state.p
    if p[-1] <= 1.0 - 1e-9:
        x, p = np.append(x, (1.0 + _NEAR) * x[-1]), np.append(p, 1.0)
    ends = x / scale, np.append(p[:-1], 1.0)
    points = "|".join(",".join(map(_number, end)) for end in ends)
    return ["multilinear_CDF", points, "", ""]

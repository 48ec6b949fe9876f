"""Fragility curves as the files of other programs: NRML 0.5 of OpenQuake, CSV and JSON of pelicun.

A fit is lognormal. OpenQuake takes the mean and the standard deviation of the level, not of its logarithm:
mean = theta exp(beta^2/2), stddev = mean sqrt(exp(beta^2) - 1). An exact share is written as points joined by straight lines, from each
of its rises to the next: its running maximum, since these programs want probabilities that do not fall. The lines lie above the share.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import UsageError
from ..publishing import check_target, published
from .exposure import share_overturned
from .fits import Curve
from .hazard import openquake_unit
from .measures import Measure, measure_of
from .study import Fit, Study

Array = np.ndarray
FORMS = {"openquake": ".xml", "pelicun": ".csv"}  # and the suffix of each
_NRML = "http://openquake.org/xmlns/nrml/0.5"
_DEMANDS = {"PGA": ("Peak Ground Acceleration", "g"), "PGV": ("Peak Ground Velocity", "cmps")}
_NEAR = 1e-3  # the share rises from 0 within this part below its first level
_APART = 1e-6  # relative distance of levels
_LEAST, _MOST = 4.0, 3.0  # standard deviations of ln x below and above the medians that a lognormal curve spans
_SHARE = "running maximum of the exact share of overturning motions"


@dataclass(frozen=True, eq=False)
class Exported:
    """One limit state of a structure as a file holds it: a lognormal curve, or the points (x [SI], p) of a share.

    no_damage: the level [SI] up to which nothing happens, 0 if that is not known.
    """

    structure: str
    limit: str
    no_damage: float
    curve: Curve | None = None
    x: Array | None = None
    p: Array | None = None


def of_fit(fit: Fit) -> Exported:
    """A fitted curve for a file."""
    return Exported(fit.structure, fit.limit, fit.no_damage, fit.curve)


def of_share(study: Study) -> Exported:
    """The exact share of overturning for a file. Raises UsageError if no motion overturns the structure."""
    x, share = share_overturned(study.intervals or (), study.weight)
    most = np.maximum.accumulate(share)
    rises = np.flatnonzero(np.diff(most, prepend=0.0) > 1e-9)
    if not rises.size:
        raise UsageError(f"{study.structure.name}: no motion overturns it at these levels; found nothing to export")
    far = [i for n, i in enumerate(rises) if n + 1 == rises.size or x[rises[n + 1]] > x[i] * (1.0 + _APART)]  # the last of equal levels
    first = x[rises[0]]
    points = np.append((1.0 - _NEAR) * first, x[far]), np.append(0.0, most[far])
    return Exported(study.structure.name, "overturning", min(study.no_damage, points[0][0]), None, *points)


def export_fragility(
    curves: Sequence[Fit], target: str | Path, form: str = "openquake", *, im: str = "PGA", overwrite: bool = False
) -> list[str]:
    """Write fragility curves for another program, and return sentences on what the file holds otherwise than the curves.

    curves: fits, one for each structure and limit state, with levels in SI; form: `openquake` (NRML 0.5) or
    `pelicun` (CSV, and JSON of the same name); im: their measure. Limit states that a structure lacks are left out. Raises UsageError for
    a measure that the program does not know, and OutputError if a file cannot be written.

    >>> export_fragility([], 'f.xml')
    Traceback (most recent call last):
        ...
    rocking_cli.errors.UsageError: found no fragility curve to export
    """
    measure = measure_of(im)
    check_export(Path(target), form, measure, overwrite)
    return write([of_fit(fit) for fit in curves], Path(target), form, measure, overwrite)


def write(states: Sequence[Exported], target: Path, form: str, measure: Measure, overwrite: bool) -> list[str]:
    """Write limit states of structures as `export_fragility` does, all of them curves or all of them shares."""
    if not states:
        raise UsageError("found no fragility curve to export")
    grouped: dict[str, dict[str, Exported]] = {}
    for state in states:
        if state.limit in grouped.setdefault(state.structure, {}):
            raise UsageError(f"{state.structure}, {state.limit}: found two curves; expected one, of one method")
        grouped[state.structure][state.limit] = state
    every = list(dict.fromkeys(state.limit for state in states))
    common = [limit for limit in every if all(limit in found for found in grouped.values())]
    if not common:
        raise UsageError(f"found no limit state that all of {', '.join(grouped)} have")
    told = [f"{limit}: not all structures have this limit state; left out of {target}" for limit in every if limit not in common]
    if any(state.x is not None for state in states):
        told.append(f"{target}: holds the {_SHARE}")
    kept = [[found[limit] for limit in common] for found in grouped.values()]
    if form == "openquake":
        files = {target: _nrml(kept, measure)}
    else:
        files = dict(zip((target, target.with_suffix(".json")), _pelicun(kept, measure), strict=True))
        if any(state.p is not None and state.p[-1] < 1.0 for state in states):
            told.append(f"{target}: a share below 1 at its last rise is set to 1 at 1.001 times that level, as pelicun needs")
    for path, text in files.items():
        with published(path, overwrite) as file:
            file.write(text.encode())
    return told


def check_export(target: Path, form: str, measure: Measure, overwrite: bool) -> None:
    """Refuse, before any work is done, an export that cannot be written. Raises UsageError."""
    if form not in FORMS:
        raise UsageError(f"`export`: found {form!r}; expected {' or '.join(FORMS)}")
    known = not measure.of_structure and (len(measure.periods) < 2 or measure.name.count(",") == 0)
    if form == "pelicun":
        known = measure.name in _DEMANDS or measure.name.startswith("SA(")
    if not known:
        expected = "PGA, PGV or SA(T)" if form == "pelicun" else "PGA, PGV, PGD, Arias, CAV, SA(T) or AvgSA(T)"
        raise UsageError(f"`im`: found {measure.name}; expected a measure that {form} knows: {expected}")
    check_target(target, overwrite, (FORMS[form],))
    if form == "pelicun":
        check_target(target.with_suffix(".json"), overwrite)


def _names(texts: Sequence[str]) -> list[str]:
    """Distinct names of letters, digits, - and _."""
    found: list[str] = []
    for text in texts:
        name = re.sub(r"[^A-Za-z0-9_-]+", "_", text)
        n, own = 1, name
        while own in found:
            n += 1
            own = f"{name}_{n}"
        found.append(own)
    return found


def _limits(states: Sequence[Exported]) -> list[str]:
    return _names([state.limit if state.limit == "overturning" else f"theta_{state.limit}" for state in states])


def _of_limit(limit: str) -> str:
    return "overturning" if limit == "overturning" else f"rotation beyond {limit} of the critical angle"


def _number(x: float) -> str:
    return f"{x:.9g}"


def _nrml(structures: Sequence[Sequence[Exported]], measure: Measure) -> str:
    """NRML 0.5."""
    scale, limits = openquake_unit(measure)[1], _limits(structures[0])
    imt = re.sub(r"\((.*)\)", lambda found: f"({float(found[1])})", "IA" if measure.name == "Arias" else measure.name)
    root = ET.Element("nrml", xmlns=_NRML)
    model = ET.SubElement(root, "fragilityModel", id="rocking", assetCategory="contents", lossCategory="contents")
    told = "; ".join(f"{name}: {_of_limit(state.limit)}" for name, state in zip(limits, structures[0], strict=True))
    share = f" ({_SHARE})" if structures[0][0].x is not None else ""
    ET.SubElement(model, "description").text = f"Rocking structures{share}. {told}"
    ET.SubElement(model, "limitStates").text = " ".join(limits)
    for name, states in zip(_names([some[0].structure for some in structures]), structures, strict=True):
        no_damage = min(state.no_damage for state in states) / scale
        spare = {"noDamageLimit": _number(no_damage)} if no_damage > 0.0 else {}
        if (x := states[0].x) is not None:
            function = ET.SubElement(model, "fragilityFunction", id=name, format="discrete")
            ET.SubElement(function, "imls", {"imt": imt, **spare}).text = " ".join(map(_number, x / scale))
            for limit, state in zip(limits, states, strict=True):
                assert state.p is not None
                ET.SubElement(function, "poes", ls=limit).text = " ".join(map(_number, state.p))
            continue
        curves = [state.curve for state in states if state.curve is not None]
        least = no_damage or min(c.theta * math.exp(-_LEAST * c.beta) for c in curves) / scale
        most = max(c.theta * math.exp(_MOST * c.beta) for c in curves) / scale
        function = ET.SubElement(model, "fragilityFunction", id=name, format="continuous", shape="logncdf")
        ends = {"minIML": _number(least), "maxIML": _number(max(most, 2.0 * least))}
        ET.SubElement(function, "imls", {"imt": imt, **spare, **ends})
        for limit, c in zip(limits, curves, strict=True):
            mean = c.theta / scale * math.exp(0.5 * c.beta**2)
            ET.SubElement(function, "params", ls=limit, mean=_number(mean), stddev=_number(mean * math.sqrt(math.expm1(c.beta**2))))
    ET.indent(root)
    return f"<?xml version='1.0' encoding='utf-8'?>\n{ET.tostring(root, encoding='unicode')}\n"


def _pelicun(structures: Sequence[Sequence[Exported]], measure: Measure) -> tuple[str, str]:
    """(CSV, JSON) of pelicun."""
    period = "" if measure.name in _DEMANDS else f"|{measure.periods[0]:.2f}"
    demand, unit = _DEMANDS.get(measure.name, (f"Spectral Acceleration{period}", "g"))
    scale, table, told = openquake_unit(measure)[1], io.StringIO(), dict[str, object]()
    head = ["ID", "Incomplete", "Demand-Type", "Demand-Unit", "Demand-Offset", "Demand-Directional"]
    count = len(structures[0])
    columns = ("Family", "Theta_0", "Theta_1", "DamageStateWeights")
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(head + [f"LS{i}-{column}" for i in range(1, count + 1) for column in columns])
    told["_GeneralInformation"] = {"ShortName": "Rocking structures", "Description": "Fragility curves of rocking structures"}
    for name, states in zip(_names([some[0].structure for some in structures]), structures, strict=True):
        row = [name, "0", demand, unit, "0", "0"]
        for state in states:
            if state.curve is not None:
                row += ["lognormal", _number(state.curve.theta / scale), _number(state.curve.beta), ""]
                continue
            assert state.x is not None
            assert state.p is not None
            ends = (state.x, np.append(state.p[:-1], 1.0)) if state.p[-1] > 1.0 - 1e-9 else (
                np.append(state.x, (1.0 + _NEAR) * state.x[-1]), np.append(state.p, 1.0)
            )  # fmt: skip
            row += ["multilinear_CDF", "|".join(",".join(map(_number, end)) for end in (ends[0] / scale, ends[1])), "", ""]
        writer.writerow(row)
        damage = {f"LS{i}": {f"DS{i}": {"Description": _of_limit(state.limit)}} for i, state in enumerate(states, 1)}
        share = f", the {_SHARE}" if states[0].x is not None else ""
        told[name] = {
            "Description": f"{states[0].structure}{share}", "SuggestedComponentBlockSize": "1 EA", "RoundUpToIntegerQuantity": "True",
            "LimitStates": damage,
        }  # fmt: skip
    return table.getvalue(), json.dumps(told, indent=2) + "\n"

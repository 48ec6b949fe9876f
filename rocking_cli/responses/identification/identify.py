"""From a measured trace of free rocking to inset, alpha, p and eta."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...errors import DocumentError, UsageError
from ...structures.given import Structure
from .body import KnownBody, body_of, reading_of, shape_of
from .checks import require_free_rocking, residuals
from .first_look import Release, noise_of, releases_of, sign_changes, unfolded
from .fit import Mixed, Window, mixed, saturated, with_noise
from .identified import COLUMNS, Course, Estimate, Identification, bounds, mean_of
from .impact_times import of_impact_times
from .paste import lines_of, lines_of_means
from .told import (
    Told,
    estimates_of,
    faults,
    impact_rows,
    is_certain,
    remarks_of,
    row_of,
)
from .trace import IMPACT, Trace, read_trace
from .unknowns import ALPHA, BOTH, FITS, INSET

_LEAST_BESIDE = 3  # samples beside an impact that a low pass spoils


class Wanted(NamedTuple):
    """How a trace is to be read and fitted: the arguments of `identify`."""

    fit: str
    two_sides: bool
    height: float | None
    lowpass: float | None
    least: float
    gain_error: float
    level: float


def identify(
    traces: Trace | str | Path | Sequence[Trace | str | Path],
    structure: Structure | None = None,
    *,
    fit: str | None = None,
    two_sides: bool = False,
    column: str | None = None,
    height: float | None = None,
    lowpass: float | None = None,
    start: float | None = None,
    stop: float | None = None,
    least: float = 0.06,
    gain_error: float = 0.0,
    level: float = 0.95,
) -> list[Identification]:
    """Fit the free rocking of a rigid body to measured traces.

    Parameters
    ----------
    traces
        one or several: a file with a time and a reading, or impact times, see `rocking
        help identify`; or a Trace
    structure
        the body; of a kind that takes `inset` the fit finds the inset
    fit
        the unknowns: "inset", "alpha" (p is that of the structure) or "alpha,p"; None
        for the first that the structure allows
    two_sides
        True: the two edges may differ
    column
        name of the column, where a file has several
    height
        of a point over the middle of the base [m], whose displacement was measured
    lowpass
        cut-off frequency of the filter of a gyroscope [Hz]
    start
        time from which the trace counts [s]
    stop
        time up to which it counts [s]
    least
        half-cycles whose peak is a smaller share of the first one are left out
    gain_error
        relative standard deviation of the gain of the sensor
    level
        of the intervals

    Returns
    -------
    list of Identification
        one for each release, and the mean of all behind several

    Raises
    ------
    UsageError
        for arguments that do not fit each other, or a file that cannot be read
    DocumentError
        for a trace that is no free rocking of a rigid body with two edges, with the
        reason

    Notes
    -----
    Between two impacts the motion is a closed form of alpha, p and its peak (Jacobi's
    elliptic functions), so that the fit integrates nothing. Restitutions of the impacts
    scatter about a mean, or a line over theta/alpha: a mixed model.

    Examples
    --------
    >>> found = identify("configs/free_rocking.csv", "block:0.5x2")[0]
    >>> f"inset {1e3 * found.row['inset']:.1f} mm, eta {found.row['eta']:.2f}"
    'inset 25.0 mm, eta 0.91'
    """
    several = [traces] if isinstance(traces, str | Path | Trace) else traces
    body = None if structure is None else body_of(structure)
    chosen = fit or (BOTH if body is None else INSET if body.rigid else ALPHA)
    _require(chosen, body, level, least, gain_error, lowpass, height)
    wanted = Wanted(chosen, two_sides, height, lowpass, least, gain_error, level)
    found: list[Identification] = []
    for one in several:
        trace = one if isinstance(one, Trace) else read_trace(one, column)
        found += _of_trace(_cut(trace, start, stop), body, wanted)
    if len(found) > 1:
        found.append(_together(found, body, level))
    return found


def _require(
    fit: str,
    body: KnownBody | None,
    level: float,
    least: float,
    gain_error: float,
    lowpass: float | None,
    height: float | None,
) -> None:
    """Raise UsageError for arguments out of range, or without what they need."""
    if fit not in FITS:
        raise UsageError(f"`fit`: found {fit!r}; expected {', '.join(FITS)}")
    if fit == INSET and (body is None or body.rigid is None):
        raise UsageError("`fit`: inset needs a structure of a kind that takes `inset`")
    if fit == ALPHA and body is None:
        raise UsageError("`fit`: alpha alone needs a structure, for p")
    for name, value, low, high in (
        ("level", level, 0.0, 1.0),
        ("least", least, 0.0, 1.0),
        ("gain_error", 0.5 if gain_error == 0.0 else gain_error, 0.0, 1.0),
        ("lowpass", lowpass or 1.0, 0.0, math.inf),
        ("height", height or 1.0, 0.0, math.inf),
    ):
        if not low < value < high:
            raise UsageError(
                f"`{name}`: found {value:g}; expected above {low:g}"
                + f" and below {high:g}" * (high < math.inf)
            )


def _cut(trace: Trace, start: float | None, stop: float | None) -> Trace:
    """Return the part of a trace between two times."""
    if start is None and stop is None:
        return trace
    inside = (trace.t >= (-math.inf if start is None else start)) & (
        trace.t <= (math.inf if stop is None else stop)
    )
    y = trace.y if trace.quantity == IMPACT else trace.y[inside]
    return Trace(trace.name, trace.quantity, trace.t[inside], y, trace.lines[inside])


def _of_trace(
    trace: Trace, body: KnownBody | None, wanted: Wanted
) -> list[Identification]:
    """Return what each release of a trace tells."""
    kind, y = trace.quantity, trace.y
    if kind == "acceleration":
        times = sign_changes(trace.t, y)
        trace = Trace(trace.name, IMPACT, times)
    if trace.quantity == IMPACT:
        return [of_impact_times(trace, body, wanted.least, wanted.level)]
    if kind == "displacement":
        if wanted.height is None:
            raise UsageError(
                f"{trace.name}: a displacement needs `height`, that of its point over"
                " the base"
            )
        y = y / wanted.height
    if kind == "uplift":
        if body is None or body.rigid is None:
            raise UsageError(
                f"{trace.name}: an uplift needs a structure of a kind that takes"
                " `inset`"
            )
        y = unfolded(y) / (2.0 * body.rigid.lever)
    found = releases_of(trace, y, kind == "theta_dot", wanted.least)
    return [
        _of_release(trace, number, release, body, wanted)
        for number, release in enumerate(found, 1)
    ]


def _of_release(
    trace: Trace, number: int, release: Release, body: KnownBody | None, wanted: Wanted
) -> Identification:
    """Return what one release tells. Raises DocumentError, which names the trace."""
    inside = slice(release.first, release.end)
    t, rates = trace.t[inside], trace.quantity == "theta_dot"
    dt = float(np.median(np.diff(t)))
    beside = max(1.0 / wanted.lowpass if wanted.lowpass else 0.0, _LEAST_BESIDE * dt)
    window = Window(
        t,
        trace.y[inside],
        release,
        reading_of(trace.quantity, body, wanted.height or 0.0),
        beside if rates else 0.0,
        wanted.gain_error,
    )
    noise = noise_of(window.y)

    def fitted(fit: str, two_sides: bool) -> Mixed:
        shape = shape_of(fit, two_sides, release, body)
        first = saturated(window, shape, noise)
        found = mixed(first)
        if first.rho:  # fit A takes the slow part of correlated noise for motion
            rest = (window.y - found.model.y)[first.kept]
            found = mixed(with_noise(first, rest))
        return found

    with np.errstate(all="ignore"):  # of steps that the fit does not take
        try:
            found = fitted(wanted.fit, wanted.two_sides)
        except DocumentError as error:
            raise DocumentError(f"{trace.name}: {error}") from None
        free: Mixed | None = found
        if wanted.fit != BOTH:
            try:
                free = fitted(BOTH, wanted.two_sides)
            except DocumentError:
                free = None
    # wrong sizes are no reason to refuse a trace
    judged = free if free is not None and is_certain(free) else found
    two = shape_of(judged.saturated.shape.fit, True, release, body)
    differ = require_free_rocking(trace.name, judged, two, rates)
    left = residuals(found.saturated)
    told = Told(
        trace.name, number, wanted.fit, found, free, left, differ, body, wanted.level
    )
    return Identification(
        row_of(told),
        impact_rows(told),
        () if any(faults(told)) else lines_of(told),
        tuple(remarks_of(told)),
        _course(trace, release, found),
        estimates_of(told),
    )


def _course(trace: Trace, release: Release, found: Mixed) -> Course:
    """Return the whole trace with the fit of one of its releases."""
    inside = slice(release.first, release.end)
    fit, kept = np.full(trace.t.size, np.nan), np.zeros(trace.t.size, bool)
    fit[inside], kept[inside] = found.model.y, found.saturated.kept
    return Course(trace.quantity, trace.t, trace.y, fit, kept, found.model.impacts)


def _together(
    found: Sequence[Identification], body: KnownBody | None, level: float
) -> Identification:
    """Return the mean of several releases, with the scatter between them."""
    from scipy.special import stdtrit

    student = float(stdtrit(len(found) - 1, 0.5 + 0.5 * level))
    row: dict[str, Any] = dict.fromkeys(COLUMNS)
    row |= {"trace": "all", "impacts": sum(one.row["impacts"] for one in found)}
    keys = [key for key in found[0].estimates if all(key in x.estimates for x in found)]
    means: dict[str, Estimate] = {}
    scatter: dict[str, float] = {}
    for key in keys:
        mean, between = mean_of([one.estimates[key] for one in found])
        row |= bounds(key, mean, student)
        # of a test to come
        means[key] = Estimate(mean.value, math.hypot(mean.sd, between))
        scatter[key] = between
    row["eta_scatter"] = scatter["eta"]
    lever = None if body is None or body.rigid is None else body.rigid.lever
    head = f"# mean of {len(found)} releases; +- is one standard deviation of a test"
    pasted = all(one.lines for one in found) and means["eta"].value <= 1.0
    lines = lines_of_means(means, scatter, head, lever) if pasted else ()
    return Identification(row, (), lines, (), None, means)

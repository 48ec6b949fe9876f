"""From a measured trace of free rocking to inset, alpha, p and eta."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...errors import DocumentError, UsageError
from ...structures.given import Structure
from .body import ALPHA, BOTH, FITS, INSET, KnownBody, body_of, reading_of, shape_of
from .checks import require_free_rocking, residuals
from .first_look import (
    LEAST_IMPACTS,
    Release,
    noise_of,
    releases_of,
    require_samples,
    sign_changes,
    too_few,
    unfolded,
)
from .fit import FreeRocking, Mixed, mixed, saturated, with_noise
from .identified import (
    COLUMNS,
    IMPACT_COLUMNS,
    Course,
    Estimate,
    Identification,
    bounds,
    mean_of,
)
from .told import (
    document_lines,
    impact_rows,
    is_certain,
    lines_of,
    remarks_of,
    row_of,
    told_of,
)
from .trace import IMPACT, Trace, read_trace

_LEAST_BESIDE = 3  # samples beside an impact that a low pass spoils


class Wanted(NamedTuple):
    """How a trace is to be read and fitted: the arguments of `identify`."""

    body: KnownBody | None
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
    takes_inset = body is not None and body.lever is not None
    chosen = fit or (BOTH if body is None else INSET if takes_inset else ALPHA)
    if chosen not in FITS:
        raise UsageError(f"`fit`: found {fit!r}; expected {', '.join(FITS)}")
    if chosen == INSET and not takes_inset:
        raise UsageError("`fit`: inset needs a structure of a kind that takes `inset`")
    if chosen == ALPHA and body is None:
        raise UsageError("`fit`: alpha alone needs a structure, for p")
    wanted = Wanted(body, chosen, two_sides, height, lowpass, least, gain_error, level)
    for name in ("level", "least", "gain_error", "lowpass", "height"):
        value = getattr(wanted, name)
        high = math.inf if name in ("lowpass", "height") else 1.0
        if value is None or 0.0 < value < high or (name == "gain_error" and not value):
            continue
        raise UsageError(
            f"`{name}`: found {value:g}; expected above 0"
            + f" and below {high:g}" * (high < math.inf)
        )
    found: list[Identification] = []
    for one in several:
        trace = one if isinstance(one, Trace) else read_trace(one, column)
        inside = (trace.t >= (-math.inf if start is None else start)) & (
            trace.t <= (math.inf if stop is None else stop)
        )
        y = trace.y if trace.quantity == IMPACT else trace.y[inside]
        trace = replace(trace, t=trace.t[inside], y=y, lines=trace.lines[inside])
        found += _of_trace(trace, wanted)
    if len(found) > 1:
        found.append(_together(found, wanted))
    return found


def _of_trace(trace: Trace, wanted: Wanted) -> list[Identification]:
    """Return what each release of a trace tells."""
    y, body = trace.y, wanted.body
    if trace.quantity == IMPACT:
        return [_of_impact_times(trace, wanted)]
    require_samples(trace)
    if trace.quantity == "acceleration":
        times = sign_changes(trace.t, y)
        return [_of_impact_times(Trace(trace.name, IMPACT, times), wanted)]
    if trace.quantity == "displacement":
        if wanted.height is None:
            raise UsageError(
                f"{trace.name}: a displacement needs `height`, that of its point over"
                " the base"
            )
        y = y / wanted.height
    if trace.quantity == "uplift":
        if body is None or body.lever is None:
            raise UsageError(
                f"{trace.name}: an uplift needs a structure of a kind that takes"
                " `inset`"
            )
        y = unfolded(y) / (2.0 * body.lever)
    rates = trace.quantity == "theta_dot"
    found = []
    for number, release in enumerate(releases_of(trace, y, rates, wanted.least), 1):
        with np.errstate(all="ignore"):  # of steps that the fit does not take
            found.append(_of_release(trace, number, release, wanted))
    return found


def _fitted(trace: Trace, release: Release, wanted: Wanted, fit: str) -> Mixed:
    """Return fit B of a release. Raises DocumentError, which names the trace."""
    t, y, rates = (
        trace.t[release.window],
        trace.y[release.window],
        trace.quantity == "theta_dot",
    )
    step = float(np.median(np.diff(t)))
    beside = max(1.0 / (wanted.lowpass or math.inf), _LEAST_BESIDE * step)
    model = FreeRocking(
        t,
        y,
        release,
        reading_of(trace.quantity, wanted.body, wanted.height or 0.0),
        shape_of(fit, wanted.two_sides, release, wanted.body),
        beside if rates else 0.0,
        wanted.gain_error,
    )
    try:
        first = saturated(model, noise_of(y))
        found = mixed(first)
        if first.rho:  # fit A takes the slow part of correlated noise for motion
            found = mixed(with_noise(first, y - found.motion.y))
    except DocumentError as error:
        raise DocumentError(f"{trace.name}: {error}") from None
    return found


def _of_release(
    trace: Trace, number: int, release: Release, wanted: Wanted
) -> Identification:
    """Return what one release tells. Raises DocumentError, which names the trace."""
    found = _fitted(trace, release, wanted, wanted.fit)
    free: Mixed | None = found
    if wanted.fit != BOTH:
        try:
            free = _fitted(trace, release, wanted, BOTH)
        except DocumentError:
            free = None
    # wrong sizes are no reason to refuse a trace
    judged = free if free is not None and is_certain(free) else found
    shape = shape_of(judged.first.model.shape.fit, True, release, wanted.body)
    rates = trace.quantity == "theta_dot"
    differ = require_free_rocking(trace.name, judged, shape, rates)
    left = residuals(found.first)
    told = told_of(trace.name, found, free, left, differ, wanted.body, wanted.level)
    fit, kept = np.full(trace.t.size, np.nan), np.zeros(trace.t.size, bool)
    fit[release.window], kept[release.window] = found.motion.y, found.first.kept
    return Identification(
        row_of(told) | {"release": number},
        [row | {"release": number} for row in impact_rows(told)],
        lines_of(told),
        remarks_of(told),
        Course(trace.quantity, trace.t, trace.y, fit, kept, found.motion.impacts),
        told.estimates,
    )


def _together(found: Sequence[Identification], wanted: Wanted) -> Identification:
    """Return the mean of several releases, with the scatter between them."""
    from scipy.special import stdtrit

    student = float(stdtrit(len(found) - 1, 0.5 + 0.5 * wanted.level))
    means: dict[str, Estimate] = {}
    row: dict[str, Any] = dict.fromkeys(COLUMNS)
    row |= {"trace": "all", "impacts": sum(one.row["impacts"] for one in found)}
    for key in found[0].estimates:
        if not all(key in one.estimates for one in found):
            continue
        mean, between = mean_of([one.estimates[key] for one in found])
        row |= bounds({key: mean._replace(factor=student)})
        # of a test to come
        means[key] = Estimate(mean.value, math.hypot(mean.sd, between))
        if key == "eta":
            row["eta_scatter"] = between
    lines: tuple[str, ...] = ()
    if all(one.lines for one in found) and means["eta"].value <= 1.0:
        head = (
            f"# mean of {len(found)} releases; +- is one standard deviation of a test"
        )
        comment = f"between tests {row['eta_scatter']:.1g}"
        lines = head, *document_lines(means, comment, wanted.body)
    return Identification(row, (), lines, (), None, means)


def _of_impact_times(trace: Trace, wanted: Wanted) -> Identification:
    """Return what the times of impacts tell: of the linear equation, with T from impact
    to impact, tanh(p T_(k+1)/2) = eta tanh(p T_k/2), in which alpha cancels. Raises
    UsageError without a body, DocumentError.
    """
    from scipy.special import stdtrit

    if wanted.body is None:
        raise UsageError(f"{trace.name}: impact times need a structure, for p")
    ln_edges, momentum = wanted.body.on(np.zeros(2))
    p = float(np.exp(ln_edges[2:]).mean())
    longs = np.diff(trace.t)
    ratio = 1.0 - 1.0 / np.cosh(0.5 * p * longs)  # theta/alpha of each half-cycle
    small = np.flatnonzero(ratio < wanted.least * ratio[:1])
    speeds = np.tanh(0.5 * p * longs[: small[0] if small.size else None])
    eta = speeds[1:] / speeds[:-1]
    if eta.size < LEAST_IMPACTS:
        raise too_few(trace, eta.size)
    scatter = float(np.std(eta, ddof=1))
    student = float(stdtrit(eta.size - 1, 0.5 + 0.5 * wanted.level))
    mean = Estimate(float(eta.mean()), scatter / math.sqrt(eta.size), student)
    if mean.value > 1.0:
        raise DocumentError(
            f"{trace.name}: the times between impacts grow, by eta = {mean.text()}"
        )
    about = {"trace": trace.name, "release": 1}
    row = (
        about
        | bounds({"eta": mean})
        | {
            "impacts": eta.size,
            "p_structure": p,
            "eta_scatter": scatter,
            "eta_momentum": momentum,
        }
    )
    several = zip(trace.t[1:].tolist(), ratio.tolist(), eta.tolist(), strict=False)
    return Identification(
        dict.fromkeys(COLUMNS) | row,
        [
            dict.fromkeys(IMPACT_COLUMNS)
            | about
            | {"impact": k, "t": t, "ratio": x, "eta_alone": one}
            for k, (t, x, one) in enumerate(several, 2)
        ],
        (
            f"# {trace.name}: {eta.size} impacts, times alone; scatter between impacts"
            f" {scatter:.1g}, between tests not known",
            *document_lines({"eta": mean}, f"momentum: {momentum:.3f}", None),
        ),
        (f"{trace.name}: times of impacts tell eta, never alpha or the inset",),
        None,
        {"eta": mean},
    )

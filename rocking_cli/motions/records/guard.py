"""Looks at the numbers of a record, whatever its format: numbers that are no motion of
a ground are refused, unusual ones are told.
"""

import numpy as np

from ...arrays import Array
from ...documents.quantities import DEFAULT_GRAVITY
from ...errors import DocumentError
from ..blocks import largest

_LONG_STEP = 1.0  # s; recorders sample every 0.001 to 0.02 s
# g; records in gal that are read as g lie above, those in g read as gal below
_USUAL_PEAK = (0.002, 3.0)
_TOLD_MEAN, _REFUSED_MEAN = 0.05, 0.5  # of the peak
# marks of missing values have two digits or more, and this ratio to the samples at
# least
_LEAST_MARK, _BEYOND = (99.0, 50.0)


def unlike_ground(acceleration: Array) -> str:
    """Return why samples [m/s2] are no acceleration of a ground, "" if they may be.

    The ground comes to rest again, so that its acceleration has both signs and a mean
    near zero. Spectra, Husid curves and magnitudes have one sign; some sensors measure
    gravity.
    """
    peak, mean = largest(acceleration), float(np.mean(acceleration))
    if not peak > 0.0:
        return ""
    steps = np.diff(acceleration)
    if steps.size > 1 and np.ptp(steps) < 0.01 * steps[0]:
        return "found numbers that rise evenly, as times do or numbers of lines"
    if not acceleration.min() < 0.0 < acceleration.max():
        side = "below" if acceleration.max() > 0.0 else "above"
        return f"found no sample {side} zero, as of a spectrum, a magnitude or gravity"
    if abs(mean) > _REFUSED_MEAN * peak:
        return f"found {_share(mean, peak)}, as of a sensor that measures gravity"
    return ""


def unusual(acceleration: Array, dt: float, unit: str, stated: str | None) -> list[str]:
    """Return what is told of samples [m/s2] at steps dt [s]; stated: the PGA of the
    header.
    """
    peak, mean, told = largest(acceleration), float(np.mean(acceleration)), list[str]()
    # With g the values cannot be too small by their unit: g is the largest unit.
    small = stated is None and unit != "g" and peak > 0.0
    if peak > _USUAL_PEAK[1] * DEFAULT_GRAVITY or (
        small and peak < _USUAL_PEAK[0] * DEFAULT_GRAVITY
    ):
        told.append(
            f"a PGA of {peak / DEFAULT_GRAVITY:.3g} g, where the unit is taken to be"
            f" {unit}"
        )
    if dt >= _LONG_STEP:
        told.append(f"a time step of {dt:g} s, which is unusually long")
    if _TOLD_MEAN * peak < abs(mean) <= _REFUSED_MEAN * peak:
        told.append(_share(mean, peak))
    return told


def require_no_mark(samples: Array, source: str) -> None:
    """Raise DocumentError for values such as -999 or 9999.9, far beyond all others."""
    size = np.abs(samples)
    peak = float(size.max(initial=0.0))
    digits = f"{peak:.10g}".replace(".", "")
    if peak < _LEAST_MARK or set(digits) != {"9"}:
        return
    others = size[size < peak]
    if others.size and peak > _BEYOND * float(others.max()):
        at = int(np.argmax(size))
        raise DocumentError(
            f"{source}: sample {at + 1} is {samples[at]:.10g}, which marks a missing"
            " value"
        )


def _share(mean: float, peak: float) -> str:
    return f"a mean of {mean:.4g} m/s2, {100.0 * abs(mean) / peak:.2g} % of the peak"

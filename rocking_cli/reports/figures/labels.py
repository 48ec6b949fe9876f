"""Axis labels: symbols as formulas, and units."""

from __future__ import annotations

from ..units import Units

SYMBOLS = {
    "A": r"$A = a_{scale}\,a_g/(\alpha g)$",
    "Omega": r"$\Omega = \omega_g/p$",
    "a_g": r"$a_g$",
    "omega_g": r"$\omega_g$",
    "f_g": r"$f_g$",
    "t": "time $t$",
    "tau": r"$p\,t$",
    "theta": r"rotation $\theta$",
    "theta_ratio": r"$\theta/\alpha$",
    "theta_max_ratio": r"$\theta_{max}/\alpha$",
    "ground_acceleration": r"$\ddot{x}_g$",
    "A_s": r"$A\,s$",
    "p": "$p$",
    "alpha": r"$\alpha$",
    "eta": r"$\eta$",
    "lambda": r"$\lambda$",
    "a_scale": r"$a_{scale}$",
    "T": r"$T = 2\pi/p$",
    "scale": "factor of the record",
}
PLAIN = {"m/s2": "m/s²", "cm/s2": "cm/s²"}


def label(column: str, units: Units) -> str:
    """The axis label of a column in these units, such as `$a_g$ [m/s²]`."""
    name, unit, _ = units.column(column)
    return f"{SYMBOLS.get(name, name.replace('_', ' '))} [{PLAIN.get(unit, unit) or '-'}]"


def valued(column: str, value: float, units: Units) -> str:
    """A column and a value (in SI units) as text, such as `$f_g$ = 1.5 Hz`."""
    name, unit, factor = units.column(column)
    short = {"A": "$A$", "Omega": r"$\Omega$", "T": "$T$"}.get(name) or SYMBOLS.get(name, name)
    return f"{short} = {value / factor:.4g} {PLAIN.get(unit, unit)}".rstrip()


def titled(name: str, eta: float) -> str:
    """The name of a structure and its eta; only eta if the name states it, as that of a dimensionless oscillator."""
    from .canvas import literal

    own = f"eta={eta:g}"
    return rf"$\eta$ = {eta:.4g}" if name == own else rf"{literal(name)}, $\eta$ = {eta:.4g}"

"""The Taylor recurrence of an equation of motion, as text that is compiled to straight-line code on floats.

Every equation is y'' = -w F(y) + a G(y) - 2 zeta y' (`equations.equation`, where F and G are l and m). Over a step h the code finds the
terms Y_n = y_n h^n from those of F and G along the motion:

    Y_(n+2) = h^2/((n + 1)(n + 2)) [(a G)_n - (w F)_n] - 2 zeta h Y_(n+1)/(n + 2)

The drive a and the weight w are straight lines over the step, or terms that are given.
"""

import math
from collections.abc import Callable
from types import CodeType
from typing import Any, NamedTuple

from ..equations.equation import Law
from .series_roots import only_root, value

Terms = Callable[..., tuple[float, ...]]
_CODES: dict[tuple[Any, ...], CodeType] = {}


class Code(NamedTuple):
    """Compiled functions for one side of a body, with series up to Y_order. terms(y, v, h, drive ..., force): returns Y_0 ... Y_order;
    march_lines: marches over whole straight segments (`lane`), None if the equation needs more than numbers at each step."""

    order: int
    terms: Terms
    march_lines: Callable[..., tuple[int, float, float, float, bool]] | None


def compiled(law: Law, order: int, zeta: float, straight: bool, weighed: bool) -> Code:
    """Compile the code of a law with terms up to this order."""
    space: dict[str, Any] = {"tan": math.tan, "exp": math.exp, "only_root": only_root, "value": value, **law.numbers, "drag": 2.0 * zeta}
    exec(_code(law, order, zeta != 0.0, straight, weighed), space)
    return Code(order, space["terms"], space.get("march_lines"))


def _code(law: Law, order: int, damped: bool, straight: bool, weighed: bool) -> CodeType:
    key = law.name, order, damped, straight, weighed
    if key not in _CODES:
        _CODES[key] = compile(_text(law, order, damped, straight, weighed), f"<{law.name}>", "exec")
    return _CODES[key]


def _text(law: Law, order: int, damped: bool, straight: bool, weighed: bool) -> str:
    """The source of the two functions `terms` and `march_lines`."""
    numbers = "".join(f", {name}={name}" for name in (*law.numbers, "drag", "tan", "exp"))
    given = ("a", "g", *(("w", "e") if weighed else ())) if straight else ("d", *(("w",) if weighed else ()))
    body = _lines(law, order, damped, straight, weighed)
    text = [
        f"def terms(y, v, h, {', '.join(given)}, force=None, local=None{numbers}):",
        "    Y1 = v*h",
        "    q = h*h",
        *(f"    {line}" for line in body),
    ]
    text.append(f"    return (y, {', '.join(f'Y{n}' for n in range(1, order + 1))})")
    if straight and law.local is None:
        text += _march_lines(law, order, damped, weighed, numbers)
    return "\n".join(text)


def _lines(law: Law, order: int, damped: bool, straight: bool, weighed: bool) -> list[str]:
    """The source lines that compute the Taylor terms from Y2 on."""
    lines = [*law.start]
    for n in range(order - 1):
        if n:
            lines += law.term(n)
        drive_term = _product("G", n, straight, ("a", "g"), "d", law.constant)
        weight_term = _product("F", n, straight, ("w", "e"), "w", False) if weighed else f"F{n}"
        drive_term = f"({drive_term}) - ({weight_term})" if drive_term else f"-({weight_term})"
        if n == 0:
            lines.append(f"f = {drive_term} if force is None else force")
            drive_term = "f"
        drag = f" - drag*h*Y{n + 1}*{1.0 / (n + 2)!r}" if damped else ""
        lines.append(f"Y{n + 2} = q*({drive_term})*{1.0 / ((n + 1) * (n + 2))!r}{drag}")
    return lines


def _product(of: str, n: int, straight: bool, line: tuple[str, str], terms: str, constant: bool) -> str:
    """Source of term n of the product of the drive, or of the weight, with a function along the motion."""
    if constant:
        return line[n] if straight and n < 2 else "" if straight else f"{terms}[{n}]"
    if straight:
        return f"{line[0]}*{of}{n}" + (f" + {line[1]}*{of}{n - 1}" if n else "")
    return " + ".join(f"{terms}[{i}]*{of}{n - i}" for i in range(n + 1))


def _march_lines(law: Law, order: int, damped: bool, weighed: bool, numbers: str) -> list[str]:
    """Source lines of a function that marches a body from phase u of segment k over straight lines, up to an impact or the last line. It
    returns (segment, phase, y, y', True after an impact)."""
    # A step is taken if its series holds, Lemma 12 or the sign of y at its end (Lemma 1) decides on an impact, and no turn is above `peak`.
    lists, lifts = (", W, E", "w") if weighed else ("", "1.0")
    head = f"k, u, last, y, v, force, S, R, L{lists}, m, pace, fall, top, peak, least, keep, sway=0.0, root=only_root, at=value{numbers}"
    lines = ["h = L[k]*pace", "a = m*S[k]", "g = m*R[k]"]
    lines += ["w = 1.0 + sway*W[k]", "e = sway*E[k]"] if weighed else []
    lines += ["if u:", "    x = u/L[k]", "    a += g*x", "    g -= g*x", "    h -= h*x"]
    lines += ["    w += e*x", "    e -= e*x"] if weighed else []
    lines += ["Y1 = v*h", "q = h*h", f"clear = y + Y1{' - 0.5*drag*h*abs(Y1)' if damped else ''} > 0.5*fall*q"]
    lines += [f"if not clear and (a > {lifts} or a + g > {lifts + (' + e' if weighed else '')}): break"]
    lines += _lines(law, order, damped, True, weighed)
    low, high = f"Y{order - 1}", f"Y{order}"
    terms = f"(y, {', '.join(f'Y{n}' for n in range(1, order + 1))})"
    chord_error = " + ".join(f"{0.125 * n * (n - 1) * (n - 2)}*abs(Y{n})" for n in range(3, order + 1))
    rise = f"0.125*fall*q{'*exp(drag*h)' if damped else ''}"
    lines += [
        f"if abs({high}) + 0.25*h*abs({low}) > least*h: break",
        f"Y = y + {' + '.join(f'Y{n}' for n in range(1, order + 1))}",
        f"V = Y1 + {' + '.join(f'{float(n)}*Y{n}' for n in range(2, order + 1))}",
        "if Y >= top and V > 0.0: break",
        f"if (y if y > Y else Y) + {rise} > peak and (Y1 > 0.0 >= V or (abs(Y1) < (error := {chord_error}) or abs(V) < error)): break",
        "if not clear and Y <= 0.0:",
        f"    t = root({terms}, h, fall, 0.5*drag)",
        f"    if keep is not None: keep(k, u, t, h, {terms})",
        f"    return k, u + t/pace, 0.0, min(at({terms}, t/h, h)[1], 0.0), True",
        f"if keep is not None: keep(k, u, h, h, {terms})",
        "k += 1", "u = 0.0", "y = Y", "v = V/h", "force = None",
    ]  # fmt: skip
    return [f"def march_lines({head}):", "    while k < last:", *(f"        {line}" for line in lines), "    return k, u, y, v, False"]

"""The phase portrait of a response, with the separatrix of its equation."""

import math

import numpy as np

from ...documents.document import Document
from ...documents.parsing import parse_documents
from ...documents.quantities import DEFAULT_GRAVITY
from ...dynamics.method import LINEAR, Method
from ...errors import ArgumentError
from ...responses.separatrix import separatrix
from ...structures import build_structure
from ...structures.parameters import dimensionless_oscillator
from ..rows import Rows, column
from ..units import Units
from .canvas import Axes, Figure, heading, label, legend, line_style


def phase(
    figure: Figure, rows: Rows, units: Units, body: Document | None = None
) -> list[Axes]:
    """Draw theta_dot/(p alpha) of a response over theta/alpha, with the separatrix
    inside which a body comes back on still ground.

    body: None for the block with the p and alpha of the response. Raises ArgumentError
    if the rows do not tell them.
    """
    suffixes = [
        suffix
        for suffix in ("", "_linear", "_nonlinear")
        if f"theta_ratio{suffix}" in rows[0]
    ]
    if not suffixes:
        raise ArgumentError(
            "found no column theta_ratio; expected the CSV of rocking response"
        )
    axes, reach = figure.add_subplot(), 1.0
    bodies: list[tuple[str, Document | None]] = []  # equation and body of each
    for i, suffix in enumerate(suffixes):
        ratio, rate, block = _trajectory(rows, suffix)
        label_of_line = f"{suffix[1:]} equation" if suffix else "response"
        axes.plot(ratio, rate, lw=1.0, **line_style(i), label=label_of_line)
        axes.plot(ratio[-1:], rate[-1:], "o", color=f"C{i}", ms=4.0)
        reach = max(reach, 1.05 * float(np.nanmax(np.abs(ratio))))
        model = suffix[1:] or rows[0].get("model") or LINEAR.model
        if body is None and block is None and (model != LINEAR.model or "t" in rows[0]):
            raise ArgumentError(
                "found a body whose sides differ, or no alpha; expected `body`, the"
                " document of its structure"
            )
        bodies.append((model, body or block))
    for (model, document), dash in zip(bodies, ("--", ":", "-."), strict=False):
        words = "separatrix" if len(bodies) == 1 else f"separatrix, {model}"
        if body is None and model != LINEAR.model:
            words += " of a block"
        _plot_separatrix(axes, document, Method(model), 1.05 * reach, dash, words)
    axes.set(
        xlim=(-reach, reach),
        xlabel=label("theta_ratio", units),
        ylabel=r"$\dot\theta/(p\,\alpha)$ [-]",
    )
    axes.set_title(heading(rows, units, "structure", "motion", "model"))
    legend(axes)
    return [axes]


def _trajectory(
    rows: Rows, suffix: str
) -> tuple[np.ndarray, np.ndarray, Document | None]:
    """Return (theta/alpha, theta_dot/(p alpha), the block with this p and alpha). The
    block is None for rows without units, and for sides that differ.
    """
    if "t" not in rows[0]:
        ratio = column(rows, f"theta_ratio{suffix}")
        return ratio, column(rows, f"theta_ratio_rate{suffix}"), None
    _, ratio, alpha, p = scaled(rows, suffix)
    equal = np.ptp(alpha) <= 1e-6 * alpha[0]
    block = block_of(float(alpha[0]), p) if equal else None
    return ratio, column(rows, f"theta_dot{suffix}") / (p * alpha), block


def _plot_separatrix(
    axes: Axes,
    document: Document | None,
    method: Method,
    reach: float,
    dash: str,
    words: str,
) -> None:
    """Draw the separatrix up to theta/alpha = reach; document: None for the
    dimensionless body of the linear equation.
    """
    structure = (
        dimensionless_oscillator(eta=1.0)
        if document is None
        else build_structure(document)
    )
    for i, (x, y) in enumerate(separatrix(structure, method, reach)):
        # With damping the branches have no mirror image.
        for sign in (1.0,) if structure.damping else (1.0, -1.0):
            text = "_" if i or sign < 0.0 else words
            axes.plot(x, sign * y, color="0.4", lw=0.9, ls=dash, label=text)


def scaled(
    rows: Rows, suffix: str = ""
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return (theta, theta/alpha, alpha at each time, p) of a response with units.
    Raises ArgumentError if it does not rock.
    """
    theta, ratio, tau, t = (
        column(rows, name)
        for name in (f"theta{suffix}", f"theta_ratio{suffix}", "tau", "t")
    )
    rocks = np.flatnonzero(ratio)
    if not rocks.size:
        raise ArgumentError(
            "the body does not rock, so that its angle alpha is not known"
        )
    return (
        theta,
        ratio,
        np.interp(np.arange(ratio.size), rocks, theta[rocks] / ratio[rocks]),
        float(tau[-1] / t[-1]),
    )


def block_of(alpha: float, p: float) -> Document:
    """Return the block with this alpha and p, R = 3 g/(4 p^2)."""
    size = 1.5 * DEFAULT_GRAVITY / p**2
    (document,) = parse_documents(
        f"{{kind: block, width: {size * math.sin(alpha)!r}, height:"
        f" {size * math.cos(alpha)!r}}}"
    )
    return document

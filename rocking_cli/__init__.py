"""Rocking dynamics of masonry structures: parameters, spectra and overturning envelopes.

The public names below are imported on first use, so that a program pays only for what it calls.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from .dynamics.equations.linear import LinearEquation
    from .dynamics.equations.mechanism import MechanismEquation
    from .dynamics.equations.rigid_body import RigidBodyEquation
    from .dynamics.method import Method
    from .dynamics.outcome import Outcome, overturned, safe
    from .dynamics.response import Response, linear_response, nonlinear_response, response
    from .dynamics.system import System
    from .errors import DocumentError, OutputError, RockingError, UsageError
    from .motions import Motion, cosine, pulse, read_motion, sine
    from .responses.history import History, history
    from .spectra.closed_form import closed_form_curves
    from .spectra.envelope import Interval, trace_envelope
    from .spectra.grid import Axis, Grid, parse_grid
    from .spectra.sweep import Spectrum, Summary, spectrum, write_spectrum
    from .structures import RockingParameters, build_structure, load_structures, parse_documents
    from .structures.parameters import dimensionless_oscillator

_HOME = {
    "Response": "dynamics.response",
    "linear_response": "dynamics.response",
    "response": "dynamics.response",
    "History": "responses.history",
    "history": "responses.history",
    "LinearEquation": "dynamics.equations.linear",
    "MechanismEquation": "dynamics.equations.mechanism",
    "RigidBodyEquation": "dynamics.equations.rigid_body",
    "nonlinear_response": "dynamics.response",
    "System": "dynamics.system",
    "Outcome": "dynamics.outcome",
    "overturned": "dynamics.outcome",
    "safe": "dynamics.outcome",
    "DocumentError": "errors",
    "OutputError": "errors",
    "RockingError": "errors",
    "UsageError": "errors",
    "Motion": "motions",
    "cosine": "motions",
    "pulse": "motions",
    "read_motion": "motions",
    "sine": "motions",
    "closed_form_curves": "spectra.closed_form",
    "Interval": "spectra.envelope",
    "trace_envelope": "spectra.envelope",
    "Axis": "spectra.grid",
    "Grid": "spectra.grid",
    "parse_grid": "spectra.grid",
    "Method": "dynamics.method",
    "Spectrum": "spectra.sweep",
    "Summary": "spectra.sweep",
    "spectrum": "spectra.sweep",
    "write_spectrum": "spectra.sweep",
    "RockingParameters": "structures",
    "build_structure": "structures",
    "load_structures": "structures",
    "parse_documents": "structures",
    "dimensionless_oscillator": "structures.parameters",
}

__all__ = [
    "Axis",
    "DocumentError",
    "Grid",
    "History",
    "Interval",
    "LinearEquation",
    "MechanismEquation",
    "Method",
    "Motion",
    "Outcome",
    "OutputError",
    "Response",
    "RigidBodyEquation",
    "RockingError",
    "RockingParameters",
    "Spectrum",
    "Summary",
    "System",
    "UsageError",
    "__version__",
    "build_structure",
    "closed_form_curves",
    "cosine",
    "dimensionless_oscillator",
    "history",
    "linear_response",
    "load_structures",
    "nonlinear_response",
    "overturned",
    "parse_documents",
    "parse_grid",
    "pulse",
    "read_motion",
    "response",
    "safe",
    "sine",
    "spectrum",
    "trace_envelope",
    "write_spectrum",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return list(__all__)

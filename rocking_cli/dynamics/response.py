"""The nonlinear equation of rigid bodies (Eq. 2.3) for arrays of cells; for mechanisms (Eq. 3.4) see `mechanism`."""

from __future__ import annotations

import numpy as np

from ..motions.motion import Motion
from .equations.rigid_body import RigidModel
from .march.engine import Response, response

Array = np.ndarray


def nonlinear_response(
    motion: Motion, amplitude: Array, omega: Array, eta: Array | float, alpha: float, *, tolerance: float = 1e-9, peaks: bool = True
) -> Response:
    """Largest rotation and outcome of rigid bodies of one critical angle under one motion (Eqs. 2.3, 2.6).

    Parameters: amplitude A = a_g / (alpha g) [-], omega Omega = omega_g / p [-] and eta [-] as in `linear_response`; alpha
    [rad]; tolerance: of theta/alpha. theta_ratio is max |theta|/alpha. Raises ValueError when a number is out of range.
    """
    return response(RigidModel(alpha, tolerance), motion, amplitude, omega, eta, peaks=peaks)

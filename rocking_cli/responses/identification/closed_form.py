"""Free rocking of a rigid body in closed form. In the half-cycle whose peak is theta_k,
with psi = alpha - |theta| and m = cos^2(psi_k/2), the equation psi'' = p^2 sin psi has
the solution

    motion     sin(psi/2) = sin(psi_k/2) / dn(p (t - t_k) | m),  t_k: time of the peak
    quarter    Q = F(phi | m)/p,  sin^2 phi = (1 - sin^2(psi_k/2)/sin^2(alpha/2))/m
    energy     K = theta_dot^2/2 at the impact = 2 p^2 (sin^2(alpha/2) - sin^2(psi_k/2))

dn is Jacobi's elliptic function, F the incomplete elliptic integral of the first kind.
The next impact is 2 Q later, and eta_k^2 = K(theta_k)/K(theta_(k-1)) at impact k, each
with alpha and p of its own side.
"""

import numpy as np

from ...arrays import Array


def half_angle_difference(theta: Array, alpha: Array) -> Array:
    """Return sin^2(alpha/2) - sin^2((alpha - theta)/2), without cancellation."""
    return np.sin(0.5 * theta) * np.sin(alpha - 0.5 * theta)


def quarter(theta: Array, alpha: Array, p: Array) -> Array:
    """Return the time Q [s] from the peak theta [rad] to the impact."""
    from scipy.special import ellipkinc

    m = np.cos(0.5 * (alpha - theta)) ** 2
    square = half_angle_difference(theta, alpha) / (np.sin(0.5 * alpha) ** 2 * m)
    return np.asarray(ellipkinc(np.arcsin(np.sqrt(np.minimum(square, 1.0))), m) / p)


def energy(theta: Array, alpha: Array, p: Array) -> Array:
    """Return K [rad^2/s^2] at the impacts beside a peak theta [rad]."""
    return 2.0 * p**2 * half_angle_difference(theta, alpha)


def motion(since: Array, theta: Array, alpha: Array, p: Array) -> tuple[Array, Array]:
    """Return |theta| [rad] and its rate [rad/s] at times since the peak theta [s]."""
    from scipy.special import ellipj

    m = np.cos(0.5 * (alpha - theta)) ** 2
    sn, cn, dn, _ = ellipj(p * since, m)
    least = np.sin(0.5 * (alpha - theta))
    psi = 2.0 * np.arcsin(np.minimum(least / dn, 1.0))
    rate = least * p * m * sn * cn / dn**2
    return alpha - psi, -2.0 * rate / np.maximum(np.cos(0.5 * psi), 1e-9)

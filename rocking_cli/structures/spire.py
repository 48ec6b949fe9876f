"""The conical masonry spire that rocks on the edge of its base (Fig. 3a, Eqs. 3.1-3.3)."""

from __future__ import annotations

import math

from .document import Document
from .parameters import RockingParameters
from .rigid import rigid_body


def build(document: Document, name: str) -> RockingParameters:
    """A thin hollow cone: base_radius r_b and height H; with kappa = r_b/H, tan alpha = 3 kappa (Eq. 3.1)."""
    base, height = document.length("base_radius"), document.length("height")
    centroid = math.hypot(base, height / 3.0)
    inertia = (1.25 * base**2 + height**2 / 6.0) / centroid**2  # I_P / (M R^2), from Eq. 3.2
    alpha = math.atan2(3.0 * base, height)
    return rigid_body(document, "spire", name, radius=centroid, alpha=alpha, inertia=inertia, limit="a spire more slender than this one")

"""What shakes: ground motions as exact pieces. Records, and what reads files, stand in modules of their own: most sweeps need none."""

from .motion import Motion
from .piece import Harmonic, Piece
from .pulses import (
    PULSES,
    cosine,
    half_sine,
    mavroeidis_papageorgiou,
    pulse,
    rectangular,
    rectangular_impulse,
    ricker_antisymmetric,
    ricker_symmetric,
    sine,
)

__all__ = [
    "PULSES",
    "Harmonic",
    "Motion",
    "Piece",
    "cosine",
    "half_sine",
    "mavroeidis_papageorgiou",
    "pulse",
    "rectangular",
    "rectangular_impulse",
    "ricker_antisymmetric",
    "ricker_symmetric",
    "sine",
]

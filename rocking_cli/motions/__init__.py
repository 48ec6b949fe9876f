"""What shakes: ground motions as exact pieces."""

from .motion import Harmonic, Motion, Piece
from .pieces import read_motion
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
    "read_motion",
    "rectangular",
    "rectangular_impulse",
    "ricker_antisymmetric",
    "ricker_symmetric",
    "sine",
]

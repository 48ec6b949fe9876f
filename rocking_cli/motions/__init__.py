"""What shakes: ground motions as exact pieces."""

from .motion import Harmonic, Motion, Piece
from .pulses import PULSES, cosine, pulse, sine

__all__ = ["PULSES", "Harmonic", "Motion", "Piece", "cosine", "pulse", "sine"]

"""Ground motions as exact pieces: pulses here; records and files in other modules,
because most sweeps do not need them.
"""

from .motion import Harmonic, Motion, Piece
from .pulses import PULSES, cosine, pulse, sine

__all__ = ["PULSES", "Harmonic", "Motion", "Piece", "cosine", "pulse", "sine"]

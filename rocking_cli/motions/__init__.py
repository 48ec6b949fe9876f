"""What shakes: ground motions as exact pieces."""

from .intensity import Intensity, intensity
from .motion import Harmonic, Motion, Piece
from .polyline import Polyline, record_motion
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
from .reading import read_motion
from .records import Record, read_record, read_records

__all__ = [
    "PULSES",
    "Harmonic",
    "Intensity",
    "Motion",
    "Piece",
    "Polyline",
    "Record",
    "cosine",
    "half_sine",
    "intensity",
    "mavroeidis_papageorgiou",
    "pulse",
    "read_motion",
    "read_record",
    "read_records",
    "record_motion",
    "rectangular",
    "rectangular_impulse",
    "ricker_antisymmetric",
    "ricker_symmetric",
    "sine",
]

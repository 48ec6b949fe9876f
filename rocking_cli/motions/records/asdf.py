"""Workspaces of gmprocess and other files of ASDF (HDF5): Waveforms/NET.STA holds a
data set for each channel, `NET.STA.LOC.CHA__START__END__TAG`, with the attribute
sampling_rate.

The file states no unit; the user does. Data that the tag calls unprocessed are taken
only where the file has no others and is named itself.
"""

import io
import re
from typing import TYPE_CHECKING

import numpy as np

from ...errors import DocumentError, NoAcceleration
from .record import Given, Series
from .units import WRITTEN_UNITS

if TYPE_CHECKING:
    import h5py

NAME = "ASDF"
_MAGIC = b"\x89HDF\r\n\x1a\n"
_RAW = re.compile(r"unprocessed|raw", re.IGNORECASE)


def recognise(raw: bytes) -> bool:
    """True for an HDF5 file with waveforms, and for the first eight bytes of any HDF5
    file.
    """
    if not raw.startswith(_MAGIC):
        return False
    if len(raw) == len(_MAGIC):
        return True
    import h5py

    try:
        with h5py.File(io.BytesIO(raw), "r") as file:
            return "Waveforms" in file
    except (OSError, RuntimeError):
        return False


def read(source: str, raw: bytes, given: Given, named: bool) -> list[Series]:
    """Return every channel. Raises DocumentError, and NoAcceleration for counts."""
    import h5py

    with h5py.File(io.BytesIO(raw), "r") as file:
        held = [
            (name, data)
            for station in file["Waveforms"].values()
            for name, data in sorted(station.items())
            if isinstance(data, h5py.Dataset) and "__" in name
        ]
        processed = [x for x in held if not _RAW.search(x[0].rpartition("__")[2])]
        if not held:
            raise NoAcceleration(f"{source}: an ASDF file without waveforms")
        if not processed and not named:
            raise NoAcceleration(
                f"{source}: unprocessed waveforms, which are taken where the file"
                " itself is named"
            )
        if given.unit is None:
            raise DocumentError(
                f"{source}: waveforms (ASDF) without a unit; give it as `unit`, one of"
                f" {', '.join(WRITTEN_UNITS)} (gmprocess writes cm/s2)"
            )
        return [_series(source, name, data, given) for name, data in processed or held]


def _series(source: str, name: str, data: "h5py.Dataset", given: Given) -> Series:
    """Return the samples of one waveform. Raises NoAcceleration for counts,
    DocumentError for a step that is missing or contradicted.
    """
    channel, *_, tag = name.split("__")
    if not np.issubdtype(data.dtype, np.floating):
        raise NoAcceleration(
            f"{source}: {channel}: whole numbers, which are counts of an instrument"
        )
    rate = float(data.attrs.get("sampling_rate", 0.0))
    if not rate > 0.0:
        raise DocumentError(f"{source}: {channel}: no attribute sampling_rate")
    if given.dt is not None and abs(given.dt * rate - 1.0) > 1e-3:
        said = f"`dt`: found {given.dt:g} s; the file says otherwise: {1.0 / rate:g} s"
        raise DocumentError(f"{source}: {said} ({channel})")
    remark = "unprocessed waveforms" if _RAW.search(tag) else ""
    samples = np.array(data, dtype=float)
    return Series(channel, 1.0 / rate, samples, given.unit or "", remark=remark)

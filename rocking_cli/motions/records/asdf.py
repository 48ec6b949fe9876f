"""Workspaces of gmprocess and other files of ASDF (HDF5): Waveforms/NET.STA holds a
data set for each channel, `NET.STA.LOC.CHA__START__END__TAG`, with the attribute
sampling_rate.

The file states no unit; the user does. Data that the tag calls unprocessed are taken
only where the file has no others and is named itself.
"""

import io
import math
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from ...documents.files import LARGEST
from ...errors import DocumentError, NoAcceleration
from .record import Given, Series
from .units import WRITTEN_UNITS

if TYPE_CHECKING:
    import h5py

NAME = "ASDF"
_MAGIC = b"\x89HDF\r\n\x1a\n"
_RAW = re.compile(r"unprocessed|raw", re.IGNORECASE)
# of h5py and of a file that another program wrote or damaged
_FAULTS = (OSError, LookupError, ValueError, TypeError, RuntimeError, AttributeError)


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
            return file.get("Waveforms", getlink=True) is not None
    except _FAULTS:
        return False


def read(source: str, raw: bytes, given: Given) -> list[Series]:
    """Return every channel. Raises DocumentError, and NoAcceleration for counts."""
    import h5py

    try:
        with h5py.File(io.BytesIO(raw), "r") as file:
            return _channels(source, file, given)
    except _FAULTS as error:
        raise DocumentError(
            f"{source}: an ASDF file that is damaged, or not as gmprocess writes it:"
            f" {error}"
        ) from None


def _channels(source: str, file: "h5py.File", given: Given) -> list[Series]:
    """Return every channel of an open file. Raises DocumentError, NoAcceleration, and
    one of _FAULTS.
    """
    from ...documents.hdf5 import own_dataset, own_group, unpacked_size

    waveforms = own_group(file, "Waveforms")
    stations = [own_group(waveforms, name) for name in waveforms]
    held = [
        (name, own_dataset(station, name))
        for station in stations
        for name in sorted(station)
        if "__" in name
    ]
    processed = [x for x in held if not _RAW.search(x[0].rpartition("__")[2])]
    if not held:
        raise NoAcceleration(f"{source}: an ASDF file without waveforms")
    if not processed and not given.named:
        raise NoAcceleration(
            f"{source}: unprocessed waveforms, which are taken where the file itself is"
            " named"
        )
    if given.unit is None:
        raise DocumentError(
            f"{source}: waveforms (ASDF) without a unit; give it as `unit`, one of"
            f" {', '.join(WRITTEN_UNITS)} (gmprocess writes cm/s2)"
        )
    taken = processed or held
    if sum(unpacked_size(data) for _, data in taken) > LARGEST:
        raise DocumentError(
            f"{source}: waveforms larger than {LARGEST >> 20} MiB when unpacked, the"
            " limit of a file"
        )
    return [_series(source, name, data, given) for name, data in taken]


def _series(source: str, name: str, data: "h5py.Dataset", given: Given) -> Series:
    """Return the samples of one waveform. Raises NoAcceleration for counts,
    DocumentError for a step that is missing, ValueError for samples that the file does
    not store.
    """
    from ...documents.hdf5 import require_stored

    channel, *_, tag = name.split("__")
    if data.dtype.kind in "iu":
        raise NoAcceleration(
            f"{source}: {channel}: whole numbers, which are counts of an instrument"
        )
    if data.dtype.kind != "f" or data.ndim != 1:
        raise ValueError(f"{channel} is not one row of samples")
    require_stored(data)
    rate = _rate(data.attrs.get("sampling_rate"))
    if rate is None:
        raise DocumentError(
            f"{source}: {channel}: no attribute sampling_rate that is a positive number"
        )
    remark = "unprocessed waveforms" if _RAW.search(tag) else ""
    samples = np.array(data, dtype=float)
    return Series(channel, 1.0 / rate, samples, given.unit or "", remark=remark)


def _rate(stated: Any) -> float | None:
    """Return a sampling rate [Hz], None for what is no positive number."""
    number = np.asarray(stated)
    if number.ndim or number.dtype.kind not in "iuf":
        return None
    rate = float(number)
    return rate if 0.0 < rate < math.inf else None

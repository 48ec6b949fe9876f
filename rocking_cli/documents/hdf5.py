"""What an HDF5 file holds itself: no links, no values of other files, none that it only
states.
"""

import math
from typing import Any

import h5py


def own_group(group: h5py.Group, name: str) -> h5py.Group:
    """Return a group inside a group. Raises ValueError for a link and all else."""
    return _own(group, name, h5py.Group, "group")


def own_dataset(group: h5py.Group, name: str) -> h5py.Dataset:
    """Return a dataset of a group. Raises ValueError for all else, for a link, and for
    a dataset whose values lie in another file.
    """
    data: h5py.Dataset = _own(group, name, h5py.Dataset, "dataset")
    if data.external or data.is_virtual:
        raise ValueError(f"its {name} is stored in another file")
    return data


def _own(group: h5py.Group, name: str, kind: type, word: str) -> Any:
    link = group.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink) or not isinstance(group[name], kind):
        raise ValueError(f"its {name} is not a {word} of its own")
    return group[name]


def _chunks(data: h5py.Dataset) -> int:
    """The number of chunks that hold all values of a dataset in chunks."""
    pairs = zip(data.shape, data.chunks, strict=True)
    return math.prod(-(-size // chunk) for size, chunk in pairs)


def unpacked_size(data: h5py.Dataset) -> int:
    """Return the bytes of a dataset in memory, with those of whole chunks."""
    if data.chunks is None:
        return int(data.nbytes)
    return _chunks(data) * math.prod(data.chunks) * int(data.dtype.itemsize)


def require_stored(data: h5py.Dataset) -> None:
    """Raise ValueError for a dataset that states more values than the file stores."""
    whole = (
        data.id.get_storage_size() >= data.nbytes
        if data.chunks is None
        else data.id.get_num_chunks() == _chunks(data)
    )
    if not whole:
        raise ValueError(f"it states {data.size} values and stores fewer")

"""The digest of a spectra file's layout: everything that says what its numbers mean, except the chunks and their state."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from typing import Any

import h5py
import numpy as np

DIGEST = "layout_digest"
"""The root attribute that states it."""

SETTLED = ("Conventions", "title", "source", "scene", "history", "documents", "motion", "model", "tolerance", "shard")
"""Root attributes that are settled when a file begins; those that come at its end are not part of the digest."""

STATE = ("chunk_done", "chunk_checksum")
"""Datasets whose values change while a sweep runs."""

_SCALES = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST")  # how HDF5 stores dimensions: what they say is digested instead


def digest_of(root: Mapping[str, Any], datasets: Mapping[str, h5py.Dataset]) -> str:
    """BLAKE2b-256, in hex, of the settled attributes, and of each dataset's form, attributes and (no chunks) values.

    root: the file's own attributes; datasets: those of the file by name, which is the file itself where they are not open yet.
    """
    digest = hashlib.blake2b(digest_size=32)
    for piece in _pieces(root, datasets):
        digest.update(len(piece).to_bytes(8, "little"))
        digest.update(piece)
    return f"blake2b:{digest.hexdigest()}"


def filters_of(data: h5py.Dataset) -> list[tuple[int, int, tuple[int, ...]]]:
    """(code, flags, options) of each of a dataset's filters."""
    plist = data.id.get_create_plist()
    return [plist.get_filter(i)[:3] for i in range(plist.get_nfilters())]


def plain(value: Any) -> Any:
    """An attribute's value as Python has it."""
    return value.item() if isinstance(value, np.generic) else value.tolist() if isinstance(value, np.ndarray) else value


def _pieces(root: Mapping[str, Any], datasets: Mapping[str, h5py.Dataset]) -> Iterator[bytes]:
    for key in SETTLED:
        if key in root:
            yield _text(key, plain(root[key]))
    for name in sorted(datasets):
        data = datasets[name]
        stated = data.attrs
        dimensions = [[scale.name for scale in dimension.values()] for dimension in data.dims]
        about = sorted((key, plain(stated[key])) for key in stated if key not in _SCALES)
        fill = "" if data.dtype.hasobject else np.asarray(data.fillvalue).tobytes().hex()
        form = (h5py.check_string_dtype(data.dtype), data.dtype.str, data.shape, data.chunks, filters_of(data), fill)
        yield _text(name, form, about, dimensions)
        if data.chunks is None and name not in STATE:
            values = data[...]
            yield _text(values.tolist()) if data.dtype.hasobject else values.tobytes()


def _text(*parts: Any) -> bytes:
    return repr(parts).encode("utf-8", "backslashreplace")

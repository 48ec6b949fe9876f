"""The layout of a spectra file: which datasets it has, built in memory, so that no half of one ever stands on a disk.

Everything but the state of the chunks is settled when the file begins, and a digest of it stands in the file. The tables below
are all that a new variable, parameter or coordinate needs.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import h5py
import numpy as np

from .. import __version__
from ..dynamics.outcome import Outcome
from ..structures.parameters import RockingParameters
from .chunks import GZIP_LEVEL, ChunkGrid
from .digest import DIGEST, digest_of
from .grid import LONG_NAMES, UNITS, Grid

PARAMETERS: dict[str, tuple[str, str, Callable[[RockingParameters], float]]] = {
    "p": ("rad s-1", "frequency parameter", lambda s: s.p),
    "alpha": ("rad", "critical angle", lambda s: s.alpha),
    "eta": ("1", "coefficient of restitution", lambda s: s.eta),
    "lambda": ("1", "static uplift acceleration over gravity", lambda s: s.uplift),
    "a_scale": ("1", "scale of the ground acceleration", lambda s: s.a_scale),
    "gravity": ("m s-2", "acceleration of gravity", lambda s: s.gravity),
}
"""Of each structure: units, long name, value."""


def _edge(number: int, word: str, key: str) -> tuple[str, str, Callable[[RockingParameters], float]]:
    units, long_name, _ = PARAMETERS[key]
    name = {"lambda": "uplift"}.get(key, key)
    return units, f"{long_name} on the {word} edge", lambda s: float(getattr(s.sides[number], name)) if s.sides else np.nan


EDGE_PARAMETERS = {
    f"{word}_{key}": _edge(number, word, key)
    for number, word in enumerate(("left", "right"))
    for key in ("p", "alpha", "eta", "lambda", "a_scale")
}
"""The same of each edge of a body whose edges differ, NaN for others; in files that hold such a body."""


def parameters_of(structures: Sequence[RockingParameters]) -> dict[str, tuple[str, str, Callable[[RockingParameters], float]]]:
    """The parameters that a file of these structures holds."""
    return {**PARAMETERS, **EDGE_PARAMETERS} if any(s.sides for s in structures) else PARAMETERS


VARIABLES: dict[str, tuple[np.dtype, dict[str, Any]]] = {
    "theta_ratio": (
        np.dtype("<f8"),
        {"units": "1", "long_name": "largest rotation over critical angle", "_FillValue": np.nan,
         "comment": "max over time of abs(theta)/alpha; NaN where overturned or not computed"},
    ),
    "outcome": (
        np.dtype("u1"),
        {"units": "1", "long_name": "outcome", "flag_values": np.array([o.value for o in Outcome], dtype="u1"),
         "flag_meanings": " ".join(o.flag for o in Outcome)},
    ),
    "impacts": (np.dtype("<i4"), {"units": "1", "long_name": "impacts during shaking"}),
    "condition": (
        np.dtype("<f8"),
        {"units": "1", "long_name": "condition of the largest rotation", "_FillValue": np.nan,
         "comment": "sum of abs(d theta_ratio / d ln x) over the amplitude, the frequency and the restitution, by central differences; NaN "
                    "where overturned, failed or not computed, or where a cell beside it is"},
    ),
}  # fmt: skip
"""Of each cell: type and attributes. A file has the first two, and others on request."""

REQUIRED = ("theta_ratio", "outcome")

CHUNK_TABLES: dict[str, tuple[np.dtype, dict[str, Any]]] = {
    "chunk_done": (
        np.dtype("u1"),
        {"units": "1", "long_name": "whether this chunk's data are written",
         "flag_values": np.array([0, 1], dtype="u1"), "flag_meanings": "open done"},
    ),
    "chunk_checksum": (np.dtype("<u4"), {"units": "1", "long_name": "CRC-32 of this chunk's stored bytes"}),
    "chunk": (np.dtype("<i4"), {"units": "1", "long_name": "unit of work, row-major over the chunks of the data"}),
}  # fmt: skip
"""Of each chunk: type and attributes."""


def coordinates(structures: Sequence[RockingParameters], grid: Grid) -> dict[str, tuple[Any, np.dtype, dict[str, str]]]:
    """The dimensions of the variables, in their order: values, type, attributes."""
    names = ([s.name for s in structures], h5py.string_dtype(), {"long_name": "name of the structure", "units": "1"})
    axes = (grid.frequency, grid.amplitude)
    return {
        "structure": names,
        **{a.name: (a.values, np.dtype("<f8"), {"units": UNITS[a.name], "long_name": LONG_NAMES[a.name]}) for a in axes},
    }


def image(
    structures: Sequence[RockingParameters],
    grid: Grid,
    chunk: tuple[int, ...],
    names: Sequence[str],
    scene: Mapping[str, Any],
    attributes: Mapping[str, Any],
) -> bytes:
    """The bytes of a spectra file that has no chunk yet; names: of its variables, attributes: of its root."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        root = {"Conventions": "CF-1.11", "title": "Rocking spectra", "source": f"rocking {__version__}", "scene": json.dumps(scene)}
        for key, value in {**root, **attributes}.items():
            file.attrs[key] = _encodable(value)
        dimensions = coordinates(structures, grid)
        for name, (values, dtype, about) in dimensions.items():
            _describe(file.create_dataset(name, data=values, dtype=dtype), about)
        for name in dimensions:
            file[name].make_scale(name)
        for name, (units, long_name, get) in parameters_of(structures).items():
            data = file.create_dataset(name, data=np.array([get(s) for s in structures], dtype="<f8"))
            _describe(data, {"units": units, "long_name": long_name}, file["structure"])
        cut = ChunkGrid((len(structures), *grid.shape), (1, *chunk))
        for name in names:
            dtype, about = VARIABLES[name]
            data = file.create_dataset(
                name, cut.shape, dtype, chunks=cut.chunk, shuffle=dtype.itemsize > 1,
                compression="gzip", compression_opts=GZIP_LEVEL, fillvalue=about.get("_FillValue", 0),
            )  # fmt: skip
            _describe(data, about, *(file[dimension] for dimension in dimensions))
        for name, (dtype, _) in CHUNK_TABLES.items():
            values = np.arange(cut.size, dtype=dtype) if name == "chunk" else np.zeros(cut.size, dtype=dtype)
            file.create_dataset(name, data=values)
        file["chunk"].make_scale("chunk")
        for name, (_, about) in CHUNK_TABLES.items():
            _describe(file[name], about, *([] if name == "chunk" else [file["chunk"]]))
        file.attrs[DIGEST] = digest_of(file)
    return buffer.getvalue()


def _describe(data: h5py.Dataset, about: Mapping[str, Any], *scales: h5py.Dataset) -> None:
    for key, value in about.items():
        data.attrs[key] = np.array([value], dtype=data.dtype) if key == "_FillValue" else value
    for i, scale in enumerate(scales):
        data.dims[i].attach_scale(scale)


def _encodable(value: Any) -> Any:
    """Text that came from a command line may hold bytes that are no UTF-8, which HDF5 does not store."""
    return value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value

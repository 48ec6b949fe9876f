"""What a spectra file says of itself, checked before it is believed: its form, its digest, and its scene.

Nothing is read that the file does not itself hold, and no more than it holds.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np

from ..motions.grid import Axis
from ..structures.parameters import RockingParameters
from .chunks import GZIP_LEVEL, ChunkGrid
from .digest import DIGEST, digest_of, filters_of, plain
from .frame import ABOUT, EDGE_PARAMETERS, VARIED, Form, Frame, Values, beside_structures, form_among, varied_units
from .layout import CHUNK_TABLES, REQUIRED, VARIABLES

_FILTERS = {
    True: [(h5py.h5z.FILTER_SHUFFLE, 1), (h5py.h5z.FILTER_DEFLATE, 1)],
    False: [(h5py.h5z.FILTER_DEFLATE, 1)],
}  # (code, flags) by whether a number has several bytes; 1: a filter that the reader need not have


NAME_BYTES = 16  # of a text of any length in a dataset: its length, and where in the file it is


@dataclass(frozen=True, eq=False)
class Contents:
    """What a spectra file holds, beside its cells.

    names: of its variables; structures: none where the frame has alpha and T instead; cut: into which chunks; scene: what it was
    computed from; attributes: of the root; done: the chunks that are written; sums: their checksums.
    """

    names: tuple[str, ...]
    structures: tuple[RockingParameters, ...]
    frame: Frame
    cut: ChunkGrid
    scene: dict[str, Any]
    attributes: dict[str, Any]
    done: np.ndarray
    sums: np.ndarray


def reason(error: BaseException) -> str:
    """What a fault says, in words."""
    text = str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
    return text if " " in text else f"it has no {text!r}"


def contents_of(file: h5py.File, size: int) -> Contents:
    """Check a file of `size` bytes and read what it says of itself. Raises one of FAULTS, or UsageError."""
    form, datasets = _form(file, size)
    stated = file.attrs
    attributes = {key: plain(stated[key]) for key in stated}
    if DIGEST not in attributes:
        raise ValueError(f"it has no {DIGEST}")
    if attributes[DIGEST] != digest_of(attributes, datasets):
        raise ValueError("what it says of itself does not fit its digest")
    scene = json.loads(attributes["scene"])
    dimensions = {name: _values(datasets[name]) for name in form.dimensions}
    beside = {name: (dimension, _values(datasets[name])) for name, dimension in form.beside.items()}
    structures = tuple(_structures(dimensions, beside, scene)) if "structure" in form.dimensions else ()
    frame = Frame(dimensions, beside, varied_units(structures))
    for name, values in frame.dimensions.items():
        if isinstance(values, np.ndarray) and scene[f"axis {name}"] != Axis(name, values).stated():
            raise ValueError(f"its axis {name} is not that of its scene")
    _demand_the_records(frame, scene)
    names = tuple(name for name in VARIABLES if name in datasets)
    cut = ChunkGrid(datasets["outcome"].shape, datasets["outcome"].chunks)
    done, sums = datasets["chunk_done"][...] == 1, datasets["chunk_checksum"][...]
    return Contents(names, structures, frame, cut, scene, attributes, done, sums)


def chunk_places(file: h5py.File, contents: Contents, size: int) -> list[tuple[int, int]]:
    """(offset, length) in the file of every chunk that HDF5's index names.

    Raises ValueError where the index lacks a chunk that is marked done, or names one that is not a chunk of this file.
    """
    places: list[tuple[int, int]] = []
    for name in contents.names:
        there = np.zeros(contents.cut.size, dtype=bool)

        def visit(info: Any, there: np.ndarray = there, name: str = name) -> None:
            index = contents.cut.index(info.chunk_offset)
            if info.filter_mask or contents.cut.offset(index) != tuple(info.chunk_offset) or there[index]:
                raise ValueError(f"the chunk index of {name} is damaged at {tuple(info.chunk_offset)}")
            if info.byte_offset + info.size > size:
                raise ValueError(f"chunk {index} of {name} lies beyond the end of the file")
            there[index] = True
            places.append((info.byte_offset, info.size))

        file[name].id.chunk_iter(visit)
        if np.any(contents.done & ~there):
            raise ValueError(f"chunk {int(np.flatnonzero(contents.done & ~there)[0])} of {name} is marked done and is not there")
    return places


def _form(file: h5py.File, size: int) -> tuple[Form, dict[str, h5py.Dataset]]:
    """Demand the datasets of the layout, each as this program stores it, and open them: each time takes a tenth of a millisecond."""
    names = set(file)
    form = form_among(names)
    if "structure" in form.dimensions and names & set(EDGE_PARAMETERS):
        form = Form(form.dimensions, {**form.beside, **dict.fromkeys(EDGE_PARAMETERS, "structure")})
    varied = dict.fromkeys(sorted(name for name in names if name.startswith(VARIED)), "structure") if "structure" in form.dimensions else {}
    form = Form(form.dimensions, {**form.beside, **varied})
    lists = [*form.dimensions, *form.beside]
    required = {*lists, *CHUNK_TABLES, *REQUIRED}
    if missing := sorted(required - names):
        raise ValueError(f"it has no dataset {missing[0]!r}")
    if foreign := sorted(names - required - set(VARIABLES)):
        raise ValueError(f"its dataset {foreign[0]!r} is none of a spectra file")
    for name in sorted(names):
        if not isinstance(file.get(name, getlink=True), h5py.HardLink) or file.get(name, getclass=True) is not h5py.Dataset:
            raise ValueError(f"its {name} is not a dataset of its own")
    datasets = {name: file[name] for name in names}
    for name in lists:
        _demand(datasets[name], size, np.dtype("<f8") if name in varied else ABOUT[name].dtype)
    shape = tuple(datasets[name].size for name in form.dimensions)
    cut = None
    for name in (name for name in VARIABLES if name in names):
        chunk = _chunked(datasets[name], shape)
        if cut not in (None, chunk):
            raise ValueError("its variables are cut into different chunks")
        cut = chunk
    assert cut is not None
    for name, (dtype, _) in CHUNK_TABLES.items():
        _demand(datasets[name], size, dtype, ChunkGrid(shape, cut).size)
    for name, dimension in form.beside.items():
        if datasets[name].size != datasets[dimension].size:
            raise ValueError(f"it has not one {name} for each {dimension}")
    for attributes in (file.attrs, *(data.attrs for data in datasets.values())):
        if any(attributes.get_id(key).get_storage_size() > size for key in attributes):
            raise ValueError("an attribute is larger than the file")
    return form, datasets


def _values(data: h5py.Dataset) -> Values:
    """A list of numbers or of texts."""
    values = data[...]
    return [text.decode() for text in values] if data.dtype.hasobject else values


def _demand(data: h5py.Dataset, size: int, dtype: np.dtype | None, count: int | None = None) -> None:
    """A list of numbers, or of names (dtype None), that lies whole in this file of `size` bytes."""
    plist, name = data.id.get_create_plist(), data.name[1:]
    if plist.get_layout() != h5py.h5d.CONTIGUOUS or plist.get_external_count() or data.ndim != 1:
        raise ValueError(f"its {name} is not stored in one piece in the file itself")
    fits = h5py.check_string_dtype(data.dtype) is not None if dtype is None else data.dtype == dtype
    if not fits or (count is not None and data.size != count):
        raise ValueError(f"its {name} is of another type or size than a spectra file's")
    stored, begins = data.id.get_storage_size(), data.id.get_offset()
    if data.size < 1 or stored != data.size * (NAME_BYTES if dtype is None else dtype.itemsize) or begins is None or begins + stored > size:
        raise ValueError(f"its {name} is not all in the file")


def _chunked(data: h5py.Dataset, shape: tuple[int, ...]) -> tuple[int, ...]:
    """A variable over the axes, in chunks that are filtered as this program does; the shape of its chunks."""
    plist, name = data.id.get_create_plist(), data.name[1:]
    dtype = VARIABLES[name][0]
    if plist.get_layout() != h5py.h5d.CHUNKED or plist.get_external_count():
        raise ValueError(f"its {name} is not stored in chunks in the file itself")
    if data.dtype != dtype or data.shape != shape or data.maxshape != shape:
        raise ValueError(f"its {name} does not fit its axes")
    chunk: tuple[int, ...] = data.chunks
    if chunk[0] != 1 or any(c > n for c, n in zip(chunk, shape, strict=True)):
        raise ValueError(f"the chunks of its {name} do not fit its axes")
    filters = filters_of(data)
    if [f[:2] for f in filters] != _FILTERS[dtype.itemsize > 1] or filters[-1][2] != (GZIP_LEVEL,):
        raise ValueError(f"its {name} is not filtered as a spectra file's")
    return chunk


def _structures(
    dimensions: Mapping[str, Values], beside: Mapping[str, tuple[str, Values]], scene: dict[str, Any]
) -> Iterator[RockingParameters]:
    """The structures of the scene, whose parameters must be those of the file."""
    stated = [RockingParameters.from_record(record) for record in scene["structures"]]
    if dimensions["structure"] != [s.name for s in stated]:
        raise ValueError("its structures are not those of its scene")
    of_each = beside_structures(stated)
    if foreign := sorted(name for name in beside if name.startswith(VARIED) and name not in of_each):
        raise ValueError(f"its {foreign[0]} is not that of its scene")
    for key, (_, values) in of_each.items():
        if not np.array_equal(np.asarray(beside[key][1]), np.asarray(values), equal_nan=True):
            raise ValueError(f"its {key} is not that of its scene")
    yield from stated


def _demand_the_records(frame: Frame, scene: dict[str, Any]) -> None:
    """Raise ValueError where the records, or the restitutions of a spectrum over alpha, are not those of the scene."""
    if frame.of_records:
        stated = [[r[0], r[1], r[5]] for r in scene["records"]]
        there = (frame.dimensions["record"], frame.beside["sha256"][1], frame.beside["factor"][1])
        if stated != [[name, sha256, factor] for name, sha256, factor in zip(*there, strict=True)]:
            raise ValueError("its records are not those of its scene")
    if "alpha" in frame.dimensions and scene["eta"] != list(frame.beside["eta"][1]):
        raise ValueError("its eta is not that of its scene")

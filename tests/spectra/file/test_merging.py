"""Shards come together only where they say the same of the same scene."""

import json

import h5py
import pytest

from rocking_cli import (
    OutputError,
    SpectraFile,
    UsageError,
    dimensionless_oscillator,
    merge,
    parse_grid,
    sine,
    write_spectrum,
)
from rocking_cli.spectra.dimensions import VARIABLES
from rocking_cli.spectra.file import writer as store
from rocking_cli.spectra.file.layout import FileLayout, pack, unpack
from rocking_cli.spectra.file.writer import SpectraWriter

GRID = parse_grid("A=0.5:12:40,Omega=0.5:12:30")


def shard(path, part, **options):
    write_spectrum(
        [dimensionless_oscillator(eta=0.9)],
        sine(),
        GRID,
        path,
        workers=1,
        chunk_cells=200,
        shard=part,
        **options,
    )
    return path


def altered(path, index, change):
    """The same file with the cells of one chunk changed, as a faulty computation would
    have written it.
    """
    other = path.with_name("altered.h5")
    with SpectraFile(path) as f:
        attributes = {
            k: f.attributes[k]
            for k in ("history", "documents", "motion", "model", "shard")
        }
        with SpectraWriter(
            other,
            FileLayout(f.frame, f.chunk_grid.chunk[1:], f.names, f.scene, attributes),
        ) as writer:
            for i in (int(i) for i in f.done.nonzero()[0]):
                packed = f.packed(i)
                if i == index:
                    theta = unpack(
                        packed["theta_ratio"],
                        VARIABLES["theta_ratio"].dtype,
                        f.chunk_grid.chunk,
                    ).copy()
                    packed["theta_ratio"] = pack(change(theta))
                writer.write(f.chunk_grid.offset(i), packed)
            writer.finish({"cells": 1200})
    return other


def test_a_shard_counts_its_own_cells(tmp_path):
    options = {"workers": 1, "chunk_cells": 200, "check": 0}
    shards = [
        write_spectrum(
            [dimensionless_oscillator(eta=0.9)],
            sine(),
            GRID,
            tmp_path / f"{i}.h5",
            shard=(i, 2),
            **options,
        )
        for i in (1, 2)
    ]
    cells = shards[0].cells
    assert sum(s.outcomes["not_computed"] for s in shards) == cells
    assert all(
        sum(s.outcomes.values()) == cells > s.outcomes["not_computed"] > 0
        for s in shards
    )
    for s in shards:
        assert s.time_per_cell * (cells - s.outcomes["not_computed"]) == pytest.approx(
            s.run_time
        )


def test_shards_that_overlap_and_agree_are_one(tmp_path):
    whole = shard(tmp_path / "whole.h5", None)
    half = shard(tmp_path / "half.h5", (1, 2))
    merged = merge([half, whole], tmp_path / "m.h5")
    assert (merged.chunks, merged.all_chunks, merged.machine_differences) == (6, 6, "")
    with SpectraFile(tmp_path / "m.h5") as one, SpectraFile(whole) as other:
        for name in ("error_bound", "error_bound_median", "cells_above_ten_medians"):
            assert one.attributes[name] == other.attributes[name] > 0
        assert one.digest
        assert one.complete
        assert all(one.packed(i) == other.packed(i) for i in range(6))


def test_shards_that_overlap_and_disagree_are_refused(tmp_path):
    whole = shard(tmp_path / "whole.h5", None)
    same = altered(whole, 2, lambda theta: theta).rename(tmp_path / "same.h5")
    assert merge([whole, same], tmp_path / "m.h5").chunks == 6
    other = altered(whole, 2, lambda theta: theta + 1e-15)
    with pytest.raises(
        OutputError,
        match=r"altered\.h5 and .*whole\.h5 disagree: chunk 2 of theta_ratio differs",
    ):
        merge([whole, other], tmp_path / "n.h5")
    assert not list(tmp_path.glob("n.h5*"))


def test_a_damaged_chunk_is_taken_from_the_file_where_it_is_whole(tmp_path):
    paths = [shard(tmp_path / f"{i}.h5", None) for i in range(2)]
    for i, path in enumerate(paths):
        with h5py.File(path) as file:
            at = file["theta_ratio"].id.get_chunk_info(i + 1).byte_offset + 30
        data = bytearray(path.read_bytes())
        data[at] ^= 16
        path.write_bytes(data)
    assert merge(paths, tmp_path / "m.h5").chunks == 6
    with SpectraFile(tmp_path / "m.h5") as file:
        assert file.damaged_chunks() == []
    with pytest.raises(OutputError, match=r"0\.h5: chunk 1 is damaged"):
        merge(paths[:1], tmp_path / "n.h5")
    assert not list(tmp_path.glob("n.h5*"))


def test_shards_of_other_machines_are_told_and_refused_if_strict(tmp_path, monkeypatch):
    first = shard(tmp_path / "1.h5", (1, 2))
    monkeypatch.setattr(store, "machine", lambda: {"numpy": "1.0"})
    second = shard(tmp_path / "2.h5", (2, 2))
    with pytest.raises(
        UsageError, match=r"machines that compute differently .*numpy .* and 1\.0"
    ):
        merge([first, second], tmp_path / "m.h5", strict=True)
    assert not list(tmp_path.glob("m.h5*"))
    assert "and 1.0" in merge([first, second], tmp_path / "m.h5").machine_differences
    with SpectraFile(tmp_path / "m.h5") as file:
        assert [m["numpy"] for m in json.loads(file.attributes["computed_on"])][
            1
        ] == "1.0"

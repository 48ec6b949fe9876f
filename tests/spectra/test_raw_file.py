"""A file as HDF5 sees it: with the end that a killed writer did not come to state, and with space behind it."""

from __future__ import annotations

import os

from rocking_cli.spectra.raw_file import SIGNATURE, RawFile


def test_a_raw_file_shows_the_larger_of_two_ends(tmp_path):
    path = tmp_path / "x"
    head = SIGNATURE + b"\0\0\0\0\0\x08\x08" + bytes(17) + b"\xff" * 8
    for stated in (60, 200):
        path.write_bytes(head[:40] + stated.to_bytes(8, "little") + b"d" * 52)
        raw = RawFile(os.open(path, os.O_RDWR))
        assert raw.seek(0, os.SEEK_END) == max(100, stated)
        raw.seek(0)
        shown = raw.read(300)
        assert shown[40:48] == max(100, stated).to_bytes(8, "little")
        assert shown[48:] == b"d" * 52 + bytes(max(100, stated) - 100)
        raw.seek(42)
        assert raw.read(3) == shown[42:45]
        raw.trim()
        assert path.stat().st_size == 100


def test_what_is_reserved_and_not_written_is_given_back(tmp_path):
    raw = RawFile(os.open(tmp_path / "x", os.O_RDWR | os.O_CREAT))
    raw.write(b"abc")
    raw.reserve(5000)
    assert (tmp_path / "x").stat().st_size == 5003
    raw.write(b"d")
    raw.trim()
    assert (tmp_path / "x").read_bytes() == b"abcd"

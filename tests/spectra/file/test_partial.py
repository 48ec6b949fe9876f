"""A partial file belongs to one process, replaces nothing of others, and loses no more than what is damaged."""

from __future__ import annotations

import fcntl
import io
import os
import random

import h5py
import pytest

from rocking_cli import OutputError, UsageError
from rocking_cli.spectra.file.log import NOTE, Log
from rocking_cli.spectra.file.partial import Partial, check_output
from rocking_cli.spectra.sweep_options import SweepOptions


def _image() -> bytes:
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file["x"] = range(100)
    return buffer.getvalue()


IMAGE = _image()
CONTENTS = [bytes([i]) * (50 + i) for i in range(5)]


def names(folder):
    return sorted(p.name for p in folder.iterdir())


@pytest.fixture
def output(tmp_path):
    return tmp_path / "s.h5"


_begun: list[Partial] = []


@pytest.fixture(autouse=True)
def closed():
    """What a test leaves open is closed behind it."""
    yield
    while _begun:
        _begun.pop().file.close()


def begun(output, overwrite=False, resume=False):
    _begun.append(Partial(output, IMAGE, overwrite=overwrite, resume=resume))
    return _begun[-1]


@pytest.fixture
def left(output):
    """A partial file of five chunks, as a process that is gone leaves it."""
    partial = begun(output)
    for i, content in enumerate(CONTENTS):
        partial.log.append(i, content)
    partial.file.close()
    return partial.path


@pytest.mark.parametrize("options", [(False, False), (True, False), (False, True)])
def test_a_partial_file_in_use_is_another_process_s_and_stays_as_it_is(output, options):
    first = begun(output)
    before = first.path.read_bytes()
    with pytest.raises(OutputError, match=r"s\.h5\.part: is in use by another process$"):
        begun(output, *options)
    assert first.path.read_bytes() == before
    first.remove()
    first.file.close()
    assert names(output.parent) == []


def test_a_partial_file_that_is_left_says_what_goes_on(output, left):
    with pytest.raises(UsageError, match="`resume` goes on with it, `overwrite` begins anew"):
        check_output(output, overwrite=False)
    again = begun(output, resume=True)
    assert again.resumes
    assert [again.log.content(i) for i in range(5)] == CONTENTS
    again.file.close()
    anew = begun(output, overwrite=True)
    assert not anew.resumes
    assert list(anew.log.places) == [NOTE]


def test_only_the_file_that_was_opened_is_removed(output):
    first = begun(output)
    first.path.unlink()
    second = begun(output)
    first.discard()
    assert names(output.parent) == ["s.h5.part"]
    second.discard()
    assert names(output.parent) == []


def test_what_no_sweep_left_is_not_taken_over(output, tmp_path):
    """Neither a foreign file nor a link, whatever is asked for."""
    part = tmp_path / "s.h5.part"
    part.write_text("precious")
    for options in ({"resume": True}, {"overwrite": True}):
        with pytest.raises(UsageError, match="is no partial file of this program; move it away"):
            begun(output, **options)
    part.rename(tmp_path / "victim")
    part.symlink_to("victim")
    with pytest.raises(UsageError, match="is a link, but a partial file must have this name"):
        begun(output, overwrite=True)
    assert (tmp_path / "victim").read_text() == "precious"


def test_a_layout_that_was_never_whole_is_begun_anew(output):
    """Its signature is written last; a kill before leaves zeros."""
    for content in (b"", bytes(100), bytes(8) + IMAGE[8:]):
        (output.parent / "s.h5.part").write_bytes(content)
        partial = begun(output, resume=True)
        assert not partial.resumes
        partial.discard()
        partial.file.close()
    assert names(output.parent) == []


def test_a_layout_of_an_earlier_version_is_no_sweep_that_can_go_on(output):
    (output.parent / "s.h5.part").write_bytes(IMAGE)
    with pytest.raises(OutputError, match=r"is not a sweep that can go on \(it has neither a digest nor .*\); it is kept"):
        begun(output, resume=True)
    begun(output, overwrite=True).discard()


def test_a_damaged_record_is_the_only_one_that_is_lost(left):
    """Every bit of the file, in turn: the layout is refused, a chunk says so, and what is read is what was written."""
    data, chance, damaged = left.read_bytes(), random.Random(2), 0
    for _ in range(400):
        at = chance.randrange(len(data))
        flipped = bytearray(data)
        flipped[at] ^= 1 << chance.randrange(8)
        left.write_bytes(flipped)
        with open(left, "rb") as file:
            try:
                records = Log(file)
            except ValueError:
                damaged += at < len(IMAGE)
                continue
            assert records.image == IMAGE
            for index in records.places.keys() - {NOTE}:
                try:
                    assert records.content(index) == CONTENTS[index]
                except ValueError:
                    damaged += 1
    assert damaged > 300


def test_a_cut_file_holds_the_records_before_the_cut(left):
    data = left.read_bytes()
    with open(left, "rb") as file:
        ends = [sum(Log(file).places[i]) for i in range(5)]
    for length in range(ends[0], len(data), 7):
        left.write_bytes(data[:length])
        with open(left, "rb") as file:
            assert sorted(Log(file).places.keys() - {NOTE}) == [i for i in range(5) if ends[i] <= length]


def test_names_of_other_formats_are_refused(tmp_path):
    with pytest.raises(UsageError, match=r"the output is HDF5; found the ending \.csv"):
        check_output(tmp_path / "s.csv", overwrite=False)
    with pytest.raises(UsageError, match="`resume` does not go with `overwrite`"):
        SweepOptions(overwrite=True, resume=True)


def test_without_locks_a_sweep_goes_on_all_the_same(output, monkeypatch):
    def no_locks(*_):
        raise OSError(37, os.strerror(37))

    monkeypatch.setattr(fcntl, "flock", no_locks)
    partial = begun(output)
    partial.log.append(0, CONTENTS[0])
    partial.file.close()
    assert begun(output, resume=True).log.content(0) == CONTENTS[0]

"""The part of an output belongs to one process, replaces nothing but regular files, and leaves nothing half-made."""

from __future__ import annotations

import errno
import fcntl
import os

import pytest

from rocking_cli import OutputError, UsageError
from rocking_cli.spectra.part import Part, check_output
from rocking_cli.spectra.raw_file import SIGNATURE

IMAGE = SIGNATURE + bytes(range(256)) * 8


def names(folder):
    return sorted(p.name for p in folder.iterdir())


@pytest.fixture
def output(tmp_path):
    return tmp_path / "s.h5"


def begun(output, overwrite=False, resume=False):
    return Part(output, IMAGE, overwrite=overwrite, resume=resume)


@pytest.fixture(params=["O_TMPFILE", "no O_TMPFILE"], autouse=True)
def creation(request, monkeypatch):
    """The part is made where it is not seen, or under its name where the system cannot do that."""
    if request.param != "O_TMPFILE":
        monkeypatch.delattr(os, "O_TMPFILE", raising=False)


@pytest.mark.parametrize("options", [(False, False), (True, False), (False, True)])
def test_a_part_in_use_is_another_process_s_and_stays_as_it_is(output, options):
    first = begun(output)
    with pytest.raises(OutputError, match=r"s\.h5\.part: is in use by another process$"):
        begun(output, *options)
    assert first.in_place()
    assert first.part.read_bytes() == IMAGE
    first.publish()
    first.close()
    assert output.read_bytes() == IMAGE
    assert names(output.parent) == ["s.h5"]


def test_a_locked_part_is_in_use_before_anything_else_is_said_of_it(output):
    first = begun(output)
    with pytest.raises(OutputError, match="in use by another process") as refusal:
        check_output(output, overwrite=False)
    assert "`overwrite`" not in str(refusal.value)
    first.close()
    with pytest.raises(UsageError, match="`resume` goes on with it, `overwrite` begins anew"):
        check_output(output, overwrite=False)


def test_only_the_part_that_was_opened_is_published(output):
    first = begun(output)
    first.part.unlink()
    second = begun(output)
    with pytest.raises(OutputError, match="has vanished meanwhile, or is another's"):
        first.publish()
    first.discard()
    assert second.in_place()
    assert names(output.parent) == ["s.h5.part"]
    second.publish()
    assert names(output.parent) == ["s.h5"]


def test_an_output_that_appears_meanwhile_is_kept(output):
    part = begun(output)
    output.write_text("mine")
    with pytest.raises(OutputError, match=r"has appeared meanwhile; the result is kept as .*s\.h5\.part"):
        part.publish()
    assert output.read_text() == "mine"
    assert part.part.read_bytes() == IMAGE


def test_without_hard_links_the_part_is_renamed_and_replaces_nothing(output, monkeypatch):
    def no_links(*_, **__):
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", no_links)
    begun(output).publish()
    assert names(output.parent) == ["s.h5"]
    again = begun(output.with_name("t.h5"))
    again.output.write_text("mine")
    with pytest.raises(OutputError, match="cannot be written"):
        again.publish()
    assert again.output.read_text() == "mine"


@pytest.mark.parametrize(
    ("make", "what"), [(os.mkfifo, "a pipe"), (os.mkdir, "a folder"), (lambda p: os.symlink("nowhere", p), "a link that leads nowhere")]
)
def test_only_regular_files_are_replaced(output, make, what):
    make(output)
    with pytest.raises(UsageError, match=f"is {what}, accepted is the name of a file"):
        check_output(output, overwrite=True)
    part = output.with_name("t.h5.part")
    make(part)
    with pytest.raises(UsageError, match="where a sweep would keep what is done"):
        check_output(output.with_name("t.h5"), overwrite=True)


def test_devices_and_impossible_names_are_refused(output, tmp_path):
    from pathlib import Path

    with pytest.raises(UsageError, match="/dev/full: is a device"):
        check_output(Path("/dev/full"), overwrite=True)
    for length in (253, 300):
        with pytest.raises(UsageError, match="File name too long"):
            check_output(tmp_path / ("x" * length), overwrite=True)


def test_a_link_to_a_file_stays_and_the_file_is_replaced(output):
    target = output.with_name("target.h5")
    target.write_text("old")
    output.symlink_to(target.name)
    part = begun(output, overwrite=True)
    part.publish()
    part.close()
    assert output.is_symlink()
    assert target.read_bytes() == IMAGE
    assert names(output.parent) == ["s.h5", "target.h5"]


def test_a_full_disk_at_the_beginning_leaves_nothing(output, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(OutputError, match=r"s\.h5\.part: cannot be written: No space left on device$"):
        begun(output)
    assert names(output.parent) == []


def test_a_part_without_its_signature_is_not_begun(output):
    """A kill while the layout is written leaves a part without signature; anything else is somebody's data."""
    left = output.with_name("s.h5.part")
    for content, wanted in ((b"", False), (bytes(100), False), (IMAGE, True), (b"half", True), (bytes(5000), True)):
        left.write_bytes(content)
        part = begun(output, resume=True)
        assert part.resumes is wanted
        part.close()
        assert left.read_bytes() == (content if wanted else IMAGE)


def test_a_second_name_of_a_finished_file_is_no_part(output):
    """A kill between the link to the final name and the removal of the part's leaves two names of one file."""
    first = begun(output)
    first.publish()
    first.close()
    os.link(output, output.with_name("s.h5.part"))
    part = begun(output, overwrite=True)
    part.discard()
    assert output.read_bytes() == IMAGE
    assert names(output.parent) == ["s.h5"]


def test_where_there_are_no_locks_the_user_has_to_say_so(output, monkeypatch):
    def no_locks(*_):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", no_locks)
    monkeypatch.delenv("HDF5_USE_FILE_LOCKING", raising=False)
    with pytest.raises(OutputError, match=r"offers no locks \(No locks available\).*HDF5_USE_FILE_LOCKING=FALSE"):
        begun(output)
    assert names(output.parent) == []
    monkeypatch.setenv("HDF5_USE_FILE_LOCKING", "FALSE")
    begun(output).publish()
    assert names(output.parent) == ["s.h5"]

"""Files that are written are whole, replace nothing unasked, and
leave nothing behind.
"""

import errno
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import IO
from unittest.mock import Mock

import pytest

from rocking_cli import OutputError, UsageError, publishing
from rocking_cli.publishing import check_target, published


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def write(target: Path, content: bytes, overwrite: bool = False) -> None:
    with published(target, overwrite) as file:
        file.write(content)


def test_a_file_that_appears_meanwhile_is_kept(tmp_path):
    target = tmp_path / "o.svg"
    with (
        pytest.raises(
            OutputError, match=r"o\.svg: has appeared meanwhile; use `overwrite`"
        ),
        published(target, overwrite=False),
    ):
        target.write_bytes(b"theirs")
    assert target.read_bytes() == b"theirs"
    assert names(tmp_path) == ["o.svg"]
    write(target, b"mine", overwrite=True)
    assert target.read_bytes() == b"mine"


@pytest.mark.parametrize("links", [True, False], ids=["links", "no links"])
def test_one_of_many_writers_has_the_name(tmp_path, monkeypatch, links):
    if not links:
        monkeypatch.setattr(
            os,
            "link",
            Mock(side_effect=OSError(errno.EPERM, "Operation not permitted")),
        )
    target = tmp_path / "o.svg"

    def one(number: int) -> int | None:
        try:
            write(target, b"%d" % number)
        except OutputError:
            return None
        return number

    with ThreadPoolExecutor(16) as pool:
        winners = [n for n in pool.map(one, range(16)) if n is not None]
    assert len(winners) == 1
    assert target.read_bytes() == b"%d" % winners[0]
    assert names(tmp_path) == ["o.svg"]


def test_the_partial_file_is_a_new_one(tmp_path):
    """Neither a link nor a file of another is taken for it, whatever
    they are called.
    """
    victim = tmp_path / "victim"
    victim.write_bytes(b"precious")
    (tmp_path / "s.png.part").symlink_to("victim")
    with published(tmp_path / "s.png", overwrite=False) as file:
        (partial,) = (
            p
            for p in tmp_path.iterdir()
            if p.name.startswith("s.png.") and p.name != "s.png.part"
        )
        assert os.path.samestat(os.fstat(file.fileno()), partial.stat())
        file.write(b"figure")
    assert victim.read_bytes() == b"precious"
    assert names(tmp_path) == ["s.png", "s.png.part", "victim"]


def test_a_link_to_a_file_stays_and_the_file_is_replaced(tmp_path):
    (tmp_path / "target.svg").write_bytes(b"old")
    (tmp_path / "o.svg").symlink_to("target.svg")
    write(tmp_path / "o.svg", b"new", overwrite=True)
    assert (tmp_path / "o.svg").is_symlink()
    assert (tmp_path / "target.svg").read_bytes() == b"new"


def test_a_full_disk_names_the_file_and_leaves_nothing(tmp_path):
    """A limit on the length of files is what the system offers; a figure is longer."""
    call = (
        f"ulimit -f 1; PYTHONDONTWRITEBYTECODE=1 exec {sys.executable} -m rocking_cli"
        " draw block:0.5x2 -o o.svg"
    )
    done = subprocess.run(
        ["bash", "-c", call],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (done.returncode, done.stderr) == (
        1,
        "rocking: o.svg: cannot be written: File too large\n",
    )
    assert names(tmp_path) == []


def test_what_stops_the_writing_leaves_nothing(tmp_path):
    for error in (
        KeyboardInterrupt,
        OSError(errno.ENOSPC, "No space left on device"),
        ValueError,
    ):
        expected = OutputError if isinstance(error, OSError) else error
        with pytest.raises(expected), published(tmp_path / "o.svg", overwrite=False):
            raise error
    assert names(tmp_path) == []
    with pytest.raises(
        OutputError, match=r"nowhere/o\.svg: cannot be written: No such file"
    ):
        write(tmp_path / "nowhere" / "o.svg", b"")


@pytest.mark.parametrize(
    ("stream", "words"),
    [
        ("/dev/stdout", "is a standard stream of this call"),
        ("-", "is not the name of a file"),
    ],
)
def test_standard_streams_are_no_file(tmp_path, stream, words):
    code = (
        "from rocking_cli.publishing import check_target; from pathlib import Path;"
        f" check_target(Path({stream!r}), True)"
    )
    with open(tmp_path / "out", "wb") as out:
        done = subprocess.run(
            [sys.executable, "-c", code],
            stdout=out,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert words in done.stderr
    assert (tmp_path / "out").read_bytes() == b""


def test_what_cannot_be_written_is_refused_before_the_work(tmp_path):
    (tmp_path / "folder.svg").mkdir()
    os.mkfifo(tmp_path / "pipe.svg")
    (tmp_path / "lost.svg").symlink_to("nowhere")
    (tmp_path / "there.svg").write_bytes(b"")
    for name, words in (
        ("folder.svg", "is a folder; expected the name of a file"),
        ("pipe.svg", "is a pipe; expected"),
        ("lost.svg", "is a link that leads nowhere; expected"),
        ("there.svg", "exists; use `overwrite` to replace it"),
        ("nowhere/x.svg", "the folder .*nowhere does not exist"),
        ("x" * 250 + ".svg", "File name too long"),
        ("x.jpg", r"expected a name that ends in \.png or \.svg"),
    ):
        with pytest.raises(UsageError, match=words):
            check_target(tmp_path / name, False, (".png", ".svg"))
    with pytest.raises(UsageError, match="is a device; expected"):
        check_target(Path("/dev/full"), overwrite=True)


def test_what_the_system_forbids_is_found_by_trying_it(tmp_path, monkeypatch):
    """Windows calls every folder writable, and does not replace a file in use; the
    administrator may write everywhere, so the test refuses in the system's place.
    """
    taken = tmp_path / "taken.svg"
    taken.write_text("theirs")

    def refusing(refused: str) -> None:
        def one(path: Path, mode: str) -> IO[bytes]:
            if mode == refused:
                raise PermissionError(errno.EACCES, "Permission denied")
            return open(path, mode)

        monkeypatch.setattr(publishing, "open", one, raising=False)

    refusing("r+b")
    check_target(taken, overwrite=True)
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(UsageError, match=r"taken\.svg: cannot be written: Permission"):
        check_target(taken, overwrite=True)
    refusing("xb")
    with pytest.raises(UsageError, match=r"x\.svg: cannot be written: Permission"):
        check_target(tmp_path / "x.svg", overwrite=False)
    assert names(tmp_path) == ["taken.svg"]

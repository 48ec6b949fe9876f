"""The standard streams: readers who go, devices that are full or closed, encodings,
control characters, names that are none.
"""

import io
import json
import os
import subprocess
import sys

import h5py
import pytest
from support.soak import quick

from rocking_cli.commands import streams

PROGRAM = f"{sys.executable} -m rocking_cli"
SWEEP = "spectrum --eta 0.9 --grid A=1:2:3,Omega=1:2:3"


def shell(line: str, folder) -> subprocess.CompletedProcess[str]:
    line = f"set -o pipefail; {line.replace('rocking', PROGRAM)}"
    return subprocess.run(
        ["bash", "-c", line],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Säule α ≤ 3°, 石", "Säule α ≤ 3°, 石"),
        ("\x1b[31mred\x07\n\x9b31m\x7f", r"\x1b[31mred\x07\n\x9b31m\x7f"),
        ("right \u202e to left \u2028", r"right \u202e to left \u2028"),
        ("not UTF-8: \udcff", r"not UTF-8: \udcff"),
    ],
)
def test_only_visible_characters_reach_a_terminal(text, shown, capsys):
    with streams.guarded():
        streams.put(text)
        streams.say(text)
    assert capsys.readouterr() == (f"{shown}\n", f"{shown}\n")


@pytest.mark.parametrize(
    ("encoding", "shown"),
    [("latin-1", "ä\\u03b2"), ("ascii", "\\xe4\\u03b2"), ("utf-8", "äβ")],
)
def test_what_the_encoding_lacks_is_escaped(encoding, shown, monkeypatch):
    raw = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw, encoding=encoding))
    monkeypatch.setenv("PYTHONIOENCODING", encoding)
    with streams.guarded():
        streams.put("äβ")
    assert raw.getvalue().decode(encoding) == f"{shown}\n"


def test_output_that_no_terminal_shows_is_utf_8_with_the_line_ends_of_the_system(
    monkeypatch,
):
    raw = io.BytesIO()
    western = io.TextIOWrapper(raw, encoding="cp1252", newline="\r\n")  # of Windows
    monkeypatch.setattr(sys, "stdout", western)
    monkeypatch.delenv("PYTHONIOENCODING", raising=False)
    with streams.guarded():
        streams.put("äβ", "b")
    assert raw.getvalue().decode() == "äβ\r\nb\r\n"


def test_json_is_json_in_ascii(tmp_path):
    (tmp_path / "b.yaml").write_text(
        'kind: block\nname: "Säule β \U0001f5fc"\nwidth: 1\nheight: 5\n',
        encoding="utf-8",
    )
    env = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(
        [*PROGRAM.split(), "params", "b.yaml", "--json"],
        cwd=tmp_path,
        env=env,
        capture_output=True,
        check=True,
    )
    assert json.loads(done.stdout.decode("ascii"))["name"] == "Säule β \U0001f5fc"


MORE = [
    pytest.param(call, marks=pytest.mark.soak)
    for call in ("--version", "params b.yaml", "info s.h5", "plot s.h5 --text")
]


@pytest.mark.slow
@pytest.mark.parametrize("call", ["--help", "convert s.h5", *MORE])
def test_every_output_ends_alike(call, tmp_path, spectrum_file):
    (tmp_path / "b.yaml").write_text("kind: block\nwidth: 1\nheight: 5\n")
    (tmp_path / "s.h5").symlink_to(spectrum_file)
    gone = shell(
        f"(sleep 0.3; rocking {call}) | true", tmp_path
    )  # the reader is gone before the first line
    assert (gone.returncode, gone.stderr) == (0, "")
    full = shell(f"rocking {call} > /dev/full", tmp_path)
    assert (full.returncode, full.stderr) == (
        1,
        "rocking: standard output: cannot be written: No space left on device\n",
    )
    closed = shell(f"rocking {call} >&-", tmp_path)
    assert (closed.returncode, closed.stderr) == (
        1,
        "rocking: standard output: cannot be written: it is closed\n",
    )


@pytest.mark.parametrize(
    "closing", quick(["2>/dev/full", "2>&-", "<&- >&- 2>&-"], "<&- >&- 2>&-")
)
def test_standard_error_may_fail_and_closed_descriptors_do_not_end_up_in_the_file(
    rocking, tmp_path, closing
):
    """Without care the file would be opened as descriptor 2, and what a library says
    there be written into it.
    """
    assert shell(f"rocking {SWEEP} -o s.h5 {closing}", tmp_path).returncode == 0
    told = rocking("info", "--verify", "s.h5", "--json").record
    assert (told["complete"], told["damaged_chunks"]) == ("yes", 0)


def test_names_that_are_not_utf_8_or_too_long(rocking, tmp_path):
    done = shell(f"rocking {SWEEP} -q -o $'\\xff.h5'", tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert rocking("info", "--json", "\udcff.h5").record["file"] == "\udcff.h5"
    with h5py.File(tmp_path / "\udcff.h5") as file:
        assert r"\udcff.h5" in file.attrs["history"]
    for call in (f"{SWEEP} -o", "params", "info", "merge s.h5 -o"):
        done = rocking(*call.split(), "x" * 300)
        assert done.returncode in (1, 2)
        assert done.stderr.startswith("rocking")
        assert len(done.stderr.splitlines()) == 1


def test_a_message_is_one_line_whatever_it_quotes(refused):
    assert (
        refused(2, "params", "--\x1b[31mx\ny")
        == "rocking params: No such option --\\x1b[31mx\\ny (see --help)\n"
    )


def test_more_workers_than_cpus_are_reduced_with_a_line(rocking, monkeypatch):
    monkeypatch.setattr("rocking_cli.processes.available_cpus", lambda: 1)
    sweep = (*SWEEP.split(), "--overwrite", "-o", "s.h5", "--workers")
    said = "--workers 64: reduced to 1, the number of available CPUs\n"
    assert rocking(*sweep, "64", "--notes").stderr.startswith(said)
    assert said not in rocking(*sweep, "1", "--notes").stderr
    assert rocking(*sweep, "64", "-q").stderr == ""

"""Installed packages that add to the program: each fault is one sentence that names the
package.
"""

import pytest
from support.packages import installed as install

from rocking_cli import UsageError
from rocking_cli.errors import RockingError
from rocking_cli.plugins import blamed, installed

SILENT = """
class Silent(Exception):
    def __str__(self):
        raise RuntimeError

def silent():
    raise Silent

def long():
    raise ValueError("one line\\nanother line")

def empty():
    raise RecursionError

class Abort(BaseException):
    pass

def abort():
    raise Abort("no licence")

def told():
    from rocking_cli import MotionError
    raise MotionError("gabor: cycles is 0")
"""


@pytest.mark.parametrize(
    ("attribute", "words"),
    [
        (
            "silent",
            "odd, which the package of-odd adds and which cannot be used: Silent",
        ),
        ("long", "ValueError: one line another line"),
        ("empty", "RecursionError"),
        ("abort", "Abort: no licence"),
        ("nothing", "AttributeError: module 'rocking_odd' has no attribute 'nothing'"),
        ("told", "gabor: cycles is 0"),
    ],
)
def test_a_fault_of_a_package_is_one_line(monkeypatch, tmp_path, attribute, words):
    install(monkeypatch, tmp_path, "rocking.odd", "odd", SILENT, attribute)
    entry = installed("rocking.odd")["odd"]
    with pytest.raises(RockingError) as told, blamed(entry, RockingError):
        entry.load()()
    assert str(told.value).endswith(words)
    assert "\n" not in str(told.value)


def test_a_name_that_two_packages_add_is_told(monkeypatch, tmp_path, rocking):
    install(monkeypatch, tmp_path, "rocking.pulses", "odd", SILENT, "long")
    install(monkeypatch, tmp_path, "rocking.pulses", "two", SILENT, "long")
    (listed,) = tmp_path.glob("site-two/*.dist-info/entry_points.txt")
    listed.write_text("[rocking.pulses]\nodd = rocking_two:long\n")
    done = rocking("check", "block:0.5x2", "--pulse", "odd")
    both = "the package of-two and the package of-odd both add odd to rocking.pulses"
    assert (done.returncode, done.stderr) == (
        2,
        f"rocking: {both}; expected only one of them\n",
    )


@pytest.mark.parametrize(
    "call",
    ["check block:0.5x2 --pulse odd --a-g 0.3g --f-g 1", "params odd:1x2"],
)
def test_a_list_of_entry_points_that_cannot_be_read_is_told(
    monkeypatch, tmp_path, rocking, call
):
    install(monkeypatch, tmp_path, "rocking.pulses", "odd", SILENT)
    (listed,) = tmp_path.glob("site-odd/*.dist-info/entry_points.txt")
    listed.write_text("[rocking.pulses]\nodd\n")
    with pytest.raises(UsageError, match=r"^the package of-odd: its entry_points.txt"):
        installed("rocking.pulses")
    done = rocking(*call.split())
    assert (done.returncode, done.stdout) == (2, "")
    assert "the package of-odd: its entry_points.txt cannot be read" in done.stderr


def test_whatever_a_kind_of_a_package_raises_is_told(monkeypatch, tmp_path, rocking):
    source = "class Abort(BaseException):\n    pass\n\nraise Abort('no licence')\n"
    install(monkeypatch, tmp_path, "rocking.structures", "odd", source)
    done = rocking("params", "{kind: odd, width: 1}")
    assert (done.returncode, done.stdout) == (3, "")
    assert "found odd, which the package of-odd adds" in done.stderr
    assert "Abort: no licence" in done.stderr
    assert rocking("params", "odd:1x2").returncode in (2, 3)

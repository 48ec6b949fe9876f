"""What the README shows runs, and prints what it shows."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from readme_help import blocks, section

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", README, re.DOTALL) for line in block.splitlines() if line]


def shell(rocking, line: str, folder: Path) -> str:
    """What a line of the README prints, pipes into `rocking` and `head` and redirections included; it must succeed."""
    line, _, target = line.partition(" > ")
    said, out = "", ""
    for stage in line.split(" | "):
        name, *arguments = shlex.split(stage)
        if name == "head":
            assert arguments[0] == "-n"
            out = "".join(out.splitlines(keepends=True)[: int(arguments[1])])
            continue
        assert name == "rocking", stage
        done = rocking(*arguments, stdin=out)
        assert done.returncode == 0, f"{stage}\n{done.stderr}"
        out, said = done.stdout, said + done.stderr
    if target:
        (folder / target).write_text(out)
    assert out or said or ".png" in line, line
    return out


def test_every_command_runs_in_order(rocking, tmp_path):
    for line in COMMANDS:
        shell(rocking, line, tmp_path)


def test_the_result_shown_is_the_result_printed(rocking, tmp_path):
    shown = re.search(r"```\n(structure .*?)```", README, re.DOTALL)
    assert shown is not None
    assert shell(rocking, COMMANDS[0], tmp_path) == shown[1]


def test_the_python_example_runs(tmp_path, monkeypatch, capsys):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    monkeypatch.chdir(tmp_path)
    example = re.search(r"```python\n(.*?)```", README, re.DOTALL)
    assert example is not None
    exec(compile(example[1], "README.md", "exec"), {"__name__": "__main__"})
    assert "p = 2.672 rad/s" in capsys.readouterr().out


def test_the_help_shown_is_the_help_printed():
    assert section(README) == blocks(), "python tests/readme_help.py writes the blocks anew"


def test_every_command_and_kind_is_documented():
    from rocking_cli.commands import COMMANDS as commands
    from rocking_cli.structures import KINDS

    for name in commands:
        assert f"rocking {name}" in README
    for kind in KINDS:
        assert f"| {kind} |" in README
        assert (ROOT / "configs" / f"{kind}.yaml").exists()

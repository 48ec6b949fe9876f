"""What the README shows runs, and prints what it shows."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

from readme_help import blocks, section

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", README, re.DOTALL) for line in block.splitlines() if line]


def shell(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    program = f"{shlex.quote(sys.executable)} -m rocking_cli"
    line = re.sub(r"(^|\| )rocking ", rf"\1{program} ", line)
    return subprocess.run(["bash", "-o", "pipefail", "-c", line], cwd=folder, capture_output=True, text=True, timeout=120, check=False)


def test_every_command_runs_in_order(tmp_path):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    for line in COMMANDS:
        done = shell(line, tmp_path)
        assert done.returncode == 0, f"{line}\n{done.stderr}"
        assert done.stdout or done.stderr or ".png" in line, line


def test_the_result_shown_is_the_result_printed(tmp_path):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    shown = re.search(r"```\n(structure .*?)```", README, re.DOTALL)
    assert shown is not None
    assert shell(COMMANDS[0], tmp_path).stdout == shown[1]


def test_the_python_example_runs(tmp_path):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    example = re.search(r"```python\n(.*?)```", README, re.DOTALL)
    assert example is not None
    done = subprocess.run([sys.executable, "-c", example[1]], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "p = 2.672 rad/s" in done.stdout


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

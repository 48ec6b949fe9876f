"""The help blocks of the README: `python tests/readme_help.py` writes them anew, a test compares them."""

from __future__ import annotations

import contextlib
import io
import os
import re
from pathlib import Path
from unittest import mock

README = Path(__file__).resolve().parent.parent / "README.md"
START, END = "<!-- help -->\n", "<!-- /help -->"


def blocks() -> str:
    """`rocking COMMAND --help` of every command, as Markdown."""
    from rocking_cli.commands import COMMANDS, cli

    found = []
    for name in COMMANDS:
        with mock.patch.dict(os.environ, COLUMNS="100"), contextlib.redirect_stdout(io.StringIO()) as shown:
            cli.main([name, "--help"], prog_name="rocking", standalone_mode=False)
        found.append(f"```text\n{shown.getvalue().rstrip()}\n```\n")
    return "\n".join(found)


def section(text: str) -> str:
    """What the README holds between its marks."""
    found = re.search(f"{START}(.*?){END}", text, re.DOTALL)
    assert found is not None
    return found[1]


if __name__ == "__main__":
    before = README.read_text(encoding="utf-8")
    README.write_text(before.replace(f"{START}{section(before)}{END}", f"{START}{blocks()}{END}"), encoding="utf-8")

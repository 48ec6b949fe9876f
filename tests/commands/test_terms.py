"""The library speaks of arguments, the commands of their options."""

import ast
import re
from pathlib import Path

import click
import pytest

from rocking_cli.commands import cli
from rocking_cli.commands.printing import in_options

PACKAGE = Path(__file__).resolve().parents[2] / "rocking_cli"


@pytest.mark.parametrize(
    ("command", "text", "said"),
    [
        ("spectrum", "`grid` a_g: found 1", "--grid a_g: found 1"),
        (
            "spectrum",
            "fewer `workers` or a smaller `chunk_cells`",
            "fewer --workers or a smaller --chunk",
        ),
        (
            "response",
            "`scale_to`: found x; `motion_dt` and `dt`",
            "--scale-to: found x; --motion-dt and --row-step",
        ),
        (
            "info",
            "it is kept for `resume`; `a b` and ``",
            "it is kept for `resume`; `a b` and ``",
        ),
    ],
)
def test_arguments_become_the_options_of_the_command(command, text, said):
    found = cli.get_command(click.Context(cli), command)
    assert found is not None
    assert in_options(text, found) == said


def test_no_sentence_of_the_library_names_an_option():
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if path.parent.name == "commands" or not re.search(r"--[a-z]", text):
            continue
        tree = ast.parse(text)
        explained = {
            id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)
        }
        said = [
            n.value
            for n in ast.walk(tree)
            if isinstance(n, ast.Constant)
            and isinstance(n.value, str)
            and id(n) not in explained
        ]
        assert [text for text in said if re.search(r"--[a-z]", text)] == [], path

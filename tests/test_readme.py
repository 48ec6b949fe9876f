"""What the README shows runs, and prints what it shows."""

import re

from bench.speed import in_readme
from support.shown_commands import README, ROOT, written

TEXT = README.read_text(encoding="utf-8")
ANEW = "python tests/support/shown_commands.py writes it anew"


def test_every_command_runs_in_order_and_prints_what_is_shown(rocking, tmp_path):
    assert written(TEXT, rocking, tmp_path) == TEXT, ANEW


def test_the_table_of_speed_is_what_was_measured():
    assert in_readme(TEXT) == TEXT, ANEW


def test_the_python_example_runs(tmp_path, monkeypatch, capsys):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    monkeypatch.chdir(tmp_path)
    example = re.search(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert example is not None
    exec(compile(example[1], "README.md", "exec"), {"__name__": "__main__"})
    assert "p = 2.672 rad/s" in capsys.readouterr().out


def test_every_command_is_named():
    from rocking_cli.commands import COMMANDS

    for name in COMMANDS:
        assert f"`rocking {name}" in TEXT, f"no row of {name} in README.md"


def test_every_topic_it_points_to_is_there():
    from rocking_cli.commands import COMMANDS
    from rocking_cli.commands.help import TOPICS

    assert set(re.findall(r"rocking help ([a-z]+)", TEXT)) <= {*COMMANDS, *TOPICS}

"""`rocking help`: every command and topic has its reference, and what a page shows
runs.
"""

import doctest
import re
import shlex

import click
import pytest
from support.shown_commands import SHOWN, page_written, shell

from rocking_cli.commands import COMMANDS, cli, shipped_cases
from rocking_cli.commands.help import TOPICS, page

PAGES = [name for name in (*COMMANDS, *TOPICS) if page(name)]
# those that show what a command prints
SHOWING = [name for name in PAGES if any(x[1] for x in SHOWN.findall(page(name)))]


def test_all_are_listed(rocking):
    done = rocking("help")
    assert done.returncode == 0
    for name, summary in (COMMANDS | TOPICS).items():
        assert re.search(rf"^  {name} +{summary[:40]}", done.stdout, re.MULTILINE), name
    for topic in TOPICS:
        assert rocking("help", topic).stdout == page(topic) != ""


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_has_its_options_and_then_its_page(rocking, command):
    done = rocking("help", command)
    options = rocking(command, "--help-all").stdout
    assert done.stdout.startswith(options.rstrip())
    assert done.stdout.endswith(page(command))
    found = cli.get_command(click.Context(cli), command)
    assert found is not None
    for parameter in found.params:
        if isinstance(parameter, click.Option):
            assert parameter.opts[-1] in done.stdout
            assert parameter.help, f"{parameter.opts[-1]} says nothing"


def test_the_options_of_a_file_stand_once_beside_it(rocking):
    text = rocking("check", "--help").stdout
    assert "--motion FILE[,unit=g,column=2,dt=0.01,skip=5,component=NS]" in text
    assert "--unit " not in text
    assert "Column of a table of numbers" in rocking("records", "--help-all").stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_shows_what_a_command_needs_and_names_the_way_to_all(rocking, command):
    few, every = (rocking(command, asked).stdout for asked in ("--help", "--help-all"))
    _, _, few = few.partition("\nOptions:\n")
    few = few.partition("\n\n  Example:")[0]
    options = re.findall(r"^  (-\S*)", few, re.MULTILINE)
    assert "--help-all" in few
    assert len(options) <= 13, options
    assert len(every) >= len(few)


def test_words_are_searched_in_all_pages(rocking):
    found = rocking("help", "--search", "critical ANGLE").stdout.splitlines()
    assert found
    assert all("critical" in x.lower() and "angle" in x.lower() for x in found)
    named = rocking("help", "--search", "--scale-to").stdout
    assert re.search(r"^check +--scale-to IM=VALUE", named, re.MULTILINE)
    for words in (["no such word here"], ["a", "motions"], [" "]):
        done = rocking("help", "--search", *words)
        assert (done.returncode, done.stdout) == (2, "")
        assert "--search" in done.stderr


def example(rocking, command):
    """The lines of the example that the help of a command shows."""
    text = " ".join(rocking(command, "--help").stdout.split())
    return text.partition("Example: ")[2].partition(" | jq")[0].split(" && ")


SHORTER = [
    (r"(:[\d.]+[A-Za-z]*:)([4-9]|\d\d+)\b", r"\g<1>3"),  # three values of a grid
    (r"--duration 2 ", "--duration 0.2 "),
    (r"--f-g 0\.5:5", "--f-g 0.5:0.6"),
    (r"--draws \d+", "--draws 8"),
    (r"rocking fragility (?!.*--bootstrap)", "rocking fragility --bootstrap 20 "),
    (
        r"(rocking (check|envelope) (?!.*--(a-max|verdict-only|closed-form)).*)",
        r"\1 --a-max 2",
    ),
    (  # whose searches are short
        r"rocking (check|solve|report) (?!.*--(pulse|motion|cycles|fail-on))",
        r"rocking \1 --pulse rectangular ",
    ),
]


def shortened(line):
    """The same command with less to compute."""
    for found, put in SHORTER:
        line = " | ".join(re.sub(found, put, stage) for stage in line.split(" | "))
    return line


@pytest.fixture
def two_cases(monkeypatch):
    """`rocking verify` with two of its cases; each runs in a test of its own."""
    few = shipped_cases.shipped_cases()[:2]
    monkeypatch.setattr(shipped_cases, "shipped_cases", lambda: few)


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn", "two_cases")
@pytest.mark.parametrize(
    ("name", "count"),
    [
        pytest.param(name, count, marks=marks)
        for name in dict.fromkeys((*COMMANDS, *PAGES))
        for count, marks in ((1, ()), (None, pytest.mark.soak))
        if count is None or name not in SHOWING
    ],
)
def test_examples_and_pages_run_in_order_anywhere(rocking, tmp_path, name, count):
    """In an empty folder, where `configs` is found in the package, and shortened."""
    (tmp_path / "configs").unlink()
    shown = example(rocking, name) if name in COMMANDS else []
    shown += re.findall(r"^    (rocking .*)$", page(name), re.MULTILINE)
    for line in list(dict.fromkeys(shown))[:count]:
        shell(rocking, shortened(line), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWING)
def test_a_page_shows_what_its_first_example_prints(rocking, tmp_path, name):
    anew = "python tests/support/shown_commands.py writes it anew"
    assert page_written(page(name), rocking, tmp_path) == page(name), anew


@pytest.mark.parametrize("name", PAGES)
def test_every_option_that_a_page_shows_is_there(name):
    """Most of its commands run in the soak alone."""
    for line in re.findall(r"^    (rocking .*)$", page(name), re.MULTILINE):
        for stage in line.partition(" > ")[0].split(" | "):
            program, command, *arguments = shlex.split(stage)
            if program == "head":
                continue
            assert program == "rocking"
            found = cli.get_command(click.Context(cli), command)
            assert found is not None
            found.make_context(command, arguments)


@pytest.mark.parametrize("name", PAGES)
def test_a_page_fits_a_terminal_and_points_to_what_is_there(name):
    prose = [
        line for line in page(name).splitlines() if not line.startswith("    rocking ")
    ]
    indent = 6  # of an output
    wide = [x for x in prose if len(x) > (100 if x.startswith(" " * indent) else 80)]
    assert not wide, f"lines of more than 80 characters in {name}.txt: {wide}"
    assert (
        set(re.findall(r"`rocking help ([a-z]+)`", page(name)))
        <= COMMANDS.keys() | TOPICS.keys()
    )


@pytest.mark.slow
def test_the_examples_of_the_page_on_python_run(tmp_path, monkeypatch, pytestconfig):
    (tmp_path / "configs").symlink_to(pytestconfig.rootpath / "configs")
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestParser().get_doctest(
        page("python"), {}, "rocking help python", None, None
    )
    assert len(examples.examples) > 5
    said: list[str] = []
    done = doctest.DocTestRunner().run(examples, out=said.append)
    assert not done.failed, "".join(said)

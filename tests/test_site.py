"""What the documentation site shows is what the tests run: examples of docstrings, and
commands of the help pages.
"""

import doctest
import importlib.util
import re

import pytest
from support.shown_commands import ROOT

import rocking_cli

spec = importlib.util.spec_from_file_location("site_of_docs", ROOT / ".ci" / "site.py")
site = importlib.util.module_from_spec(spec)
spec.loader.exec_module(site)


def sources(text):
    """The lines of code of a text's examples."""
    return [one.source for one in doctest.DocTestParser().get_examples(text)]


@pytest.mark.parametrize("name", site.TUTORIALS)
def test_a_tutorial_holds_examples_of_docstrings_and_their_imports(name):
    imported, others = [], []
    for line in sources(site.tutorial(name)):
        (imported if line.startswith("from rocking import") else others).append(line)
    tested = {
        line
        for public in site.PUBLIC
        for line in sources(getattr(rocking_cli, public).__doc__ or "")
    }
    assert len(imported) >= 2
    assert set(others) <= tested
    for line in imported:
        assert set(re.findall(r"\w+", line)[3:]) <= set(site.PUBLIC)


def test_a_figure_has_the_commands_that_write_what_it_reads():
    found = list(site.figures())
    assert len(found) >= 10
    for _, commands, drawn in found:
        read = re.findall(r"(\S+\.(?:csv|h5))\b", commands[-1].partition(" > ")[0])
        made = " ".join(commands[:-1])
        assert commands[-1].endswith(drawn)
        for file in read:
            assert file.startswith("configs/") or re.search(rf"(-o|>) {file}", made)


def test_a_command_is_folded_and_stays_the_same():
    line = (
        "rocking plot a.csv --over base_radius/height " + "--xlim 0:2 " * 8 + "-o a.png"
    )
    folded = site.folded(line)
    assert max(map(len, folded.splitlines())) <= 72
    assert re.sub(r" \\\n +", " ", folded) == line

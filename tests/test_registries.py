"""A word of a registry stands wherever people look for it: the README, the help pages,
the shipped documents, the schema, the options. A sentence says what is missing.
"""

import json
import re
from importlib import import_module
from inspect import signature

import click
import pytest
from support.shown_commands import README, ROOT

from rocking_cli.commands import cli
from rocking_cli.commands.ground import OF_A_PULSE
from rocking_cli.commands.help import page
from rocking_cli.documents.quantities import UNITS
from rocking_cli.motions.intensity_measures import MEASURES
from rocking_cli.motions.pulses import PULSES
from rocking_cli.motions.records import FORMATS
from rocking_cli.structures import build_structure, read_documents
from rocking_cli.structures.kinds import KINDS, known_keys, sizes_of

TEXT = README.read_text(encoding="utf-8")
PAGES = "rocking_cli/commands/pages"
SCHEMA = ROOT / "rocking_cli" / "structures" / "schema.json"


def in_one_line(text):
    """A text with one blank between two words."""
    return " ".join(text.split())


@pytest.mark.parametrize("name", FORMATS)
def test_a_record_format(name):
    module = import_module(f"rocking_cli.motions.records.{name}")
    listed = in_one_line(page("records")).casefold()
    for form in getattr(module, "FORMATS", (module,)):
        assert form.NAME.casefold() in listed, f"no {form.NAME} in {PAGES}/records.txt"
        assert not form.recognise("kind: block\n"), f"{form.NAME} takes a document"
        assert not form.recognise("0.1 0.2\n0.3 0.4\n"), (
            f"{form.NAME} takes any numbers"
        )


@pytest.mark.parametrize("pulse", PULSES)
def test_a_pulse(pulse):
    line = re.search(rf"^  {pulse}  ", page("motions"), re.MULTILINE)
    assert line, f"no line of {pulse} in {PAGES}/motions.txt"
    for parameter in signature(PULSES[pulse]).parameters:
        known = parameter in OF_A_PULSE
        assert known, (
            f"no field {parameter} in Source of rocking_cli/commands/ground.py"
        )


@pytest.mark.parametrize("measure", MEASURES.values(), ids=list(MEASURES))
def test_an_intensity_measure(measure):
    ways = (measure.of_motion, measure.of_structure, measure.of_record)
    assert sum(way is not None for way in ways) == 1, f"{measure.name} has not one way"
    assert measure.dimension in UNITS, f"{measure.name}: DIMENSION is no word of UNITS"
    of_fragility = cli.get_command(click.Context(cli), "fragility")
    told = re.search(rf"Measures:.*\b{measure.name}\b", in_one_line(of_fragility.help))
    assert told, (
        f"no {measure.name} among the measures of rocking_cli/commands/fragility.py"
    )
    if measure.of_structure is None:
        told = re.search(
            rf"\([^)]*\b{measure.name}\b.*\) by --scale-to", page("motions")
        )
        assert told, (
            f"no {measure.name} among those of --scale-to in {PAGES}/motions.txt"
        )


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind(kind):
    place = ROOT / "configs" / f"{kind}.yaml"
    assert place.exists(), f"no commented document configs/{kind}.yaml"
    row = re.search(rf"^\| .*\b{kind}\b.* \| ", TEXT, re.MULTILINE)
    assert row, f"no row of {kind} in the table of kinds of README.md"
    line = re.search(rf"^  {kind}  ", page("documents"), re.MULTILINE)
    assert line, f"no line of {kind} in {PAGES}/documents.txt"
    named = kind in json.loads(SCHEMA.read_text(encoding="utf-8"))["definitions"]
    assert named, f"no {kind} in {SCHEMA.name}: `make schema` writes it"
    if sizes := sizes_of(kind):
        form = rf"\b{kind}\b[^:;]*: {' x '.join(sizes)}\b"
        told = re.search(form, in_one_line(page("documents")))
        assert told, f"no `{kind}: {' x '.join(sizes)}` in {PAGES}/documents.txt"
    module = import_module(f"rocking_cli.structures.kinds.{KINDS[kind]}")
    assert isinstance(module.REPORTS, tuple), f"{kind}: REPORTS is no tuple of keys"


def test_every_key_of_a_kind_is_in_the_schema():
    """A key that is missing there would be a label in a row of another kind."""
    asked = {}
    for path in sorted((ROOT / "configs").glob("*.yaml")):
        for document in read_documents(path):
            build_structure(document)
            asked |= dict.fromkeys(document.asked, path.name)
    missing = {key: name for key, name in asked.items() if key not in known_keys()}
    assert not missing, f"schema.json lacks keys of these files: {missing}; make schema"

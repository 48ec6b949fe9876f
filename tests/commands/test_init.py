"""`rocking init`: documents to begin with, and the schema for editors."""

import json

import pytest

from rocking_cli.commands.init import SCHEMA
from rocking_cli.structures import KINDS
from rocking_cli.structures.templates import TEMPLATES


@pytest.mark.parametrize("kind", TEMPLATES)
def test_it_prints_a_commented_document_that_is_valid(rocking, kind):
    done = rocking("init", kind)
    assert (done.returncode, done.stderr) == (0, "")
    first, second, *_ = done.stdout.splitlines()
    assert first == f"# yaml-language-server: $schema={SCHEMA}"
    assert second.startswith("# ")
    assert kind in rocking("init", "--help").stdout
    record = rocking("params", "-", "--json", stdin=done.stdout).record
    assert record["structure_kind"] == kind.partition("_between")[0]


def test_it_prints_the_schema_of_every_kind(rocking):
    schema = json.loads(rocking("init", "--schema").stdout)
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    assert set(KINDS) <= schema["definitions"].keys()


def test_a_kind_or_the_schema_is_needed_and_not_both(rocking):
    for arguments in ([], ["block", "--schema"], ["blok"]):
        done = rocking("init", *arguments)
        assert (done.returncode, done.stdout) == (2, "")
        assert len(done.stderr.splitlines()) == 1

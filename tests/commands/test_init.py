"""`rocking init`: documents to begin with."""

import pytest

from rocking_cli.structures.templates import TEMPLATES


@pytest.mark.parametrize("kind", TEMPLATES)
def test_it_prints_a_commented_document_that_is_valid(rocking, kind):
    done = rocking("init", kind)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("# ")
    assert kind in rocking("init", "--help").stdout
    record = rocking("params", "-", "--json", stdin=done.stdout).record
    assert record["structure_kind"] == kind.partition("_between")[0]

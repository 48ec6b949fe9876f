"""A word of a registry stands wherever people look for it: the README, the help pages,
the shipped documents, the schema, the options. Sentences say what is missing.
"""

import re
from importlib import import_module
from inspect import signature

import click
import pytest
from support.packages import installed
from support.record_layouts import at2, wave
from support.shown_commands import README, ROOT

from rocking_cli.commands import cli
from rocking_cli.commands.ground import OF_A_PULSE
from rocking_cli.commands.help import page
from rocking_cli.documents.quantities import UNITS, si_unit
from rocking_cli.motions.intensity_measures import MEASURES, Measure, measure_of
from rocking_cli.motions.pulses import PULSES
from rocking_cli.motions.records import FORMATS
from rocking_cli.reports.units import Units, dimension_of_measure
from rocking_cli.structures.kinds import KINDS, keys_of, sizes_of

PAGES = "rocking_cli/commands/pages"


def in_one_line(text):
    """A text with one blank between two words."""
    return " ".join(text.split())


def require(found):
    """Fail with each sentence whose condition does not hold, one on a line."""
    missing = [sentence for sentence, holds in found.items() if not holds]
    assert not missing, "\n" + "\n".join(missing)


@pytest.mark.parametrize("pulse", PULSES)
def test_a_pulse(pulse):
    line = re.search(rf"^  {pulse}  ", page("motions"), re.MULTILINE)
    options = {
        f"no field {one} in Source of rocking_cli/commands/ground.py": one in OF_A_PULSE
        for one in signature(PULSES[pulse]).parameters
    }
    require({f"no line of {pulse} in {PAGES}/motions.txt": line, **options})


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind(kind):
    rows = re.findall(r"^\| .* \| ", README.read_text(encoding="utf-8"), re.MULTILINE)
    reported = import_module(f"rocking_cli.structures.kinds.{KINDS[kind]}").REPORTS
    text = page("documents")
    form = f"{kind}: {' x '.join(sizes_of(kind) or ())}"
    # `block, point_mass: width x height`
    told = re.search(form.replace(":", "[^:;]*:"), in_one_line(text))
    require(
        {
            f"REPORTS of {kind} is no tuple of keys": isinstance(reported, tuple),
            f"no document configs/{kind}.yaml": (
                ROOT / "configs" / f"{kind}.yaml"
            ).exists(),
            f"no row of {kind} in the table of kinds of README.md": any(
                re.search(rf"\b{kind}\b", row) for row in rows
            ),
            f"no `{form}` in {PAGES}/documents.txt": told or not sizes_of(kind),
            f"no KEYS of {kind}": keys_of(kind).all,
        }
    )


@pytest.mark.parametrize("name", FORMATS)
def test_a_record_format(name):
    module = import_module(f"rocking_cli.motions.records.{name}")
    listed = in_one_line(page("records")).casefold()
    for form in getattr(module, "FORMATS", (module,)):
        takes = [
            form.recognise(text) for text in ("kind: block\n", "0.1 0.2\n0.3 0.4\n")
        ]
        require(
            {
                f"no {form.NAME} in {PAGES}/records.txt": form.NAME.casefold()
                in listed,
                f"{form.NAME} takes a structure document for a record": not takes[0],
                f"{form.NAME} takes any numbers for its own": not takes[1],
            }
        )


def of_a_package(monkeypatch, tmp_path, dimension):
    """The name of a measure that an installed package adds, of this dimension."""
    source = f"""
DIMENSION = {dimension!r}

def value(record):
    return float(abs(record.acceleration).max())
"""
    installed(monkeypatch, tmp_path, "rocking.measures", "ours", source)
    return "ours"


@pytest.mark.parametrize("dimension", UNITS)
def test_a_table_shows_the_unit_of_every_measure(monkeypatch, tmp_path, dimension):
    name = of_a_package(monkeypatch, tmp_path, dimension)
    held = [x for x in MEASURES.values() if x.dimension == dimension]
    for measure in (*held, measure_of(name)):
        units = Units(dimensions={"median": dimension_of_measure(measure.name)})
        assert units.column("median") == ("median", si_unit(dimension), 1.0)


def test_fragility_and_records_show_a_measure_with_its_unit(
    rocking, monkeypatch, tmp_path
):
    """`rocking fragility` also one of an installed package, `rocking records` those of
    the registry."""
    name = of_a_package(monkeypatch, tmp_path, "time")
    for i in range(5):
        record = at2(wave(20, 0.2), dt=0.09 + 0.03 * i)
        (tmp_path / f"{i}.at2").write_text(record)
    call = ("fragility", "block:0.5x2", "--motion", ".", "--bootstrap", "0")
    done = rocking(*call, "--levels", "2s:20s:4", "--im", name, "--model", "linear")
    assert "median [s]" in done.stdout, done.stderr

    total = Measure("total", "time", of_record=lambda record: record.duration)
    monkeypatch.setitem(MEASURES, "total", total)
    done = rocking("records", "configs/motions/synthetic.at2", "--csv")
    (row,) = done.rows
    assert row["total"] == row["duration"]
    done = rocking("records", "configs/motions/synthetic.at2")
    assert re.search(r"\btotal \[s\]", done.stdout)


@pytest.mark.parametrize("measure", MEASURES.values(), ids=list(MEASURES))
def test_an_intensity_measure(measure):
    of_fragility = in_one_line(cli.get_command(click.Context(cli), "fragility").help)
    of_motions = in_one_line(page("motions"))
    listed = re.search(r"\(([^()]|\([^()]*\))*\) by --scale-to", of_motions)
    word = rf"\b{measure.name}\b"
    require(
        {
            f"{measure.name}: no dimension {measure.dimension!r} in UNITS of"
            " rocking_cli/documents/quantities.py": (measure.dimension in UNITS),
            f"no {measure.name} in the docstring of commands/fragility.py": re.search(
                word, of_fragility.partition("Measures:")[2]
            ),
            f"no {measure.name} among those of --scale-to in {PAGES}/motions.txt": (
                measure.of_structure or re.search(word, listed[0])
            ),
        }
    )

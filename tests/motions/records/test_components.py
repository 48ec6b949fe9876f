"""Which components of a file are vertical, and which of them a call takes."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import of_a_station, wave

from rocking_cli.errors import UsageError
from rocking_cli.motions.records import Record, read_record, read_records
from rocking_cli.motions.records.record import chosen, is_vertical, vertical_of


def record(component, form="COSMOS"):
    return Record("a", form, component, 0.01, np.array([0.0, 1.0]), None, "g", "a", "0")


@pytest.mark.parametrize(
    "name", ["Up", "UP", "U-D", "UD", "Vert", "VERTICAL", "Down", "DN", "HNZ", "HGZ", "Z", "U", "V", "Up (3)", "Up - roof"]
)
def test_vertical(name):
    assert is_vertical(record(name))


@pytest.mark.parametrize("name", [None, "N-S", "E-W", "N28W", "360 Deg", "90 Deg", "HNN", "HN1", "1", "3", "S00E", "L", "T", "channel (3)"])
def test_not_vertical(name):
    assert not is_vertical(record(name))


def test_vertical_by_the_number_of_kik_net():
    assert [is_vertical(record(name, "K-NET")) for name in "123456"] == [False, False, True, False, False, True]


@pytest.fixture
def station(tmp_path):
    (tmp_path / "a").write_text(of_a_station(wave(50, 200.0), wave(50, 150.0), wave(50, 90.0)))
    return tmp_path / "a"


@pytest.mark.parametrize(
    ("component", "names"),
    [
        (None, ["N-S", "E-W"]), ("horizontal", ["N-S", "E-W"]), ("ALL", ["N-S", "E-W", "U-D"]), ("u-d", ["U-D"]), ("2", ["E-W"]),
    ],
)  # fmt: skip
def test_what_a_set_takes_of_a_file(station, component, names):
    assert [r.component for r in chosen(read_records(station), component)] == names


def test_one_is_not_taken_for_another(station):
    with pytest.raises(UsageError, match=r"a: component: found 'NS'; expected N-S, E-W, U-D, horizontal and all"):
        chosen(read_records(station), "NS")
    for several in (None, "horizontal", "all"):
        with pytest.raises(UsageError, match="holds the components N-S, E-W"):
            read_record(station, component=several)
    assert vertical_of(read_records(station)).component == "U-D"
    with pytest.raises(UsageError, match="holds no vertical component, only N-S, E-W"):
        vertical_of(read_records(station)[:2])


def test_of_an_array_nothing_is_taken_unless_it_is_asked_for():
    array = [record(f"{angle} Deg") for angle in (0, 90, 180, 270)]
    with pytest.raises(UsageError, match="a: holds the components 0 Deg, 90 Deg, 180 Deg, 270 Deg; give one as component, or horizontal"):
        chosen(array, None)
    assert chosen(array, "horizontal") == array

"""The direction of a component, by one rule for headings, headers and file names."""

import pytest
from support.record_layouts import at2, wave

from rocking_cli.errors import UsageError
from rocking_cli.motions.reading import read_motions
from rocking_cli.motions.records import read_record
from rocking_cli.motions.records.directions import direction_of, up_in_name

NAMES = {
    "up": "Up|UP|U-D|UD|u/d|Vert|VERTICAL|HNZ|HGZ|Z|U|V|Up (3)|Up - roof|V2|BHZ00|VRT"
    "|UP COMPONENT|+V|+Z|XX.ABC..HNZ|UD1|Z (3)|vertikal|dusey|V (corrected)|Comp. V"
    "|Vertical, 2nd floor|上下",
    "down": "Down|DN|dwn|D|-V|-Z|-Up",
    "across": "N-S|E-W|n/s|N_S|N28W|S10W|360 Deg|90 Deg|90 Deg (1)|0 Deg|340 deg|090"
    "|HNN|HN1|HN2|S00E|N 20 E|L|T|L1|T3|HNE|BHE00|X|north|TRAN|LONG|H1|XX.UPZA..HN1"
    "|WE|南北|-N|90 deg roof",
    "unknown": "1|3|channel (3)|Othr|?|Unkn|HN3|ch2|foo|Sensor 12|UPLAND|V20E"
    "|N wing|-||5 m",
}
CASES = [(name, words) for words, names in NAMES.items() for name in names.split("|")]


@pytest.mark.parametrize(("name", "direction"), CASES)
def test_a_name_states_a_direction_or_none(name, direction):
    assert direction_of(name) == direction


UP = "S1_Z.AT2|a/quake_UD.txt|ELC-UP.AT2|S1.ud|S1.UD1|TCU068-V.AT2|rec_v2_z.csv|UP.txt"
NONE = (
    "motion.v2|x.V2|a.V1|S1_E.AT2|rec_v.txt|rec_V2.txt|stop.txt|backup.csv|set_u.csv|up"
)


def test_the_last_part_of_a_file_name_may_be_vertical():
    for name in (*UP.split("|"), *(f"{x}.gz" for x in UP.split("|"))):
        assert up_in_name(name) is not None, name
    assert not any(map(up_in_name, NONE.split("|")))


def test_a_file_that_is_vertical_by_its_name_is_no_horizontal_motion(tmp_path):
    for name in ("S_E", "S_N", "S_Z"):
        (tmp_path / f"{name}.AT2").write_text(at2(wave(50, 0.1)))
    told: list[str] = []
    found = read_motions([str(tmp_path)], tell=told.append)
    assert [r.label for r in found] == ["S_E", "S_N"]
    assert "S_Z.AT2: holds Z and no horizontal component; left out" in told[0]


def test_an_unknown_direction_is_told_and_taken_by_its_name_alone(tmp_path):
    path = tmp_path / "a.csv"
    text = "\n".join(f"{0.01 * i:.2f},{x:.5f}" for i, x in enumerate(wave(50)))
    path.write_text(f"t [s],HN3 [g]\n{text}\n")
    assert "component HN3: no direction is known" in read_record(path).remarks[0]
    told: list[str] = []
    with pytest.raises(UsageError, match="no record among the files"):
        read_motions([str(path)], tell=told.append)
    assert "a.csv: HN3: no direction is known, which of HN3 is vertical" in told[0]
    assert len(read_motions([str(path)], component="HN3")) == 1

"""The guard that looks at the numbers of a record, in any format."""

import numpy as np
import pytest
from support.record_layouts import at2, of_a_station, refusal, wave

from rocking_cli.errors import DocumentError
from rocking_cli.motions.reading import read_motions
from rocking_cli.motions.records import read_record

SAMPLES = wave(500, 0.3)  # g
STRONG = -wave(500, 1.05) * np.sign(SAMPLES[np.argmax(np.abs(SAMPLES))])
UNLIKE = {
    "a magnitude": (np.abs(SAMPLES), "no sample below zero"),
    "of the other sign": (-np.abs(SAMPLES), "no sample above zero"),
    "a Husid curve": (np.cumsum(SAMPLES**2), "no sample below zero"),
    "gravity": (SAMPLES + 1.0, "no sample below zero"),
    "a strong motion with gravity": (STRONG + 1.0, "% of the peak, as of a sensor"),
    "times": (0.01 * np.arange(500) - 2.5, "rise evenly, as times do"),
    "downwards": (-STRONG - 1.0, "% of the peak, as of a sensor"),
}


@pytest.mark.parametrize(("samples", "words"), UNLIKE.values(), ids=UNLIKE)
def test_numbers_that_are_no_ground_motion_are_refused_or_taken_as_they_stand(
    tmp_path, samples, words
):
    path = tmp_path / "a"
    for text, given in (
        (at2(samples), {}),
        ("".join(f"{x:.7f}\n" for x in samples), {"unit": "g", "dt": 0.01}),
    ):
        said = refusal(path, text, **given)
        assert words in said
        assert said.endswith("about zero, or `as_it_stands`")
        record = read_record(path, as_it_stands=True, **given)
        assert words in "".join(record.remarks)
        np.testing.assert_allclose(record.acceleration, 9.81 * samples, atol=1e-5)


def test_one_component_that_is_refused_does_not_keep_the_others(tmp_path):
    (tmp_path / "a").write_text(
        of_a_station(*(k * wave(200, 100.0) for k in (1.0, 0.5)), wave(200) + 981.0)
    )
    (north, east) = read_motions([str(tmp_path / "a")])
    assert (north.record.component, east.record.component) == ("N-S", "E-W")
    with pytest.raises(DocumentError, match="a: component U-D: found no sample below"):
        read_motions([str(tmp_path / "a")], vertical=1.0)
    assert read_motions([str(tmp_path / "a")], vertical=1.0, as_it_stands=True)
    assert read_record(tmp_path / "a", component="U-D", as_it_stands=True).npts == 200


@pytest.mark.parametrize(
    ("samples", "dt", "told"),
    [
        (SAMPLES, 0.01, []),
        (SAMPLES, 0.99, []),
        (SAMPLES, 1.0, ["a time step of 1 s, which is unusually long"]),
        (9.9 * SAMPLES, 0.01, []),
        (10.1 * SAMPLES, 0.01, ["a PGA of 3.03 g, where the unit is taken to be g"]),
        (0.0 * SAMPLES, 0.01, []),
    ],
)
def test_what_is_unusual_is_told(tmp_path, samples, dt, told):
    (tmp_path / "a").write_text(at2(samples, dt))
    assert list(read_record(tmp_path / "a").remarks) == told


@pytest.mark.parametrize(("share", "said"), [(0.04, False), (0.06, True), (0.45, True)])
def test_a_mean_beyond_a_share_of_the_peak_is_told(tmp_path, share, said):
    even = SAMPLES - SAMPLES.mean()
    peak = float(even.max())  # with the mean m added the peak is peak + m
    (tmp_path / "a").write_text(at2(even + share / (1.0 - share) * peak))
    (*told,) = read_record(tmp_path / "a").remarks
    assert bool(told) == said
    assert not told or f"{100.0 * share:.2g} % of the peak" in told[0]

"""The motion of a file: documents and records told apart, scaled, and turned over."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import wave

from rocking_cli.errors import DocumentError, UsageError
from rocking_cli.motions import pulse
from rocking_cli.motions.intensity import intensity
from rocking_cli.motions.polyline import Polyline
from rocking_cli.motions.reading import factor_to, read_motion
from rocking_cli.motions.records import read_record

SAMPLES = wave(400, -2.5)


@pytest.fixture
def plain(tmp_path):
    path = tmp_path / "plain.txt"
    path.write_text("".join(f"{x!r}\n" for x in SAMPLES.tolist()))
    return path


def test_a_record_runs_as_it_is(plain):
    motion = read_motion(plain, unit="m/s2", dt=0.02)
    assert isinstance(motion, Polyline)
    assert (motion.name, motion.acceleration) == ("plain", 2.5)
    np.testing.assert_allclose(motion.acceleration * motion.value(0.02 * np.arange(399)), SAMPLES[:-1], rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("text", ["PGA=0.35g", "pgv=12 cm/s", "PGD=30 mm", "Arias=0.4", "CAV=3 m/s"])
def test_a_record_is_scaled_to_a_measure(plain, text):
    record = read_record(plain, unit="m/s2", dt=0.02)
    factor = factor_to(record, text)
    scaled = type(record)(**{**vars(record), "acceleration": factor * record.acceleration})
    name, _, value = text.partition("=")
    units = {"g": 9.81, "cm/s": 1e-2, "mm": 1e-3, "m/s": 1.0, "": 1.0}
    number = value.rstrip("gmcs/ ")
    assert getattr(intensity(scaled), name.lower()) == pytest.approx(float(number) * units[value[len(number) :].strip()], rel=1e-12)
    assert factor > 0.0
    peak = int(np.argmax(np.abs(SAMPLES)))
    for turned, more in ((1.0, {}), (-1.0, {"scale": -1.0})):
        motion = read_motion(plain, unit="m/s2", dt=0.02, scale_to=text, **more)
        assert motion.acceleration == pytest.approx(factor * 2.5, rel=1e-14)
        assert float(motion.value(0.02 * peak)) == pytest.approx(turned * np.sign(SAMPLES[peak]), rel=1e-12)


def test_documents_and_pulses_are_turned_over(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text("points: [[0, 0], [0.25, 1], [0.75, -1], [1, 0]]\n")
    phase = np.linspace(0.0, 7.0, 50)
    own = read_motion(path)
    np.testing.assert_array_equal(read_motion(path, scale=-2.0).value(phase), -2.0 * own.value(phase))
    for name in ("sine", "cosine", "rectangular-impulse", "ricker-symmetric", "mavroeidis-papageorgiou"):
        turned = pulse(name).scaled(-1.0)
        np.testing.assert_allclose(turned.value(phase), -pulse(name).value(phase), rtol=1e-12, atol=1e-15)
        assert turned.peak == pytest.approx(pulse(name).peak, rel=1e-12)
        assert len(turned.segments) == len(pulse(name).segments)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {"scale_to": "PGA"},
            "`scale_to`: found 'PGA'; expected MEASURE=VALUE, such as PGA=0.35g, with one of PGA, PGV, PGD, Arias, CAV",
        ),
        ({"scale_to": "SA=1g"}, "`scale_to`: found 'SA=1g'"),
        ({"scale_to": "PGA=1 m"}, "`scale_to` PGA: found '1 m'; expected an acceleration"),
        ({"scale_to": "PGA=0"}, "expected a positive intensity"),
        ({"scale_to": "PGA=-0.1g"}, "expected a positive intensity"),
        ({"scale_to": "PGA=1", "scale": 2.0}, "found both"),
        ({"scale": 0.0}, "a scale of 0"),
        ({"scale": 1e308}, "expected a number that is not zero, up to 1e+100"),
        ({"component": "2"}, "expected 1, the only one"),
        ({"component": "1"}, None),
    ],
)
def test_choices_that_do_not_fit(plain, given, words):
    if words is None:
        assert read_motion(plain, unit="m/s2", dt=0.02, **given).name == "plain"
        return
    with pytest.raises(UsageError) as error:
        read_motion(plain, unit="m/s2", dt=0.02, **given)
    assert words in str(error.value)


def test_what_goes_with_a_record_only(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text("points: [[0, 0], [0.25, 1], [1, 0]]\n")
    for given in ({"component": "NS"}, {"unit": "g"}, {"dt": 0.1}, {"scale_to": "PGA=1"}):
        with pytest.raises(UsageError, match="applies to a record only"):
            read_motion(path, **given)
    path.write_text("kind: block\n")
    with pytest.raises(DocumentError, match="neither pieces nor points"):
        read_motion(path)


def test_the_memory_of_a_long_record_is_said_beforehand(plain, monkeypatch):
    monkeypatch.setattr("rocking_cli.motions.reading.LONG", 3)
    monkeypatch.setattr("rocking_cli.motions.reading._BYTES", 1e9)
    said = []
    motion = read_motion(plain, unit="m/s2", dt=0.02, tell=said.append)
    assert said == [f"{plain}: {motion.start.size + 1:,} samples; a response to them takes about {motion.start.size + 1:.2g} GB of memory"]

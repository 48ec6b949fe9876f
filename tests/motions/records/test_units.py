"""Units in the spellings of strangers' files."""

import pytest

from rocking_cli.documents.quantities import DEFAULT_GRAVITY
from rocking_cli.motions.records.units import (
    ACCELERATIONS,
    dimension_of,
    rate_unit,
    time_unit,
    unit_of,
)

SPELLINGS = {
    "m/s2": [
        "m/s²",
        "m/s^2",
        "m/s2",
        "M/S2",
        "m s-2",
        "m·s⁻²",
        "m.s-2",
        "m s^-2",
        "ms-2",
        "m/s/s",
        "m/(s^2)",
        "m/(s*s)",
        "m/s**2",
        "m/sec²",
    ],
    "cm/s2": [
        "cm/s²",
        "CM/SEC/SEC",
        "cm/sec2",
        "CM/S**2",
        "cm/sec^2",
        "cm s-2",
        "cm·s⁻²",
        "cm/s/s",
        "centimeters per second squared",
    ],
    "mm/s2": ["mm/s2", "mm/s/s"],
    "gal": ["gal", "Gal", "GALS", "gal (cm/s/s)", "gal(cm/s2)", "GAL."],
    "g": ["g", "G", "g's", "units of g", "fraction of g", "gravity"],
    "mg": ["mg", "MG", "milli-g"],
    "%g": ["%g", "% g", "percent g", "percent of g", "% of g"],
    "ft/s2": ["ft/s2", "ft/sec/sec", "feet per second squared"],
    "in/s2": ["in/s2", "in/sec^2"],
}
ALL = [(word, unit) for unit, words in SPELLINGS.items() for word in words]


@pytest.mark.parametrize(("word", "unit"), ALL)
def test_accelerations(word, unit):
    assert unit_of(word) == unit
    assert dimension_of(word) == "acceleration"


@pytest.mark.parametrize(
    ("word", "dimension"),
    [
        ("cm/s", "velocity"),
        ("m s-1", "velocity"),
        ("m", "length"),
        ("cm", "length"),
        ("kN", "force"),
        ("counts", "counts"),
        ("m/s3", "jerk"),
        ("rad/s2", "rotation"),
        ("furlong/s2", "unknown"),
        ("g2/Hz", "spectral density"),
        ("%", "share"),
        ("volts", "voltage"),
        ("s", "time"),
        ("Hz", "frequency"),
        ("gal (m/s2)", None),
        ("furlong", None),
        ("MS/LA", None),
        ("unfiltered", None),
        ("Kobe", None),
    ],
)
def test_what_is_no_acceleration(word, dimension):
    assert unit_of(word) is None
    assert dimension_of(word) == dimension


def test_their_size():
    assert ACCELERATIONS["mg"] == pytest.approx(1e-3 * DEFAULT_GRAVITY, rel=2e-15)
    assert ACCELERATIONS["%g"] == pytest.approx(1e-2 * DEFAULT_GRAVITY, rel=2e-15)
    assert (ACCELERATIONS["ft/s2"], ACCELERATIONS["in/s2"]) == (0.3048, 0.0254)


@pytest.mark.parametrize(
    ("word", "seconds"),
    [
        *((x, 1.0) for x in ("s", "sec", "SEC.", "seconds", "seg", "Sek", "sn", "秒")),
        *(
            (x, 1e-3)
            for x in (
                "ms",
                "MS",
                "msec",
                "milliseconds",
                "1e-3 s",
                "10^-3 s",
                "0.001 s",
            )
        ),
        *((x, 1e-6) for x in ("us", "µs", "μs", "usec", "microseconds")),
        ("min", 60.0),
        ("h", 3600.0),
        ("hours", 3600.0),
        ("d", None),
        ("fortnight", None),
        ("m", None),
        ("", None),
    ],
)
def test_times(word, seconds):
    assert time_unit(word) == (
        None if seconds is None else pytest.approx(seconds, rel=2e-15)
    )


def test_rates():
    assert [rate_unit(x) for x in ("Hz", "sps", "samples/sec", "kHz", "1/s", "s")] == [
        1.0,
        1.0,
        1.0,
        1e3,
        1.0,
        None,
    ]

"""Factors above the numbers: stated in any spelling, and lines that only
look like one.
"""

import pytest

from rocking_cli.motions.records.factors import states_factor

FACTORS = [
    "Scale factor: 9.81",
    "scale = 0.01",
    "multiply by 0.01",
    "divide by 1000",
    "scaled by 2",
    "values times 1000",
    "values x 1000",
    "acc*100 (g)",
    "a/g x 100",
    "×10⁻³ g",
    "acc/10",
    "G/10",
    "units: 0.01 g",
    "in 0.1 g",
    "acceleration in 1/100 g",
    "LSB = 0.001 g",
    "1 LSB = 1 mg",
    "counts per g: 1000",
    "calib: 0.01",
    "conversion factor 980.665",
    "Faktor 0.01",
    "factor de escala 0.01",
    "fattore di scala: 0.01",
    "Facteur d'échelle 0.01",
    "系数: 0.01",
    "SF = 9.81",
    "SCALE_FACTOR 2.5",
    "Divide values by 981",
    "Multiply with 0.01",
    "1 count = 0.001 g",
    "coefficient 0.01",
    "Ölçek katsayısı: 2",
    "normalised to 1",
    "in tenths of g",
]
NONE = [
    "Scale factor: 1.0",
    "calib: 1.0",
    "Scaled to PGA 0.35 g",
    "PGA 0.25 g, PGV 20 cm/s",
    "full scale: 2 g",
    "wall of 2 x 3 m",
    "SF 1906",
    "Calibration date 2020",
    "Scaled record 5 of 10",
    "Station 5/10, 1/2/1999",
    "Name: a/2.txt",
    "Imperial Valley, El Centro Array #9",
    "Butterworth filter 0.1-25 Hz, order 4",
    "acceleration in m/s2, g = 9.81 m/s2",
    "m/s**2",
    "10^-2",
]


@pytest.mark.parametrize("line", FACTORS)
def test_a_factor_in_any_spelling(line):
    assert states_factor(line)


@pytest.mark.parametrize("line", NONE)
def test_a_line_that_states_none(line):
    assert not states_factor(line)

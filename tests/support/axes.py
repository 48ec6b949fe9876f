"""What axes hold, read back: lines by their label, columns as numbers."""

import numpy as np


def numbers(rows, key):
    return np.array([float(r[key]) if r[key] else np.nan for r in rows])


def lines(axes):
    """{label: (x, y)} of the lines that have a name."""
    return {
        line.get_label(): line.get_data()
        for line in axes.get_lines()
        if not line.get_label().startswith("_")
    }


def same(line, x, y):
    np.testing.assert_array_equal(line[0], x)
    np.testing.assert_array_equal(line[1], y)

"""The share of cells that overturn or lose contact which the linear equation calls
safe, over slenderness and frequency: `make study`.

Reads a file of `rocking spectrum --model both` over a family of blocks, and prints the
table as the README and the pages show it.
"""

import math
import sys

import numpy as np

from rocking_cli.dynamics.outcome import Difference, falls
from rocking_cli.spectra.file.reader import SpectraFile

BANDS = ((1.0, 2.0), (2.0, 3.0), (3.0, 4.0), (4.0, 5.0), (5.0, 6.0))  # of Omega


def shares(path: str) -> list[tuple[float, list[float], float, float]]:
    """For each structure (tan alpha, share unsafe in each band, share unsafe of all
    that fall, false alarms of all that stand).
    """
    rows = []
    with SpectraFile(path) as file:
        omega = file.grid.frequency.values
        for i, s in enumerate(file.structures):
            block = file.block(i, slice(None))
            down, unsafe = (
                falls(block["outcome"]),
                block["difference"] == Difference.LINEAR_UNSAFE,
            )
            inside = [(low <= omega) & (omega < high) for low, high in BANDS]
            bands = [
                float(unsafe[at].sum() / down[at].sum()) if down[at].any() else math.nan
                for at in inside
            ]
            alarms = (block["difference"] == Difference.LINEAR_FALSE_ALARM).sum() / max(
                1, (~down).sum()
            )
            rows.append(
                (
                    math.tan(s.alpha),
                    bands,
                    float(unsafe.sum() / max(1, down.sum())),
                    float(alarms),
                )
            )
    return rows


def table(path: str) -> str:
    """The lines of the table, in per cent."""
    heads = [f"{low:g}-{high:g}" for low, high in BANDS]
    head = (
        "  b/h   linear unsafe, % of falls, Omega =                 all   false"
        " alarms, %"
    )
    lines = [head, "       " + "".join(f"{h:>8}" for h in heads)]
    for slenderness, bands, every, alarms in shares(path):
        cells = "".join(
            f"{'-' if math.isnan(x) else f'{100.0 * x:.1f}':>8}" for x in bands
        )
        lines.append(
            f"  {slenderness:4.2f} {cells} {100.0 * every:10.1f} {100.0 * alarms:12.1f}"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    np.seterr(all="raise")
    print(table(sys.argv[1]))

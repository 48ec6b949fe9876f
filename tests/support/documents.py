"""What a document writes, as a test needs it: structures from their text, and the scene
that the tests of files share.
"""

import csv
import io
from importlib import import_module
from pathlib import Path

import h5py

from rocking_cli import Motion, RockingParameters, build_structure, parse_documents
from rocking_cli.motions.motion_document import build_motion
from rocking_cli.structures.kinds import KINDS

# the kinds of one rigid body, whose module has `body`
RIGID = [
    kind
    for kind, module in KINDS.items()
    if hasattr(import_module(f"rocking_cli.structures.kinds.{module}"), "body")
]

SMALL_SCENE = (
    "--grid",
    "A=0.5:12:120,Omega=0.5:12:120",
    "--eta",
    "0.9",
    "--eta",
    "0.7",
    "--chunk",
    "1800",
    "-q",
)

TWO_PULSES = """
name: Two pulses
pieces:
  - {from: 0, to: 0.5, sines: [{amplitude: 1}]}
  - {from: 0.5, to: 0.8, constant: 0}
  - {from: 0.8, to: 1.2, constant: -0.6, slope: 1.5}
  - {from: 1.2, to: 2.2,
     sines: [{amplitude: 0.5, phase: 90 deg}, {amplitude: 0.2, frequency: 3}]}
"""


def built(text: str) -> RockingParameters:
    """The structure of the only document in a text."""
    (document,) = parse_documents(text, "f.yaml")
    return build_structure(document)


def built_motion(text: str) -> Motion:
    """The motion of the first document in a text."""
    return build_motion(parse_documents(text)[0])


def csv_rows(text: str) -> list[dict[str, str]]:
    """The rows of a CSV that a command printed, by the names of its columns without
    their units.
    """
    return [
        {heading.partition(" [")[0]: cell for heading, cell in row.items()}
        for row in csv.DictReader(io.StringIO(text))
    ]


def same_file(one: Path, other: Path) -> None:
    """Two spectra files hold the same cells to the last bit, and both are complete."""
    with h5py.File(one) as a, h5py.File(other) as b:
        counts = [k for k in b.attrs if k.startswith("cells")]
        assert a["theta_ratio"][...].tobytes() == b["theta_ratio"][...].tobytes()
        assert a["outcome"][...].tobytes() == b["outcome"][...].tobytes()
        assert [a.attrs[k] for k in counts] == [b.attrs[k] for k in counts]
        assert a["bookkeeping/chunk_done"][...].all()

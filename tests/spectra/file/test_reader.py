"""Spectra files are read as this program wrote them, or as its earlier version did, or
refused in one sentence.
"""

import json
import shutil
from pathlib import Path

import h5py
import pytest

from rocking_cli import (
    OutputError,
    SpectraFile,
    dimensionless_oscillator,
    parse_grid,
    sine,
    write_spectrum,
)
from rocking_cli.spectra.file.integrity import digest_line


@pytest.mark.parametrize(
    "content", [b"", b"not HDF5 at all", b"\x89HDF\r\n\x1a\n" + b"\x00" * 100]
)
def test_foreign_files_get_a_sentence(refused, tmp_path, content):
    (tmp_path / "x.h5").write_bytes(content)
    assert "x.h5: is" in refused(1, "info", "x.h5")
    with h5py.File(tmp_path / "y.h5", "w") as file:
        file["x"] = 1
    assert "is not a spectra file" in refused(1, "info", "y.h5")
    assert "no such file" in refused(2, "convert", "nowhere.h5")


def linked(link):
    def edit(file):
        del file["p"]
        file["p"] = link

    return edit


def virtual(file):
    del file["p"]
    layout = h5py.VirtualLayout((1,), "<f8")
    layout[:] = h5py.VirtualSource("other.h5", "p", (1,))
    file.create_virtual_dataset("p", layout)


def external(file):
    del file["bookkeeping/chunk_done"]
    file["bookkeeping"].create_dataset(
        "chunk_done", shape=(8,), dtype="u1", external=[("/etc/passwd", 0, 8)]
    )


def uncut(file):
    del file["outcome"]
    data = file.create_dataset(
        "outcome", shape=(1, 200, 201), dtype="u1", chunks=(1, 25, 200)
    )
    for dimension, scale in zip(data.dims, ("structure", "Omega", "A"), strict=True):
        dimension.attach_scale(file[scale])


def attribute(name, value):
    return lambda file: file.attrs.__setitem__(name, value)


def scene(**changed):
    def edit(file):
        file.attrs["scene"] = json.dumps(json.loads(file.attrs["scene"]) | changed)

    return edit


def with_digest(path):
    with open(path, "r+b") as raw:
        line = digest_line(raw, [])
        raw.seek(0, 2)
        raw.write(line)


HOSTILE = {
    "a virtual dataset": (virtual, "its p is stored in another file"),
    "values of another file": (external, "its chunk_done is stored in another file"),
    "a soft link": (
        linked(h5py.SoftLink("/alpha")),
        "its p is not a dataset of its own",
    ),
    "an external link": (
        linked(h5py.ExternalLink("other.h5", "p")),
        "its p is not a dataset of its own",
    ),
    "chunks of another shape": (uncut, "does not fit its axes"),
    "no axis": (lambda file: file.__delitem__("A"), "scales"),
    "no scene": (lambda file: file.attrs.__delitem__("scene"), "scene"),
    "machines that are no JSON": (attribute("computed_on", "x"), "Expecting value"),
    "machines that are none": (attribute("computed_on", "[3]"), "not iterable"),
    "a run time in words": (attribute("run_time", "long"), "its run_time is 'long'"),
    "an empty scene": (attribute("scene", "{}"), "it has no 'model'"),
    "a scene that is a list": (attribute("scene", "[1]"), "list indices"),
    "no motion": (scene(motion=None), "NoneType"),
    "a motion of pieces that are none": (scene(motion=["sine", [3]]), "mapping"),
    "a motion without a name": (scene(motion=[3, []]), "its motion has no name"),
    "no structures": (scene(structures=[{}]), "structure"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_what_stands_elsewhere_is_not_read_even_with_a_digest(
    spectrum_file, tmp_path, case
):
    edit, words = HOSTILE[case]
    path = tmp_path / "altered.h5"
    shutil.copy(spectrum_file, path)
    with h5py.File(path, "r+") as file:
        edit(file)
    with_digest(path)
    with pytest.raises(
        OutputError, match=f"is not a spectra file as this program wrote it.*{words}"
    ):
        SpectraFile(path)


def test_a_file_that_another_program_has_changed_is_refused(spectrum_file, tmp_path):
    path = tmp_path / "altered.h5"
    shutil.copy(spectrum_file, path)
    with h5py.File(path, "r+") as file:
        file.attrs["remark"] = "mine"
    with pytest.raises(
        OutputError,
        match=(
            r"altered\.h5: is not a spectra file as this program wrote it: changed by"
            r" another one"
        ),
    ):
        SpectraFile(path)


def test_a_variable_that_has_another_name_now_is_refused(tmp_path):
    path = tmp_path / "older.h5"
    grid = parse_grid("A=1:3:3,Omega=2:4:2")
    bodies = [dimensionless_oscillator(eta=0.9)]
    write_spectrum(bodies, sine(), grid, path, impacts=True, workers=1)
    with h5py.File(path, "r+") as file:
        file.move("impacts_at_least", "impacts")
    with_digest(path)
    with pytest.raises(OutputError, match=r"found the variable impacts, .*expected"):
        SpectraFile(path)


def test_a_file_of_an_earlier_commit_is_refused(refused, tmp_path):
    shutil.copy(Path(__file__).with_name("version_0.1.0.h5"), tmp_path / "old.h5")
    said = refused(1, "info", "old.h5")
    assert said == (
        "rocking: old.h5: was not written by this version; compute it again\n"
    )

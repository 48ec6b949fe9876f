"""What a spectra file says of itself is believed only where it is what this program wrote."""

from __future__ import annotations

import shutil

import h5py
import numpy as np
import pytest

from rocking_cli import OutputError
from rocking_cli.errors import FAULTS
from rocking_cli.spectra.contents import chunk_places, contents_of
from rocking_cli.spectra.digest import DIGEST, digest_of
from rocking_cli.spectra.raw_file import RawFile, open_regular
from rocking_cli.spectra.reader import SpectraFile


def replaced(name, **how):
    def edit(file):
        del file[name]
        file.create_dataset(name, **how)

    return edit


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


def stated(key, value, name=None):
    def edit(file):
        (file if name is None else file[name]).attrs[key] = value

    return edit


def valued(name, value):
    def edit(file):
        file[name][0] = value

    return edit


PASSWD = [("/etc/passwd", 0, 8)]
CELLS = {"shape": (1, 200, 200), "dtype": "<f8", "chunks": (1, 25, 200)}
HOSTILE = {
    "values of another file": (replaced("p", shape=(1,), dtype="<f8", external=PASSWD), "not stored in one piece in the file"),
    "names of another file": (replaced("structure", shape=(1,), dtype="S8", external=PASSWD), "not stored in one piece"),
    "a virtual dataset": (virtual, "not stored in one piece"),
    "a soft link": (linked(h5py.SoftLink("/alpha")), "not a dataset of its own"),
    "an external link": (linked(h5py.ExternalLink("other.h5", "p")), "not a dataset of its own"),
    "3e9 chunks": (replaced("chunk_done", shape=(3_000_000_000,), dtype="u1"), "of another type or size"),
    "3e9 structures": (replaced("structure", shape=(3_000_000_000,), dtype=h5py.string_dtype()), "not all in the file"),
    "3e9 values": (replaced("A", shape=(3_000_000_000,), dtype="<f8"), "not all in the file"),
    "chunks of no filter": (replaced("theta_ratio", **CELLS), "not filtered"),
    "chunks of another filter": (replaced("theta_ratio", **CELLS, shuffle=True, compression="gzip", compression_opts=2), "not filtered"),
    "chunks of another type": (replaced("theta_ratio", **{**CELLS, "dtype": "<f4"}), "does not fit its axes"),
    "chunks of another shape": (replaced("outcome", shape=(1, 200, 201), dtype="u1", chunks=(1, 25, 200)), "does not fit its axes"),
    "chunks cut otherwise": (
        replaced("outcome", shape=(1, 200, 200), dtype="u1", chunks=(1, 20, 200), compression="gzip", compression_opts=1),
        "different chunks",
    ),
    "one more dataset": (lambda file: file.create_dataset("more", data=[1.0]), "'more' is none of a spectra file"),
    "one less dataset": (lambda file: file.__delitem__("gravity"), "no dataset 'gravity'"),
    "no axis": (lambda file: file.__delitem__("A"), "no axes"),
    "no digest": (lambda file: file.attrs.__delitem__(DIGEST), "layout_digest"),
    "an axis of other values": (valued("A", 0.4999), "does not fit its digest"),
    "a parameter of another value": (valued("eta", 0.8), "does not fit its digest"),
    "another name": (valued("structure", "\x1b[31m"), "does not fit its digest"),
    "other flags": (stated("flag_values", np.array([0, 2, 1, 3, 4, 5], "u1"), "outcome"), "does not fit its digest"),
    "another unit": (stated("units", "m s-2", "A"), "does not fit its digest"),
    "another scene": (stated("scene", "{}"), "does not fit its digest"),
    "another command": (stated("history", "rm -rf"), "does not fit its digest"),
}  # fmt: skip


@pytest.fixture
def altered(spectrum_file, tmp_path):
    """Alter a copy of a spectra file, state its digest anew if asked to, and check what it says."""

    def alter(edit, anew=False):
        path = tmp_path / "altered.h5"
        shutil.copy(spectrum_file, path)
        with h5py.File(path, "r+") as file:
            edit(file)
            if anew:
                file.attrs[DIGEST] = digest_of(file.attrs, file)
        raw = RawFile(open_regular(path))
        with h5py.File(raw, "r") as file:
            contents = contents_of(file, raw.end)
            return contents, chunk_places(file, contents, raw.end)

    return alter


@pytest.mark.parametrize("what", HOSTILE)
def test_what_is_not_this_program_s_is_refused(altered, what):
    edit, reason = HOSTILE[what]
    with pytest.raises(FAULTS, match=reason):
        altered(edit)


@pytest.mark.parametrize(
    ("edit", "reason"), [(valued("A", 0.4999), "axis A is not that of its scene"), (valued("eta", 0.8), "eta is not that of its scene")]
)
def test_a_digest_stated_anew_does_not_hide_another_scene(altered, edit, reason):
    with pytest.raises(ValueError, match=reason):
        altered(edit, anew=True)


def test_a_remark_of_another_program_changes_nothing(altered, spectrum_file, tmp_path):
    contents, places = altered(stated("remark", "ours"))
    assert contents.attributes["remark"] == "ours"
    assert len(places) == 2 * contents.cut.size
    with SpectraFile(tmp_path / "altered.h5") as one, SpectraFile(spectrum_file) as other:
        assert (one.sealed, other.sealed) == (False, True)
        assert np.array_equal(one.block(0, slice(None))["outcome"], other.block(0, slice(None))["outcome"])


def test_filters_that_a_chunk_leaves_out_are_refused(spectrum_file, tmp_path):
    """A bit of a chunk's filter mask says that its bytes are the numbers themselves."""
    path = tmp_path / "masked.h5"
    shutil.copy(spectrum_file, path)
    with h5py.File(path, "r+") as file:
        file.attrs["remark"] = "no seal any more"
        size = file["theta_ratio"].id.get_chunk_info(0).size
    data = bytearray(path.read_bytes())
    key = size.to_bytes(4, "little") + bytes(4) + bytes(4 * 8)
    assert data.count(key) == 1
    data[data.find(key) + 4] = 1
    path.write_bytes(data)
    with h5py.File(path) as file:
        assert file["theta_ratio"].id.get_chunk_info(0).filter_mask == 1
    with pytest.raises(OutputError, match=r"the chunk index of theta_ratio is damaged at \(0, 0, 0\)"):
        SpectraFile(path)

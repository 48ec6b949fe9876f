"""Tables of verdicts: what `check` says of each structure, in a file that is written in
parts.
"""

from dataclasses import replace

import numpy as np
import pytest

from rocking_cli import (
    Interrupted,
    SpectraFile,
    UsageError,
    build_structure,
    check,
    merge,
    parse_documents,
    parse_grid,
    sine,
)
from rocking_cli.spectra import verdicts
from rocking_cli.spectra.sweep_options import SweepOptions
from rocking_cli.spectra.verdicts import SIGNS, VerdictScene, write_verdicts

TABLE = "kind,name,width,height,room\n" + "".join(
    f"block,B{i},{0.3 + 0.07 * i:.2f},2,hall {i % 2}\n" for i in range(8)
)
SIDED = "{kind: rigid, name: Sided, left: 0.2, right: 0.3, height: 1, gyration: 0.6}"
GRID = parse_grid("a_g=0.35g,f_g=1.5")


@pytest.fixture(scope="module")
def scene():
    structures = [build_structure(d) for d in parse_documents(TABLE)]
    varied = {"varied": {"height": 2.0}, "varied_units": {"height": "m"}}
    structures[1] = replace(structures[1], details=varied)
    return VerdictScene(tuple(structures), {SIGNS[0]: [(sine(), GRID)]}, forces=True)


@pytest.fixture(autouse=True)
def _small_chunks(monkeypatch):
    monkeypatch.setattr(verdicts, "CHUNK", 2)


def write(scene, path, **options):
    return write_verdicts(scene, path, SweepOptions(workers=1, **options))


def contents(path):
    with SpectraFile(path, any_kind=True) as file:
        lists = {key: list(values) for key, (_, values) in file.frame.lists.items()}
        return lists, {name: file.array(name) for name in file.names}


def same(one, other):
    assert str(one[0]) == str(other[0])  # NaN too
    assert one[1].keys() == other[1].keys()
    for name in one[1]:
        np.testing.assert_array_equal(one[1][name], other[1][name])


@pytest.fixture(scope="module")
def whole(scene, tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "whole.h5"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(verdicts, "CHUNK", 2)
        write(scene, path)
    return contents(path)


def test_a_cell_holds_what_check_says(scene, whole):
    lists, arrays = whole
    assert lists["structure"] == [f"B{i}" for i in range(8)]
    assert lists["label_room"][:2] == ["hall 0", "hall 1"]
    assert lists["varied_height"][1] == 2.0
    assert arrays["theta_ratio"][0, -1, 0] == 0.0  # it does not lift
    for i, structure in enumerate(scene.structures):
        verdict = check(structure, sine(), GRID, a_max=None)
        assert arrays["outcome"][0, i, 0] == verdict.outcome
        for name in ("theta_ratio", "uplift_a", "top_displacement", "friction_needed"):
            known = getattr(verdict, name)
            expected = np.nan if known is None else known
            np.testing.assert_allclose(arrays[name][0, i, 0], expected, rtol=1e-9)


def test_shards_make_the_same_file(scene, whole, tmp_path):
    paths = [tmp_path / f"{i}.h5" for i in (1, 2, 3)]
    for i, path in enumerate(paths, 1):
        write(scene, path, shard=(i, 3))
    some = merge(paths[:2], tmp_path / "some.h5")
    assert (some.chunks, some.missing) == (3, ("3/3",))
    assert merge(paths, tmp_path / "all.h5").missing == ()
    same(contents(tmp_path / "all.h5"), whole)


def test_an_interrupted_run_goes_on_with_what_is_there(scene, whole, tmp_path):
    path, done = tmp_path / "v.h5", []

    def stop(chunks, _):
        done.append(chunks)
        if chunks == 3:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="3 of 4 chunks are kept"):
        write(scene, path, progress=stop)
    with pytest.raises(UsageError, match="exists, left by a sweep"):
        write(scene, path)
    other = replace(scene, structures=scene.structures[::-1])
    with pytest.raises(UsageError, match="another scene: its structures_sha256"):
        write(other, path, resume=True)
    later = []
    write(scene, path, resume=True, progress=lambda chunks, _: later.append(chunks))
    assert (done, later) == ([1, 2, 3], [4])
    same(contents(path), whole)


def test_of_the_second_direction_only_sided_bodies_have_a_verdict(scene, tmp_path):
    (sided,) = map(build_structure, parse_documents(SIDED))
    motions = sine(), sine().scaled(-1.0)
    both = {sign: [(m, GRID)] for sign, m in zip(SIGNS, motions, strict=True)}
    path = tmp_path / "v.h5"
    write(replace(scene, structures=(scene.structures[0], sided), shakes=both), path)
    (block, mine) = contents(path)[1]["outcome"][0]
    assert block[1] == 0
    assert list(mine) == [check(sided, m, GRID, a_max=None).outcome for m in motions]


def test_verdicts_are_no_spectra(scene, tmp_path):
    write(scene, tmp_path / "v.h5")
    with pytest.raises(UsageError, match="found a table of verdicts; expected spectra"):
        SpectraFile(tmp_path / "v.h5")

"""`rocking merge` at the shell."""

from support.documents import SMALL_SCENE


def test_shards_of_another_scene_are_refused(rocking, refused):
    assert (
        rocking("spectrum", *SMALL_SCENE, "--shard", "1/2", "-o", "1.h5").returncode
        == 0
    )
    assert (
        rocking(
            "spectrum",
            *SMALL_SCENE,
            "--shard",
            "2/2",
            "--pulse",
            "cosine",
            "-o",
            "2.h5",
        ).returncode
        == 0
    )
    said = refused(2, "merge", "1.h5", "2.h5", "-o", "all.h5")
    assert 'its motion differs: "cosine 1 cycle", there "sine 1 cycle"' in said


def test_the_shard_that_is_missing_is_named(rocking):
    for i in (1, 3):
        assert (
            rocking(
                "spectrum", *SMALL_SCENE, "--shard", f"{i}/4", "-o", f"{i}.h5"
            ).returncode
            == 0
        )
    done = rocking("merge", "1.h5", "3.h5", "-o", "part.h5", "-q")
    assert (done.returncode, done.stderr) == (
        4,
        "missing or not complete: shard 2/4, 4/4\n",
    )

"""Responses in motion: the frames of a GIF, and the shapes in them."""

import pytest
from PIL import Image

from rocking_cli import UsageError, build_structure, read_documents
from rocking_cli.reports.figures.animation import animate
from rocking_cli.structures.kinds import sketch_of


def frames(path):
    with Image.open(path) as image:
        times = []
        for i in range(image.n_frames):
            image.seek(i)
            times.append(image.info["duration"])
        return times


def test_a_gif_takes_as_long_as_the_response(rocking, tmp_path):
    call = (
        "response",
        "configs/block.yaml",
        "--A",
        "2",
        "--Omega",
        "4",
        "--duration",
        "0.5",
        "--csv",
    )
    (tmp_path / "r.csv").write_text(rocking(*call).stdout)
    done = rocking(
        "plot", "r.csv", "--animate", "r.gif", "--size", "60mm", "--dpi", "40"
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert sum(frames(tmp_path / "r.gif")) == pytest.approx(500, abs=40)
    assert "exists" in rocking("plot", "r.csv", "--animate", "r.gif").stderr


def test_a_body_turns_about_its_edge_and_a_frame_moves_as_its_mirror_image(
    pytestconfig,
):
    sketches = []
    for name in ("block", "frame"):
        (document,) = read_documents(pytestconfig.rootpath / "configs" / f"{name}.yaml")
        sketches.append(sketch_of(document, build_structure(document)))
    block, frame = sketches
    (left,), (right,) = (block.posed(theta)[0] for theta in (-0.1, 0.1))
    assert (left[0], right[1]) == (
        pytest.approx((-0.25, 0.0)),
        pytest.approx((0.25, 0.0)),
    )
    assert left[2][0] < 0.25 < right[2][0]
    there, back = (frame.posed(sign * 0.2)[0] for sign in (1.0, -1.0))
    for outline, image in zip(there[:-1], reversed(back[:-1]), strict=True):
        mirrored = [(-x, z) for x, z in image]
        assert sorted(mirrored) == [pytest.approx(point) for point in sorted(outline)]


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ({"tau": "0", "theta_ratio": "0", "A": "0"}, "expected a response with units"),
        (
            {
                "t": "1",
                "theta": "0",
                "tau": "1",
                "theta_ratio": "0",
                "ground_acceleration": "0",
            },
            "does not rock",
        ),
        (
            {"t": "1", "theta": "0", "ground_acceleration": "0"},
            "with the columns tau and theta_ratio",
        ),
    ],
)
def test_rows_that_cannot_move(tmp_path, row, words):
    with pytest.raises(UsageError, match=words):
        animate([row], tmp_path / "x.gif")

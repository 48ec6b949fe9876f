"""`rocking draw` at the shell; what drawings show is tested with the reports."""

from __future__ import annotations


def test_a_drawing_is_written_in_the_format_of_its_name(rocking, refused, tmp_path):
    for name, begins in (("x.svg", b"<?xml"), ("x.pdf", b"%PDF")):
        done = rocking("draw", "block:0.5x2", "-o", name)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        assert (tmp_path / name).read_bytes().startswith(begins)
    assert "exists; --overwrite" in refused(2, "draw", "block:0.5x2", "-o", "x.svg")


def test_refusals(refused, tmp_path):
    assert "no structure" in refused(2, "draw", "-o", "x.svg")
    assert "ends in .png, .svg or .pdf" in refused(2, "draw", "block:0.5x2", "-o", "x.jpg")
    assert "states no geometry to draw" in refused(3, "draw", "configs/parameters.yaml", "-o", "x.svg")
    assert "found 13 structures; up to 12 fit a figure" in refused(2, "draw", *["block:0.5x2"] * 13, "-o", "x.svg")

"""`rocking draw` at the shell; what drawings show is tested with the reports."""


def test_a_drawing_is_written_in_the_format_of_its_name(rocking, tmp_path):
    for name, begins in (("x.svg", b"<?xml"), ("x.pdf", b"%PDF")):
        done = rocking("draw", "block:0.5x2", "-o", name)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        assert (tmp_path / name).read_bytes().startswith(begins)

"""`rocking info` at the shell."""

from dataclasses import replace

from rocking_cli import dimensionless_oscillator, parse_grid, sine, write_spectrum


def test_names_do_not_steer_the_terminal(rocking, tmp_path):
    structure = replace(dimensionless_oscillator(eta=0.9), name="a\x1b[31mb")
    write_spectrum(
        [structure], sine(), parse_grid("A=1:2:3,Omega=1:2:3"), tmp_path / "s\x1b[2J.h5"
    )
    for call in (("info",), ("info", "--json"), ("convert",), ("convert", "--json")):
        done = rocking(*call, "s\x1b[2J.h5")
        assert done.returncode == 0
        assert "31mb" in done.stdout
        assert "\x1b" not in done.stdout + done.stderr
    (tmp_path / "t\x1b[2J.h5").write_text("nothing")
    assert "\x1b" not in rocking("info", "t\x1b[2J.h5").stderr

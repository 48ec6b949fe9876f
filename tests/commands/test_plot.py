"""`rocking plot` at the shell."""

from __future__ import annotations


def test_figures_of_every_kind_are_drawn(rocking, refused, spectrum_file, tmp_path):
    calls = {
        "envelope.csv": ("envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--csv"),
        "curves.csv": ("envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--closed-form", "--csv"),
        "response.csv": ("response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--model", "both", "--csv"),
        "tau.csv": ("response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--dimensionless", "--csv"),
        "compare.csv": ("compare", "configs/block.yaml", "configs/spire.yaml", "--A", "2", "--Omega", "4", "--curves", "--csv"),
        "params.csv": ("params", "configs/spire.yaml", "--vary", "base_radius=1:2:4", "--vary", "height=8:16:3", "--csv"),
        "accuracy.csv": ("accuracy", "--eta", "0.9", "--grid", "A=1:9:9,Omega=1:9:9", "--sample", "3", "--scipy", "1", "--csv"),
    }
    for name, call in calls.items():
        (tmp_path / name).write_text(rocking(*call).stdout)
        done = rocking("plot", name, "-o", f"{name}.png")
        assert done.returncode == 0, done.stderr
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert rocking("plot", str(spectrum_file), "-o", "map.svg", "--log", "xy").returncode == 0
    assert rocking("plot", str(spectrum_file), "--slice", "Omega=5", "-o", "slice.pdf").returncode == 0
    assert "overturns" in rocking("plot", str(spectrum_file), "--text").stdout
    assert "Omega = 5" in rocking("plot", str(spectrum_file), "--text", "--slice", "Omega=5").stdout
    assert "exists" in refused(2, "plot", "params.csv", "-o", "params.csv.png")
    assert "are none that a command" in refused(2, "plot", str(_foreign(tmp_path)), "-o", "x.png")
    assert "ends in .png" in refused(2, "plot", "params.csv", "-o", "x.bmp")
    assert "--slice" in refused(2, "plot", str(spectrum_file), "--text", "--slice", "B=3")
    assert "Omega=1 to 8" in refused(2, "plot", str(spectrum_file), "--text", "--slice", "Omega=99")
    assert "spectra files" in refused(2, "plot", "params.csv", "--text")


def _foreign(folder):
    (folder / "foreign.csv").write_text("a,b\n1,2\n")
    return folder / "foreign.csv"

"""What a family varied is a coordinate of its spectra."""

import h5py
import numpy as np
import pytest
import xarray as xr

from rocking_cli.spectra.file.reader import SpectraFile

FAMILY = ("--vary", "width=40cm:60cm:3", "--vary", "restitution=0.8:0.9:2")


@pytest.fixture
def family(rocking):
    return rocking("params", "configs/block.yaml", *FAMILY, "--json").stdout


def test_the_varied_keys_are_coordinates_in_si(rocking, tmp_path, family):
    done = rocking(
        "spectrum",
        "-",
        "configs/spire.yaml",
        "--grid",
        "a_g=1:3:3,f_g=1:2:2",
        "-o",
        "f.h5",
        "-q",
        stdin=family,
    )
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "f.h5", engine="h5netcdf") as d:
        assert {"varied_width", "varied_restitution"} <= set(d.theta_ratio.coords)
        np.testing.assert_allclose(
            d.varied_width.values, [0.4, 0.4, 0.5, 0.5, 0.6, 0.6, np.nan], rtol=1e-14
        )
        np.testing.assert_allclose(
            d.varied_restitution.values, [0.8, 0.9] * 3 + [np.nan], rtol=1e-14
        )
        assert (d.varied_width.attrs["units"], d.varied_restitution.attrs["units"]) == (
            "m",
            "1",
        )
        assert d.varied_width.dims == ("structure",)
    with SpectraFile(tmp_path / "f.h5") as file:
        assert file.structures[2].details["varied"] == pytest.approx(
            {"width": 0.5, "restitution": 0.8}, rel=1e-14
        )


def test_shards_keep_them(rocking, tmp_path, family):
    call = ("spectrum", "-", "--grid", "a_g=1:3:4,f_g=1:2:2", "-q", "--chunk", "4")
    for part in ("1/2", "2/2"):
        assert (
            rocking(
                *call, "--shard", part, "-o", f"{part[0]}.h5", stdin=family
            ).returncode
            == 0
        )
    assert rocking("merge", "1.h5", "2.h5", "-o", "both.h5").returncode == 0
    with h5py.File(tmp_path / "both.h5") as file:
        np.testing.assert_allclose(
            file["varied_width"][...], [0.4, 0.4, 0.5, 0.5, 0.6, 0.6], rtol=1e-14
        )
        assert file["varied_width"].attrs["units"] == "m"
    assert rocking("info", "both.h5", "--verify").returncode == 0

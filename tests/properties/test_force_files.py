"""Damaged files of a measured force: refused with the file, or one record of finite values."""

import io as bytes_io

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from scipy import io

from tests.properties.damage import damaged_bytes
from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.properties.test_matrix_files import damaged_words
from vibroimpact.excitation.force_files import ForceFileError, read_force

FORCE, RATE = np.array([0.5, -1.0, 2.0, 0.25, 1.5, -0.75, 0.0, 1.0]), 400.0
TABLE = "time,force\n" + "".join(f"{i / RATE},{value}\n" for i, value in enumerate(FORCE))


def contents(folder):
    """{ending: bytes of files that hold the record}."""
    matlab, packed = bytes_io.BytesIO(), bytes_io.BytesIO()
    io.savemat(matlab, {"force": FORCE, "Fs": RATE})
    io.savemat(packed, {"force": FORCE, "Fs": RATE, "note": "µ"}, do_compression=True)
    time = {"time": np.arange(FORCE.size) / RATE}
    classic, hdf5 = folder / "classic.nc", folder / "hdf5.nc"
    dataset = xr.Dataset({"force": ("time", FORCE)}, time)
    dataset.to_netcdf(classic, format="NETCDF3_CLASSIC", engine="netcdf4")
    dataset.to_netcdf(hdf5, engine="netcdf4")
    return {
        ".csv": [TABLE.encode(), TABLE.replace("force", "force,µ").encode("latin-1")],
        ".mat": [matlab.getvalue(), packed.getvalue()],
        ".nc": [classic.read_bytes(), hdf5.read_bytes()],
    }


@pytest.mark.parametrize("ending", [".csv", ".mat", ".nc"])
def test_damaged_force_files_are_refused_or_right(ending, reliability, tmp_path):
    tried = Tried()
    files = contents(tmp_path)[ending]

    @given(st.data())
    def check(data):
        content = data.draw(st.sampled_from(files))
        words = ending == ".csv" and data.draw(st.booleans())
        content = data.draw((damaged_words if words else damaged_bytes)(content))
        with folder_of_example() as folder:
            path = folder / f"force{ending}"
            path.write_bytes(content)
            outcome = tried.add(
                guarded(
                    lambda: read_force(path, "force", None), ForceFileError, [folder], [path.name]
                )
            )
        if outcome[0] == "right":
            values, rate = outcome[1].values, outcome[1].rate
            assert values.ndim == 1 and np.all(np.isfinite(values)) and np.any(values)
            assert np.isfinite(rate) and rate > 0

    check()
    reliability.inputs(f"files of a measured force, {ending}, bytes or words damaged", tried)

"""Damage of HDF5 files that HDF5 itself does not see."""

import numpy as np
import pytest
import xarray as xr

from vibroimpact.io.records import RecordError, read_given_dataset


def test_a_list_of_texts_without_an_end_is_refused(tmp_path):
    """HDF5 2.0.0 reads it for ever."""
    path = tmp_path / "bench.nc"
    xr.Dataset({"channel_name": ("channel", np.array(["tip", "base"], object))}).to_netcdf(path)
    content = bytearray(path.read_bytes())
    first = content.index(b"GCOL") + 16
    assert read_given_dataset(path)["channel_name"].values.tolist() == ["tip", "base"]
    content[first : first + 16] = bytes(16)
    path.write_bytes(content)
    with pytest.raises(RecordError, match=f"a list of texts has no end, at byte {first}"):
        read_given_dataset(path)

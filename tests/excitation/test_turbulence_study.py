"""A study under turbulence from its model to its figures, as the workflow runs it."""

import numpy as np
import pytest

from tests.physics.test_measured_supports import TURBULENCE
from tests.support.tiny_study import TinyStudy, tiny_values
from vibroimpact.campaign.file import read_campaign
from vibroimpact.io.records import read_table


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    values = tiny_values(excitation=TURBULENCE)
    values["grid"] = {"load_rms_N": [10.0, 40.0], "gap_m": [1e-4], "seeds": 1}
    study = TinyStudy(tmp_path_factory.mktemp("results"), values)
    study.simulate()
    study.identify()
    study.draw(("model", "response"))
    return study


def test_supports_are_identified(study):
    rows = read_table(study.path("equivalent.csv"))
    k = [row["k_N_per_m"] for row in rows if row["direction"] == "y"]
    assert np.isfinite(k).all() and k[1] > 2.0 * k[0]


def test_linear_spectra_of_figure_7_are_those_of_the_same_force(study):
    # Static compliance: below its first mode the tube in full contact hardly depends on contact.
    rows = read_table(study.path("figures/figure_07_overlay_of_loads.csv"))
    low = [row for row in rows if 8.0 < row["frequency_Hz"] < 12.0]
    psds = {
        curve: np.mean(
            [
                row["psd_per_load2_m2_per_N2_per_Hz"]
                for row in low
                if row["curve"] == curve and row[column] == value
            ]
        )
        for curve, column, value in (
            ("non-linear", "load_rms_N", 40.0),
            ("linear", "k_N_per_m", 4.0e6),
        )
    }
    assert psds["non-linear"] == pytest.approx(psds["linear"], rel=0.5)


def test_the_synthetic_campaign_has_loads_and_no_force(study):
    campaign = read_campaign(study.path("synthetic_campaign.nc"), force_needed=False)
    assert campaign.sizes["force_channel"] == 0 and campaign["load_rms"].values.tolist() == [10.0]

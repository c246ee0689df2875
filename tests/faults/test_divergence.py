"""A run that diverges names the case by its load, gap and seed, as the user wrote them."""

import pytest

from tests.support.tiny_study import tiny_values
from vibroimpact.config.reading import check_config
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.study.cases import Case
from vibroimpact.study.in_process import reduced_model
from vibroimpact.study.simulation import simulate_cases

SHORT = {"duration_s": 0.0625, "keep_time_series": True}


@pytest.mark.parametrize("every_step", [False, True])
def test_divergence_names_load_gap_and_seed(every_step, reliability):
    values = tiny_values(identification=None)
    values["record"] |= SHORT | {"every_step": every_step}
    values["integration"]["start_up_s"] = 0.0
    values["supports"][0]["friction"] = 0.3
    config = check_config(values, "tiny")
    cases = [Case(1e-3, 1e-4, 0), Case(1e100, 1e-4, 1)]  # a load that no configuration may have
    with pytest.raises(
        IntegrationError,
        match=r"^load 1e\+100 N RMS, gap 0\.1 mm, seed 1: diverged at t = .*steps_per_second",
    ):
        list(simulate_cases(config, reduced_model(config), cases))
    reliability.fault(
        "a run diverges", "load, gap and seed, time, contact point and remedy are named"
    )

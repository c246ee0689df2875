"""Force files and raw measurements as recorders and careless users write them: refused, or the
values and the sampling frequency that were written.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.properties.recorder_files import (
    REFUSED,
    RIGHT,
    WRITERS,
    Recording,
    odd_habits,
    stated_units,
)
from tests.properties.test_raw_measurements import outcome_of, write_sidecar
from vibroimpact.campaign.file import channel_signal, force_signal
from vibroimpact.excitation.force_files import ForceFileError, read_force

SAMPLES = 96


def noise(*names):
    """{name: (time,)} of any numbers, those of a name the same in every run."""
    return {
        name: np.random.default_rng(len(name)).standard_normal(SAMPLES).round(6) for name in names
    }


@pytest.mark.parametrize("ending", WRITERS)
def test_force_files_of_recorders_are_refused_or_right(ending, reliability):
    tried = Tried()

    @given(st.data())
    def check(data):
        rate = data.draw(st.sampled_from([512.0, 1000.0, 51.2]))
        recording = Recording(noise("force"), rate, odd_habits(data.draw, ending))
        stated_units(data.draw, recording, {"force": "force"})
        with folder_of_example() as folder:
            path = folder / f"force{ending}"
            WRITERS[ending](data.draw, path, recording)
            outcome, result = tried.add(
                guarded(
                    lambda: read_force(path, "force", None), ForceFileError, [folder], [path.name]
                )
            )
        if outcome == "refused":
            assert recording.outcome != RIGHT, (recording.habits, result)
            return
        assert recording.outcome != REFUSED, (recording.habits, result)
        expected = recording.factors["force"] * recording.signals["force"]
        scale = recording.relative * np.abs(expected).max()
        np.testing.assert_allclose(
            result.values, expected, atol=scale, err_msg=str(recording.habits)
        )
        assert result.rate == pytest.approx(recording.rate, rel=1e-5), recording.habits

    check()
    reliability.inputs(f"force files of recorders, {ending}: forms, units, times, rates", tried)


QUANTITIES = {"shaker": "force", "tip": "acceleration", "middle": "acceleration"}


def sidecar(ending, levels, units):
    """The content of a campaign.yaml that states the units that the files do not."""
    sensors = [
        {"name": name, "point_m": [0.1 * index, 0, 0], "direction": "+y"}
        | ({} if units.get(name) else {"unit": {"force": "N"}.get(quantity, "m/s^2")})
        for index, (name, quantity) in enumerate(QUANTITIES.items())
    ]
    return {
        "source": "bench",
        "forces": sensors[:1],
        "channels": [{**sensor, "kind": "acceleration"} for sensor in sensors[1:]],
        "records": [{"name": level, "file": level + ending, "gap_m": 2e-4} for level in levels],
    }


@pytest.mark.parametrize("ending", WRITERS)
def test_raw_measurements_of_recorders_are_refused_or_right(ending, reliability):
    """Two records by the same recorder, the first of which may have other habits."""
    tried = Tried()

    @given(st.data())
    def check(data):
        rate = data.draw(st.sampled_from([512.0, 1000.0, 51.2]))
        odd = odd_habits(data.draw, ending)
        first = Recording(noise(*QUANTITIES), rate, odd)
        second = Recording(noise(*QUANTITIES), rate)
        stated_units(data.draw, first, QUANTITIES)
        if first.units["shaker"] == "V":  # a voltage may stand for a force
            first.factors["shaker"] = 1.0
            first.outcome = RIGHT if all(first.factors.values()) else REFUSED
        second.units, second.factors = first.units, first.factors
        with folder_of_example() as folder:
            for level, recording in (("low", first), ("high", second)):
                WRITERS[ending](data.draw, folder / f"{level}{ending}", recording)
            if first.rate != second.rate:
                first.owes(REFUSED)
            stated = {} if ending == ".mat" else first.units
            write_sidecar(folder, sidecar(ending, ("low", "high"), stated))
            outcome, result = outcome_of(folder, tried)
        if outcome == "refused":
            assert first.outcome != RIGHT, (first.habits, result)
            return
        assert first.outcome != REFUSED, (first.habits, result[1][0])
        for record, recording in enumerate((first, second)):
            require_written(result[0], record, recording)

    check()
    reliability.inputs(
        f"raw measurements of recorders, {ending}: forms, units, times, rates", tried
    )


def require_written(campaign, record, recording):
    """Assert that a record of a campaign is what was written, in SI."""
    assert campaign.attrs["sampling_frequency"] == pytest.approx(recording.rate, rel=1e-5)
    found = [force_signal(campaign, record), *(channel_signal(campaign, record, n) for n in (0, 1))]
    for values, (name, stored) in zip(found, recording.signals.items(), strict=True):
        expected = recording.factors[name] * stored
        scale = max(recording.relative, 1e-6) * np.nanmax(np.abs(expected))
        told = f"{name}: {recording.habits}"
        np.testing.assert_allclose(values, expected, rtol=1e-6, atol=scale, err_msg=told)

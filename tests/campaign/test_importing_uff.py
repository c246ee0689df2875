"""Universal files as recorders write them: drive points, and channels that begin at other times."""

import numpy as np
import pytest
import yaml

from tests.support.universal_file import UNCLOSED, dataset_58, write_uff
from vibroimpact.campaign.checks.file_checks import check_campaign
from vibroimpact.campaign.file import channel_signal, force_signal
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.draft import checked_folder
from vibroimpact.campaign.importing.report import import_text
from vibroimpact.campaign.importing.uff import read_uff
from vibroimpact.io.signal_files.signals import ImportProblem

pytestmark = UNCLOSED

RATE, SAMPLES = 512.0, 2048
FORCE, ACCELERATION = 13, 12  # ordinate types of dataset 58
UNITS = {FORCE: "N", ACCELERATION: "m/s^2"}


def record(values, node, kind, name, start=0.0):
    """A dataset 58 of a time record along +z."""
    time = start + np.arange(values.size) / RATE
    units = {"ordinate_spec_data_type": kind, "ordinate_axis_units_lab": UNITS[kind]}
    return dataset_58(values, time, node, 3, id1=name, abscissa_inc=1.0 / RATE, **units)


@pytest.fixture
def drive_point(tmp_path):
    """Two files with a force and an acceleration at 1:+z, and an acceleration at 2:+z."""
    draw = np.random.default_rng(1)
    for name, level in (("low.uff", 1.0), ("high.uff", 4.0)):
        force, first, second = draw.standard_normal((3, SAMPLES))
        write_uff(
            tmp_path / name,
            record(level * force / force.std(), 1, FORCE, "Force F1"),
            record(first, 1, ACCELERATION, "Accel A1"),
            record(second, 2, ACCELERATION, "Accel A2"),
        )
    return tmp_path


def describe(folder, force, drive):
    described = {
        "forces": [{"name": "hammer", "variable": force}],
        "channels": [{"name": "drive", "variable": drive}],
        "records": [{"file": "low.uff"}, {"file": "high.uff", "split": "holdout"}],
    }
    (folder / "campaign.yaml").write_text(yaml.safe_dump(described))


def test_a_drive_point_is_imported_without_a_sidecar(drive_point):
    campaign, rows = import_folder(drive_point)
    assert campaign["force_channel_name"].values.tolist() == ["1:+z force"]
    assert campaign["channel_name"].values.tolist() == ["1:+z acceleration", "2:+z"]
    loads = dict(zip(campaign["record_name"].values, campaign["load_rms"].values, strict=True))
    assert loads == pytest.approx({"low": 1.0, "high": 4.0}, rel=1e-3)
    assert "contact_force" not in import_text(drive_point, campaign, rows, check_campaign(campaign))


@pytest.mark.parametrize(
    "force, drive", [("Force F1", "Accel A1"), ("1:+z", "1:+z"), ("1:+z force", "1:+z")]
)
def test_a_drive_point_is_named_by_line_or_node(drive_point, force, drive):
    describe(drive_point, force, drive)
    campaign, rows = import_folder(drive_point)
    assert [(row["sensor"], row["variable"]) for row in rows[:2]] == [
        ("hammer", "1:+z force"),
        ("drive", "1:+z acceleration"),
    ]


def test_records_of_one_node_and_quantity_have_own_names(tmp_path):
    values = np.random.default_rng(2).standard_normal((5, 64))
    kinds = (FORCE, ACCELERATION, ACCELERATION, ACCELERATION, ACCELERATION)
    lines = ("F", "A", "B", "B", "NONE")
    write_uff(
        tmp_path / "run.uff",
        *(record(*each) for each in zip(values, [1] * 5, kinds, lines, strict=True)),
    )
    assert [signal.name for signal in read_uff(tmp_path / "run.uff")] == [
        "1:+z force",
        "1:+z acceleration A",
        "1:+z acceleration B #1",
        "1:+z acceleration B #2",
        "1:+z acceleration",
    ]


def test_the_draft_offers_each_name_once_and_the_force(drive_point, tmp_path):
    checked_folder(drive_point, tmp_path / "draft.yaml")
    draft = yaml.safe_load((tmp_path / "draft.yaml").read_text().replace("FILL_IN", "0"))
    assert [force["name"] for force in draft["forces"]] == ["1:+z force"]
    assert [each["name"] for each in draft["channels"]] == ["1:+z acceleration", "2:+z"]
    (drive_point / "campaign.yaml").write_text((tmp_path / "draft.yaml").read_text())
    with pytest.raises(ImportProblem, match="gap_m"):  # the one thing that the files do not say
        import_folder(drive_point)
    text = (tmp_path / "draft.yaml").read_text().replace("gap_m: FILL_IN", "gap_m: 2.0e-4")
    (drive_point / "campaign.yaml").write_text(text)
    assert import_folder(drive_point)[0].sizes["channel"] == 2


def late(folder, start):
    """A force, and the same 3 samples later as an acceleration that begins at `start` in s."""
    force = np.random.default_rng(3).standard_normal(SAMPLES)
    response = np.roll(force, 3)[round(start * RATE) :]
    write_uff(
        folder / "run.uff",
        record(force, 1, FORCE, "F"),
        record(response, 2, ACCELERATION, "A", start),
    )
    return force


@pytest.mark.parametrize("start", [0.0, 51 / RATE, 51 / RATE + 1.1e-5])
def test_channels_that_begin_later_are_aligned(tmp_path, start):
    force = late(tmp_path, start)
    campaign, rows = import_folder(tmp_path)
    first = round(start * RATE)
    np.testing.assert_allclose(force_signal(campaign, 0), force[first:], atol=1e-4)
    np.testing.assert_allclose(
        channel_signal(campaign, 0, 0)[3:], force_signal(campaign, 0)[:-3], atol=1e-4
    )
    told = "its first 51 samples are left out: another signal of the record begins later"
    assert (rows[0]["note"] == told) == (first == 51)


@pytest.mark.parametrize("start, told", [(51.4 / RATE, "51.40 samples apart"), (5.0, "its end")])
def test_channels_that_can_not_be_aligned_are_refused(tmp_path, start, told):
    late(tmp_path, 0.0)
    force, response = np.random.default_rng(4).standard_normal((2, SAMPLES))
    write_uff(
        tmp_path / "run.uff",
        record(force, 1, FORCE, "F"),
        record(response, 2, ACCELERATION, "A", start),
    )
    with pytest.raises(ImportProblem, match=rf"1:\+z of run.uff begins at 0 s.*{told}"):
        import_folder(tmp_path)


@pytest.mark.parametrize("step", [0.0, -1.0 / RATE])
def test_a_time_step_that_does_not_advance_is_refused(tmp_path, step):
    times = {"x": step * np.arange(SAMPLES), "abscissa_inc": step}
    still = record(np.arange(SAMPLES) * 1.0, 1, FORCE, "drive") | times
    write_uff(tmp_path / "low.uff", still)
    with pytest.raises(ImportProblem, match="its time step is .* correct the abscissa increment"):
        read_uff(tmp_path / "low.uff")

"""Measured frequency responses held to the linear model: two masses whose modes are known."""

import numpy as np
import pytest

from docs.examples import hammer_test
from tests.support.universal_file import UNCLOSED, dataset_58, write_uff
from vibroimpact.campaign.file import write_campaign
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.frf import read_frfs
from vibroimpact.cli import main
from vibroimpact.config.reading import load_config
from vibroimpact.diagnosis.measurement.linear_comparison import described, linear_comparison
from vibroimpact.io.signal_files.signals import ImportProblem

pytestmark = UNCLOSED

LINES = np.arange(0.0, 300.0, 0.25)  # Hz
STIFFER = 1.05  # of the springs to the ground: the first mode
MODES_HZ = np.sqrt(np.array([hammer_test.GROUND, hammer_test.GROUND + 2.0 * hammer_test.BETWEEN]))
MODES_HZ /= 2.0 * np.pi * np.sqrt(hammer_test.MASS)
DISPLACEMENT, VELOCITY, ACCELERATION, FORCE = 8, 11, 12, 13  # ordinate types
ORDERS = {DISPLACEMENT: 0, VELOCITY: 1, ACCELERATION: 2}


def responses(order, first=1.0):
    """(response, force, line) of both masses; first: factor on the frequency of the first mode."""
    shapes = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0 * hammer_test.MASS)
    poles = 2.0 * np.pi * MODES_HZ[:, None] * np.array([[first], [1.0]])
    s = 2j * np.pi * LINES
    modal = s**order / (s**2 + 2.0 * hammer_test.RATIO * poles * s + poles**2)
    return np.einsum("rm,fm,ml->rfl", shapes, shapes, modal)


def function(values, response, force, label, kind=ACCELERATION):
    """A frequency response of dataset 58 along x."""
    return dataset_58(
        values,
        LINES,
        response,
        1,
        func_type=4,
        ref_node=force,
        ref_dir=1,
        ord_data_type=6,
        abscissa_spec_data_type=18,
        abscissa_axis_units_lab="",
        ordinate_spec_data_type=kind,
        ordinate_axis_units_lab=label,
        orddenom_spec_data_type=FORCE,
    )


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "model.yaml"
    path.write_text(hammer_test.MODEL)
    return path


def compared(path, model):
    return linear_comparison(load_config(model), *described(*read_frfs(path)))


@pytest.mark.parametrize(
    "kind, label, factor",
    [
        (ACCELERATION, "m/s^2/N", 1.0),
        (ACCELERATION, "(g)/(lbf)", 9.80665 / 4.4482216152605),
        (VELOCITY, "mm/s/N", 1e-3),
        (DISPLACEMENT, "", 1.0),
    ],
)
def test_modes_are_those_of_the_closed_form(tmp_path, model, kind, label, factor):
    h1 = responses(ORDERS[kind], first=1.03) / factor
    path = write_uff(
        tmp_path / "frf.uff",
        function(h1[0, 0], 1, 1, label, kind),
        function(h1[1, 0], 2, 1, label, kind),
    )
    modes, checks = compared(path, model)
    assert checks == []
    assert [row["frequency_Hz"] for row in modes] == pytest.approx(MODES_HZ * [1.03, 1.0], rel=1e-4)
    assert [row["damping_ratio"] for row in modes] == pytest.approx([0.02, 0.02], rel=1e-2)
    assert [row["model_frequency_Hz"] for row in modes] == pytest.approx(MODES_HZ, rel=1e-9)
    assert [row["difference"] for row in modes] == pytest.approx([1 / 1.03 - 1.0, 0.0], abs=1e-4)
    assert [row["mac"] for row in modes] == pytest.approx([1.0, 1.0], abs=1e-4)


def test_a_roving_hammer_is_read_as_a_roving_sensor(tmp_path, model):
    h1 = responses(2)
    roving = write_uff(
        tmp_path / "roving.uff",
        function(h1[1, 0], 2, 1, "m/s^2/N"),
        function(h1[1, 1], 2, 2, "m/s^2/N"),
    )
    *_, channels, drive = read_frfs(roving)
    assert (drive.name, [each.name for each in channels]) == ("2:+x", ["1:+x", "2:+x"])
    modes, checks = compared(roving, model)
    assert checks == [] and [row["mac"] for row in modes] == pytest.approx([1.0, 1.0], abs=1e-4)


@pytest.mark.parametrize(
    "factor, told", [(-1.0, "moves against the model"), (9.80665, "as between g and m s-2")]
)
def test_a_channel_that_contradicts_the_model_is_told(tmp_path, model, factor, told):
    h1 = responses(2)
    path = write_uff(
        tmp_path / "frf.uff",
        function(h1[0, 0], 1, 1, "m/s^2/N"),
        function(factor * h1[1, 0], 2, 1, "m/s^2/N"),
    )
    _, checks = compared(path, model)
    assert [row["channel"] for row in checks] == ["2:+x"] and told in checks[0]["message"]


def test_responses_that_can_not_be_read_say_why(tmp_path):
    h1 = responses(2)
    first, second = function(h1[0, 0], 1, 1, "m/s^2/N"), function(h1[1, 1], 2, 2, "m/s^2/N")
    for functions, nodes, told in (
        ([first], False, "1:\\+x has no known place and direction: write datasets 15"),
        ([first, second], True, "has 2 forces and 2 responses"),
        ([first, first], True, "leave one frequency response of each"),
        ([function(h1[0, 0], 1, 1, "m/s/N")], True, "no acceleration.*label is 'm/s/N'"),
        ([function(h1[0, 0], 1, 1, "", FORCE)], True, "ordinate types 13 over 13"),
        ([], True, "holds no frequency response"),
    ):
        with pytest.raises(ImportProblem, match=told):
            read_frfs(write_uff(tmp_path / "wrong.uff", *functions, nodes=nodes))


def test_the_command_compares_responses_and_records(tmp_path, model, capsys):
    h1 = responses(2)
    frf = write_uff(
        tmp_path / "frf.uff",
        function(h1[0, 0], 1, 1, "m/s^2/N"),
        function(h1[1, 0], 2, 1, "m/s^2/N"),
    )
    assert main(["compare", str(frf), "--model", str(model)]) == 0
    told = capsys.readouterr().out.splitlines()
    assert len(told) == 3 and "27.566 Hz  2.00%" in told[1] and told[1].endswith("1.000")
    hammer_test.main(tmp_path / "bench")
    write_campaign(import_folder(tmp_path / "bench")[0], tmp_path / "bench.nc")
    assert main(["compare", str(tmp_path / "bench.nc"), "--model", str(model)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3
    with pytest.raises(ImportProblem, match="vibroimpact compare"):
        import_folder(_alone(tmp_path, frf))


def _alone(tmp_path, file):
    folder = tmp_path / "alone"
    folder.mkdir()
    (folder / file.name).write_bytes(file.read_bytes())
    return folder


@pytest.mark.parametrize("damage", ["no file", "no model", "elsewhere", "one blow"])
def test_what_can_not_be_compared_is_a_sentence(tmp_path, model, capsys, damage):
    h1 = responses(2)
    file = write_uff(tmp_path / "frf.uff", function(h1[0, 0], 1, 1, "m/s^2/N"))
    told = {
        "no file": "absent.uff",
        "no model": "absent.yaml",
        "elsewhere": "frf.uff: channel 1:+x: channel_point[0]",
        "one blow": "bench.nc: record soft holds 1 of the 3 blows",
    }[damage]
    if damage == "no file":
        file = tmp_path / "absent.uff"
    if damage == "no model":
        model = tmp_path / "absent.yaml"
    if damage == "elsewhere":
        model.write_text(hammer_test.MODEL.replace("drive: [0.0,", "drive: [0.1,"))
    if damage == "one blow":
        hammer_test.main(tmp_path / "bench")
        campaign = import_folder(tmp_path / "bench")[0].isel(time=slice(0, 1800))
        file = tmp_path / "bench.nc"
        write_campaign(campaign.drop_vars("load_rms"), file)
    assert main(["compare", str(file), "--model", str(model)]) == 1
    assert told in capsys.readouterr().err

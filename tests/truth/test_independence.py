"""The truth generator shares nothing with the library but the written contract."""

import ast
from pathlib import Path

import netCDF4
import numpy as np
import pytest

import vibroimpact_truth
from vibroimpact_truth.__main__ import main
from vibroimpact_truth.amounts import AMOUNTS
from vibroimpact_truth.draw import ARMS, arms, draw_plans
from vibroimpact_truth.hidden import EFFECTS, STRANGERS

PACKAGE = Path(vibroimpact_truth.__file__).parent
ROOT = PACKAGE.parents[1]


def imported(file):
    """Top-level packages that a file imports."""
    tops = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            tops |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            tops.add((node.module or "").split(".")[0])
    return tops


def test_truth_package_and_library_are_independent():
    files = sorted(PACKAGE.rglob("*.py"))
    assert len(files) > 10
    assert [file.name for file in files if "vibroimpact" in imported(file)] == []
    assert [
        file.name
        for file in (ROOT / "src" / "vibroimpact").rglob("*.py")
        if "vibroimpact_truth" in imported(file)
    ] == []


def test_compiled_code_is_in_one_file():
    assert [
        file.name for file in PACKAGE.rglob("*.py") if imported(file) & {"numba", "llvmlite"}
    ] == ["kernel.py"]


def test_every_effect_has_its_amounts():
    assert set(AMOUNTS) == set(EFFECTS) | set(STRANGERS)


def test_a_draw_depends_on_seed_and_number_alone():
    long, short = draw_plans(4, 60), draw_plans(4, 20)
    assert long[:20] == short
    assert draw_plans(5, 20) != short


def test_arms_keep_their_proportions():
    order = [arm for arm, _ in arms(sum(ARMS.values()))]
    assert {arm: order.count(arm) for arm in ARMS} == ARMS
    assert set(order[:24]) == set(ARMS)


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    """A short campaign with a hidden gap, with contact forces."""
    folder = tmp_path_factory.mktemp("sealed")
    main(
        [
            "one",
            "--out",
            str(folder / "x.nc"),
            "--effect",
            "gap",
            "--set",
            "factor=1.5",
            "--duration",
            "1",
            "--contact-force",
        ]
    )
    return folder


def test_the_file_keeps_the_contract(sealed):
    with netCDF4.Dataset(sealed / "x.nc") as file:
        sizes = {name: len(dim) for name, dim in file.dimensions.items()}
        assert sizes == {"record": 4, "force_channel": 1, "channel": 11, "time": 2048, "xyz": 3}
        assert (
            file["force"].dimensions == ("record", "force_channel", "time")
            and file["force"].units == "N"
        )
        assert file["response"].dimensions == ("record", "channel", "time")
        assert list(file["split"][:]) == ["fit", "fit", "fit", "holdout"]
        assert set(file["channel_kind"][:]) == {"acceleration", "contact_force"}
        np.testing.assert_allclose(np.linalg.norm(file["channel_direction"][:], axis=1), 1.0)
        np.testing.assert_allclose(file["load_rms"][:], [0.5, 3.0, 10.0, 10.0], rtol=1e-6)
        np.testing.assert_allclose(file["gap"][:], 0.02222 * np.array([0.013, 0.013, 0.013, 0.009]))
        assert np.isfinite(file["response"][:].filled(np.nan)).all()
        assert (file.sampling_frequency, file.antialias, file.start_up) == (2048.0, "fir80", "rest")


def test_campaign_file_does_not_reveal_the_truth(sealed):
    with netCDF4.Dataset(sealed / "x.nc") as file:
        told = " ".join(str(file.getncattr(name)) for name in file.ncattrs()) + " ".join(
            file.variables
        )
    assert "1.5" not in told and "factor" not in told
    assert '"gap"' in (sealed / "x.truth.json").read_text()


def test_finished_campaign_is_not_made_again(tmp_path, capsys):
    arguments = [
        "--out",
        str(tmp_path),
        "--seed",
        "2",
        "--count",
        "1",
        "--duration",
        "0.5",
        "--no-twin",
    ]
    main(arguments)
    stamp = (tmp_path / "campaign_s2_0000.nc").stat().st_mtime_ns
    main(arguments)
    assert (tmp_path / "campaign_s2_0000.nc").stat().st_mtime_ns == stamp
    assert capsys.readouterr().out.count("campaign_s2_0000.nc") == 1

"""The truth generator shares nothing with the library but the written contract."""

import ast
from pathlib import Path

import netCDF4
import numpy as np
import pytest

import evidence.truth
from evidence.truth import table
from evidence.truth.__main__ import main
from evidence.truth.amounts import AMOUNTS
from evidence.truth.campaign import Plan
from evidence.truth.draw import (
    OTHER_LAWS,
    POOLS,
    SHARES,
    STRANGERS,
    bare_plan,
    draw,
    kinds,
)
from evidence.truth.hidden import IN_RIG, family_of
from evidence.truth.measure import SENSOR_STRANGERS

PACKAGE = Path(evidence.truth.__file__).parent
ROOT = PACKAGE.parents[1]


def imported(file):
    """Top-level packages that a file imports."""
    return {name.split(".")[0] for name in names_imported(file)}


def names_imported(file):
    """Dotted names of the modules that a file imports."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names.add(node.module)
    return names


def test_truth_package_and_library_are_independent():
    files = sorted(PACKAGE.rglob("*.py"))
    assert len(files) > 10
    assert [file.name for file in files if "vibroimpact" in imported(file)] == []
    own = {name for file in files for name in names_imported(file) if name.startswith("evidence")}
    assert {name for name in own if not (name + ".").startswith("evidence.truth.")} == set()
    assert [
        file.name
        for file in (ROOT / "src" / "vibroimpact").rglob("*.py")
        if "evidence" in imported(file)
    ] == []


def test_compiled_code_is_in_one_file():
    assert [
        file.name for file in PACKAGE.rglob("*.py") if imported(file) & {"numba", "llvmlite"}
    ] == ["kernel.py"]


def test_every_effect_has_its_amounts():
    assert set(AMOUNTS) == set(IN_RIG) | set(SENSOR_STRANGERS)


@pytest.mark.parametrize("pool", POOLS)
def test_a_campaign_depends_on_its_number_alone(pool):
    once, again = draw(pool, 4, 9)[0], draw(pool, 4, 9)[0]
    assert once == again
    assert draw(pool, 5, 9)[0] != once and draw(pool, 4, 10)[0] != once


def test_kinds_keep_their_proportions():
    order = [kind for kind, _ in kinds(sum(SHARES.values()))]
    assert {kind: order.count(kind) for kind in SHARES} == SHARES
    assert set(order[:24]) == set(SHARES)


def test_acceptance_hides_laws_and_strangers_never_tuned_on():
    assert not set(OTHER_LAWS["development"]) & set(OTHER_LAWS["acceptance"])
    assert not set(STRANGERS["development"]) & set(STRANGERS["acceptance"])
    for pool in POOLS:
        assert all(family_of(name) for name in OTHER_LAWS[pool])
        assert not any(family_of(name) for name in STRANGERS[pool])


def test_draws_vary_what_users_vary():
    plans = [bare_plan("acceptance", 3, number)[0] for number in range(20)]
    assert {len(plan.beam.holders) for plan in plans} >= {1, 2, 3}
    assert min(len(plan.channels) for plan in plans) <= 3
    assert max(len(plan.channels) for plan in plans) >= 10
    assert {plan.start_up for plan in plans} == {"rest", "stationary"}
    assert len({plan.sampling for plan in plans}) > 4
    assert any(len({kind for *_, kind in plan.channels}) > 1 for plan in plans)
    assert all(10.0 <= plan.duration <= 60.0 for plan in plans)
    for plan in plans:  # no channel and no level at a place that the model names
        arcs = [at for at, *_ in plan.channels]
        named = [*plan.beam.places.values(), *(holder.arc for holder in plan.beam.holders)]
        assert np.abs(np.subtract.outer(arcs, named)).min() > 2.0e-3
        assert plan.sampling * 0.31 >= plan.band[1]
        assert plan.steps_per_second % (2 * plan.sampling) == 0


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


SHORT_BEAM = {"levels": ((0.05, 1.0, "fit"), (2.0, 1.0, "holdout")), "duration": 4.0}


@pytest.mark.slow
def test_finished_campaign_is_not_made_again(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(table, "tuned", lambda *_: Plan((2,), **SHORT_BEAM))
    main(["plan", "--seed", "2", "--count", "1", "--out", str(tmp_path / "plan.json")])
    arguments = ["make", "--plan", str(tmp_path / "plan.json"), "--out", str(tmp_path)]
    main(arguments)
    stamp = (tmp_path / "campaign_0000.nc").stat().st_mtime_ns
    main(arguments)
    assert (tmp_path / "campaign_0000.nc").stat().st_mtime_ns == stamp
    assert capsys.readouterr().out.count("campaign_0000.nc") == 1

"""Wear depth against published and derived values, and the wear life of a study."""

import csv

import numpy as np
import pytest
import xarray as xr
import yaml

import vibroimpact as vi
from tests.support.tiny_study import tiny_values
from vibroimpact.cli import main
from vibroimpact.wear.depth import YEAR_S, crescent_area, depth_of, segment_area, volume_of
from vibroimpact.wear.life import Service, wear_life

RATES = {4.0: (0.0, 1.0e-5), 20.0: (2.0e-3, 1.0e-3)}  # W at the two supports, by load


@pytest.fixture
def results(tmp_path):
    """The folder of a study with two seeds of two loads, one support of bars, one of a hole."""
    values = tiny_values()
    bar = {"kind": "bars", "normal": [0.0, 1.0, 0.0]}
    values["supports"][0] |= {"profile": bar}
    config = vi.check_config(values, "a study")
    (tmp_path / "records").mkdir()
    plain = config.model_dump(mode="json")
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(plain), encoding="utf-8")
    names = [support.name for support in config.supports]
    for load, rates in RATES.items():
        for seed, factor in enumerate((0.5, 1.5)):
            attributes = {"load_rms_N": load, "gap_m": 1e-4, "seed": seed}
            record = xr.Dataset(
                {"wear_work_rate": ("support", factor * np.array(rates), {"units": "W"})},
                coords={"support": names},
                attrs=attributes,
            )
            vi.write_record(record, tmp_path / "records" / f"load_{load}_seed_{seed}.nc")
    return tmp_path


def test_a_flat_bar_of_forty_years():
    """1 mW, K 20e-15 m2/N, 12 mm, a tube of 22.22 mm: 25.246 mm3, 484.2 um."""
    volume = 20e-15 * 1e-3 * 40.0 * YEAR_S
    assert volume == pytest.approx(25.246e-9, rel=1e-4)
    assert depth_of(volume, 0.012, 0.01111) == pytest.approx(484.2e-6, rel=1e-3)


def test_a_shallow_flat_is_that_of_code_aster():
    """zzzz405a, flat bar: d = (2R)^(-1/3) (3 V / 4 L)^(2/3), of a shallow segment."""
    volume, length, radius = 1e-9, 0.02, 0.01
    shallow = (2.0 * radius) ** (-1.0 / 3.0) * (0.75 * volume / length) ** (2.0 / 3.0)
    assert depth_of(volume, length, radius) == pytest.approx(shallow, rel=2e-3)


def test_a_bore_is_that_of_code_aster():
    """zzzz405a, bore of 2 m over 10 m, which takes 2 L A: 9.564534e-4 m."""
    volume = 1e-10 * 0.5 * 12.0 * 2.628e6
    assert depth_of(volume, 2.0 * 10.0, 1.0, 2.0) == pytest.approx(9.564534e-4, rel=2e-3)


def test_a_wide_bore_wears_as_a_flat_bar():
    flat, wide = segment_area(1e-4, 0.01), crescent_area(1e-4, 0.01, 1e3)
    assert wide == pytest.approx(flat, rel=1e-4)
    assert crescent_area(1e-4, 0.01, 0.0101) > 5.0 * flat


@pytest.mark.parametrize("bore", [np.inf, 0.0103])
def test_depth_and_volume_are_inverse(bore):
    for depth in (1e-6, 1e-4, 1e-3):
        assert depth_of(volume_of(depth, 0.02, 0.01, bore), 0.02, 0.01, bore) == pytest.approx(
            depth, rel=1e-6
        )
    assert depth_of(1.0, 0.02, 0.01, bore) == 0.01


def test_a_study_has_a_wear_life(results, capsys):
    table = results / "wear.csv"
    arguments = ["wear", str(results), "--coefficient", "1e-15", "2e-14", "--csv", str(table)]
    assert main(arguments) == 0
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == 4 and "10 µW" not in printed[2] and "2 mW" in printed[3]
    with open(table, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * 2 * 2
    assert [float(row["work_rate_W"]) for row in rows[-4::2]] == pytest.approx(RATES[20.0])
    assert float(rows[-1]["volume_m3"]) == pytest.approx(2e-14 * 1e-3 * 40.0 * YEAR_S)
    assert rows[0]["years_to_limit"] in ("inf", "")


def test_bars_wear_deeper_than_a_hole(results):
    """Twice the work on a flat goes more than twice as deep as on a crescent."""
    flat, hole = (row.depth_m for row in wear_life(results, Service((1e-15,)))[-2:])
    assert flat > 2.0 * hole


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--coefficient", "1"], "--coefficient 1 must"),
        (["--coefficient", "1e-15", "--duty", "2"], "--duty 2 must"),
        (["--coefficient", "1e-15", "--limit", "0"], "--limit 0 must"),
        (["--coefficient", "1e-15"], "there are no records"),
    ],
)
def test_bad_wear_is_refused(arguments, words, tmp_path, capsys):
    assert main(["wear", str(tmp_path), *arguments]) == 1
    assert words in capsys.readouterr().err


def test_the_limit_is_reached_after_the_years_told(results):
    worn = wear_life(results, Service((2e-14,)))[-2]
    again = wear_life(results, Service((2e-14,), years=worn.years_to_limit))[-2]
    assert again.wall_share == pytest.approx(0.4, rel=1e-6)

"""Wear depth against published and derived values, and the wear life of a study."""

import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
import yaml

import vibroimpact as vi
from tests.support.tiny_study import tiny_values
from vibroimpact.cli import main
from vibroimpact.config.reading import load_config
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.config.wear import Wear
from vibroimpact.io.provenance import config_digest
from vibroimpact.reports.wear_life import wear_sentences, wear_table
from vibroimpact.study.cases import all_cases
from vibroimpact.study.run_files import write_run_files
from vibroimpact.study.wear.command import wear_life
from vibroimpact.study.wear.laws import (
    YEAR_S,
    Archard,
    EdfMz,
    WornShape,
    crescent_area,
    depth_of,
    segment_area,
    volume_of,
)
from vibroimpact.study.wear.life import worn_life

ROOT = Path(__file__).parents[2]
RATES = {4.0: (0.0, 1.0e-5), 20.0: (2.0e-3, 1.0e-3)}  # W at the two supports, by load


def origin_of(config):
    """The attributes of a record that say which configuration it is of."""
    return {
        "config_digest": config_digest(stage_params(config, "simulate")),
        "model_digest": config_digest(stage_params(config, "basis")),
    }


@pytest.fixture
def results(tmp_path):
    """The folder of a study with two seeds of two loads, one support of bars, one of a hole."""
    values = tiny_values()
    bar = {"kind": "bars", "normal": [0.0, 1.0, 0.0]}
    values["supports"][0] |= {"profile": bar}
    config = vi.check_config(values, "a study")
    (tmp_path / "records").mkdir()
    write_run_files(tmp_path, config.model_dump(mode="json"), ["snakemake"])
    names = [support.name for support in config.supports]
    origin = origin_of(config)
    for case in all_cases(config.grid):
        rates = (0.5, 1.5)[case.seed] * np.array(RATES[case.load_rms_N])
        record = xr.Dataset(
            {"wear_work_rate": ("support", rates, {"units": "W"})},
            coords={"support": names},
            attrs={"load_rms_N": case.load_rms_N, "gap_m": case.gap_m, **origin},
        )
        vi.write_record(record, tmp_path / "records" / f"{case.id}.nc")
    return tmp_path


def test_a_shallow_flat_is_that_of_code_aster():
    """zzzz405a, flat bar: d = (2R)^(-1/3) (3 V / 4 L)^(2/3), of a shallow segment."""
    volume, length, radius = 1e-9, 0.02, 0.01
    shallow = (2.0 * radius) ** (-1.0 / 3.0) * (0.75 * volume / length) ** (2.0 / 3.0)
    assert depth_of(volume, WornShape(length, radius)) == pytest.approx(shallow, rel=2e-3)


def test_a_wide_bore_wears_as_a_flat_bar():
    flat, wide = segment_area(1e-4, 0.01), crescent_area(1e-4, 0.01, 1e3)
    assert wide == pytest.approx(flat, rel=1e-4)
    assert crescent_area(1e-4, 0.01, 0.0101) > 5.0 * flat


def slowing(power, time):
    """EDF_MZ as it is published: volume in m3 of a power in W after a time in s."""
    rate, N = 1e-13 * power**1.2, 2.44e-8
    x = 1.14e-16 / rate
    return rate * (x * time + (1.0 - x) * (1.0 - np.exp(-N * time)) / N)


@pytest.mark.parametrize("power", [5e-3, 0.5])
def test_the_time_of_the_slowing_law_is_inverse(power):
    times = np.geomspace(1e4, 1e11, 9)
    assert EdfMz().seconds(slowing(power, times), power) == pytest.approx(times, rel=1e-6)


def test_the_slowing_law_never_speeds_up():
    """At 0.1 mW the first rate holds for ever; without power nothing wears."""
    rate = 1e-13 * 1e-4**1.2
    assert EdfMz().seconds(np.array([1e-9]), 1e-4) == pytest.approx(1e-9 / rate, rel=1e-12)
    assert np.isinf(EdfMz().seconds(np.array([1e-9]), 0.0))


def test_a_bar_tilted_little_wears_as_a_flat_bar():
    volume, flat = 1e-9, WornShape(0.02, 0.01)
    tilted = WornShape(0.02, 0.01, tilt=1e-7)
    assert depth_of(volume, tilted) == pytest.approx(depth_of(volume, flat), rel=1e-3)
    assert depth_of(volume, WornShape(0.02, 0.01, tilt=0.02)) > 1.5 * depth_of(volume, flat)


def test_a_bar_that_wears_too_spares_the_tube():
    """Half of the volume is the bar's: d of the whole volume, times V_t / V_w."""
    volume, alone = 1e-9, WornShape(0.02, 0.01)
    shared = depth_of(volume, WornShape(0.02, 0.01, tube_share=0.5))
    assert shared == pytest.approx(0.5 * depth_of(2.0 * volume, alone), rel=1e-9)
    assert shared < depth_of(volume, alone)


@pytest.mark.parametrize(
    "shape",
    [
        WornShape(0.02, 0.01),
        WornShape(0.02, 0.01, 0.0103),
        WornShape(0.02, 0.01, tilt=0.01, tube_share=0.6),
    ],
)
def test_depth_and_volume_are_inverse(shape):
    for depth in (1e-6, 1e-4, 1e-3):
        assert depth_of(float(volume_of(depth, shape)), shape) == pytest.approx(depth, rel=1e-6)
    assert depth_of(1.0, shape) == 0.01 * shape.tube_share


def test_a_growing_gap_changes_the_depth_as_its_equation_says():
    """With P = P0 (1 + d / a), dV = K P dt: t is the integral of dV / (K P) over depth."""
    shape, power, scale, K = WornShape(0.02, 0.01), 2e-3, 2e-4, 1e-14
    wear = Wear(years=30.0)
    volume, depth, _, _ = worn_life(
        Archard(K), lambda depth: power * (1.0 + depth / scale), shape, 1.27e-3, wear
    )
    depths = np.linspace(0.0, depth, 20001)
    worn = np.diff(volume_of(depths, shape))
    middle = 0.5 * (depths[1:] + depths[:-1])
    seconds = (worn / (K * power * (1.0 + middle / scale))).sum()
    assert seconds == pytest.approx(30.0 * YEAR_S, rel=2e-4)
    assert volume > 1.5 * K * power * 30.0 * YEAR_S


def test_a_study_has_a_wear_life(results, capsys):
    table = results / "wear.csv"
    arguments = ["wear", str(results), "--coefficient", "1e-15", "2e-14", "--csv", str(table)]
    assert main(arguments) == 0
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == 4 and "10 µW" not in printed[2] and "2 mW" in printed[3]
    with open(table, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * 2 * 2 and {row["land"] for row in rows} == {"1"}
    assert [float(row["work_rate_W"]) for row in rows[-4::2]] == pytest.approx(RATES[20.0])
    assert float(rows[-1]["volume_m3"]) == pytest.approx(2e-14 * 1e-3 * 40.0 * YEAR_S)
    assert rows[0]["years_to_limit"] in ("inf", "")


def test_bars_wear_deeper_than_a_hole(results):
    """Twice the work on a flat goes more than twice as deep as on a crescent."""
    flat, hole = (
        row.depth_m for row in wear_life(results, Wear(coefficient_m2_per_N=(1e-15,)))[-2:]
    )
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


def test_the_limit_is_reached_after_its_years(results):
    worn = wear_life(results, Wear(coefficient_m2_per_N=(2e-14,)))[-2]
    again = wear_life(results, Wear(coefficient_m2_per_N=(2e-14,), years=worn.years_to_limit))[-2]
    assert again.wall_share == pytest.approx(0.4, rel=1e-6)


@pytest.mark.parametrize(
    "key", ["coefficient_m2_per_N", "years", "duty", "wall_limit", "tilt_deg", "tube_share"]
)
def test_every_number_of_the_section_acts(results, key):
    """The property that tests/properties/test_every_key_acts.py asks of the other sections."""
    values = {"coefficient_m2_per_N": (1e-15,), "years": 30.0, "duty": 0.8, "wall_limit": 0.3}
    values |= {"tilt_deg": 0.5, "tube_share": 0.6}
    moved = values | {key: (1.1e-15,) if key == "coefficient_m2_per_N" else 1.1 * values[key]}
    assert wear_life(results, Wear(**values)) != wear_life(results, Wear(**moved))


def test_lands_have_their_own_rows(results):
    """Bars on both sides: all work on the second land, none on the first."""
    for path in (results / "records").glob("*.nc"):
        record = vi.read_record(path).load()
        rates = record["wear_work_rate"].values
        lands = np.stack([np.zeros(2), rates], axis=1)
        record["land_work_rate"] = (("support", "land"), lands, {"units": "W"})
        path.unlink()
        vi.write_record(record, path)
    rows = wear_life(results, Wear(coefficient_m2_per_N=(1e-15,)))
    assert {row.land for row in rows} == {2}
    assert [row.work_rate_W for row in rows[-2:]] == pytest.approx(RATES[20.0])


def test_without_coefficients_the_depth_is_a_range(results, capsys):
    """The published pairs of the shape of each support; of all shapes for a hole."""
    rows = wear_life(results, Wear())
    first, second = (
        [row for row in rows if row.load_rms_N == 20.0 and row.support == name]
        for name in dict.fromkeys(row.support for row in rows)
    )
    assert len(first) == 4 and len(second) == 8
    assert max(row.depth_m for row in first) > 10.0 * min(row.depth_m for row in first)
    assert main(["wear", str(results), "--slowing", "--coefficient", "1e-15"]) == 0
    assert " to " in capsys.readouterr().out.splitlines()[3]


def test_a_growing_gap_takes_the_work_of_the_larger_gap(results):
    """The study has a second gap, at which the supports work twice as hard."""
    values = load_config(results / "config.yaml").model_dump(mode="json")
    values["grid"]["gap_m"] = [1e-4, 1.5e-4]
    write_run_files(results, values, ["snakemake"])
    origin = origin_of(load_config(results / "config.yaml"))
    for path in sorted((results / "records").glob("*.nc")):
        record = vi.read_record(path).load().assign_attrs(origin)
        path.unlink()
        vi.write_record(record, path)
        record["wear_work_rate"] = 2.0 * record["wear_work_rate"].assign_attrs(units="W")
        record["wear_work_rate"].attrs["units"] = "W"
        record.attrs["gap_m"] = 1.5e-4
        vi.write_record(record, path.with_name(path.name.replace("gap_0.0001", "gap_0.00015")))
    keys = {"coefficient_m2_per_N": (2e-14,), "years": 5.0}
    fixed, grown = (wear_life(results, Wear(gap_grows=grows, **keys)) for grows in (False, True))
    ratios = [
        new.volume_m3 / old.volume_m3
        for new, old in zip(grown, fixed, strict=True)
        if old.volume_m3
    ]
    assert 1.2 < max(ratios) < 2.0 and ratios[-1] == pytest.approx(1.0, rel=1e-9)


def test_the_page_tells_the_wear_life(results):
    """A sentence with the deepest land, and a table with a row per load, support and land."""
    rows = wear_life(results, Wear(coefficient_m2_per_N=(1e-15, 1e-14)))
    config = SimpleNamespace(wear=Wear(years=30.0))
    (sentence,) = wear_sentences(rows, config, "N")
    assert f"at land 1 of {rows[0].support}, 20 N RMS" in sentence and "30 years" in sentence
    table = wear_table(rows, 1e-4, [20.0], "N")
    assert [row[1:4] for row in table.rows] == [
        (rows[0].support, "1", "2"),
        (rows[2].support, "1", "1"),
    ]
    assert " to " in table.rows[0][4] and table.rows[0][4].split(" to ")[0] in sentence
    idle = wear_table(rows, 1e-4, [4.0], "N").rows[0]
    assert idle[4:] == ("0", "0", "never") and wear_sentences([], config, "N") == []


def test_only_a_tube_wears():
    config = yaml.safe_load((ROOT / "config/examples/mass_between_stops.yaml").read_text())
    with pytest.raises(vi.ConfigError, match="wear = .* is of the wall of a tube"):
        vi.check_config(config | {"wear": {}}, "a mass")


def test_single_steps_have_no_wear_life():
    values = tiny_values(wear={}, identification=None)
    values["record"] |= {"every_step": True}
    with pytest.raises(vi.ConfigError, match="every_step = True gives no wear work rate"):
        vi.check_config(values, "a study")


def answer_after(results, key, value, capsys):
    """(exit code, errors) of the command after a run of a changed configuration was killed."""
    values = load_config(results / "config.yaml").model_dump(mode="json")
    *sections, last = key.split(".")
    level = values
    for name in sections:
        level = level[int(name) if name.isdigit() else name]
    level[last] = value
    write_run_files(results, values, ["snakemake"])
    code = main(["wear", str(results), "--coefficient", "1e-15"])
    return code, capsys.readouterr().err


@pytest.mark.parametrize(
    ("key", "value"),
    [("seed", 5), ("record.duration_s", 9.0), ("supports.0.stiffness_N_per_m", 3e6)],
)
def test_records_of_another_configuration_are_refused(results, key, value, capsys, reliability):
    """A key of the simulation, and one of the model alone."""
    code, errors = answer_after(results, key, value, capsys)
    assert code == 1 and "_seed_0.nc: is of another configuration than" in errors
    assert f"{results / 'provenance.json'} to the end first" in errors
    reliability.fault(
        "a run of a changed configuration is killed, and the old records stand",
        "`vibroimpact wear` refuses them",
    )


def test_keys_that_a_record_does_not_depend_on_may_change(results, capsys):
    assert answer_after(results, "spectra.overlap", 0.5, capsys) == (0, "")


def test_a_study_without_all_its_records_is_refused(results, capsys):
    assert answer_after(results, "grid.load_rms_N", [4.0], capsys) == (0, "")
    code, errors = answer_after(results, "grid.load_rms_N", [4.0, 8.0], capsys)
    assert code == 1 and "load_8_gap_0.0001_seed_0.nc: is missing, one of 2 of the 4" in errors

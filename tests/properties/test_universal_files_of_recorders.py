"""Universal files as recorders write them: refused, or the signals that were written, in SI."""

import numpy as np
import pytest
import pyuff
from hypothesis import given
from hypothesis import strategies as st

from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.properties.recorder_files import EITHER, REFUSED, RIGHT
from tests.support.universal_file import UNCLOSED, dataset_58
from vibroimpact.campaign.importing.uff import read_uff
from vibroimpact.io.signal_files.signals import ImportProblem
from vibroimpact.io.units import si_factor

pytestmark = UNCLOSED
RATE, SAMPLES, OFFSET_MM = 512.0, 96, 250.0
FORCE, ACCELERATION = 13, 12
# {habit: [(how, what is owed)]}, the usual first.
HABITS = {
    "binary": [(0, RIGHT), (1, RIGHT)],
    "byte_ordering": [(1, RIGHT), (2, RIGHT)],
    "ord_data_type": [(4, RIGHT), (2, RIGHT), (5, REFUSED)],
    "abscissa_spacing": [(1, RIGHT), (0, RIGHT)],
    "func_type": [(1, RIGHT), (0, RIGHT), (2, REFUSED), (4, REFUSED), (6, REFUSED)],
    "rsp_dir": [(2, RIGHT), (-2, RIGHT), (1, RIGHT), (-3, RIGHT), (0, RIGHT), (4, RIGHT)],
    "abscissa_axis_units_lab": [("s", RIGHT), ("ms", RIGHT), ("NONE", RIGHT), ("Hz", REFUSED)],
    "ordinate_axis_units_lab": [
        *((label, RIGHT) for label in ("m/s^2", "g", "mm/s^2", "m/s²", "NONE", "g's", "")),
        ("furlong", EITHER),
    ],
    "abscissa_min": [(0.0, RIGHT), (3.0, RIGHT), (-1.0, RIGHT)],
    "step": [("right", RIGHT), ("0", REFUSED), ("negative", REFUSED), ("nan", REFUSED)],
    "abscissa_spec_data_type": [(17, RIGHT), (0, RIGHT), (18, REFUSED)],
    "samples": [(SAMPLES, RIGHT), (SAMPLES - 1, EITHER), (SAMPLES + 1, REFUSED), (-1, REFUSED)],
    "units": [(None, RIGHT), ("mm", RIGHT), ("m", RIGHT)],
    "lines": [("\n", RIGHT), ("\r\n", RIGHT)],
    "sets": [("two", RIGHT), ("the same twice", RIGHT), ("the last one cut", REFUSED)],
}


def drawn(draw):
    """({habit: how}, what is owed) with up to two habits that are not usual."""
    odd = draw(st.lists(st.sampled_from([*HABITS]), max_size=2, unique=True))
    chosen = {
        habit: draw(st.sampled_from(ways[1:])) if habit in odd else ways[0]
        for habit, ways in HABITS.items()
    }
    owes = {owed for _, owed in chosen.values()}
    owed = REFUSED if REFUSED in owes else EITHER if EITHER in owes else RIGHT
    return {habit: how for habit, (how, _) in chosen.items()}, owed


def datasets(how, values):
    """The datasets of a file: units and nodes where it has them, a force, an acceleration."""
    if how["units"]:
        per_m = {"mm": 1e3, "m": 1.0}[how["units"]]
        yield pyuff.prepare_164(
            units_code=5, units_description=how["units"], temp_mode=1, length=per_m, force=1.0,
            temp=1.0, temp_offset=0.0,
        )  # fmt: skip
        place = np.array([0.0, 1e-3 * OFFSET_MM * per_m])
        yield pyuff.prepare_15(
            node_nums=[1, 2], def_cs=[0, 0], disp_cs=[0, 0], color=[1, 1],
            x=place, y=0.0 * place, z=0.0 * place,
        )  # fmt: skip
    second = {"ms": 1e-3}.get(how["abscissa_axis_units_lab"], 1.0)
    for node, (type_, row) in enumerate(zip((FORCE, ACCELERATION), values, strict=True), start=1):
        label = "N" if type_ == FORCE else how["ordinate_axis_units_lab"]
        data = row.astype(complex) if how["ord_data_type"] == 5 else row
        direction = how["rsp_dir"] if type_ == ACCELERATION else 2
        time = (how["abscissa_min"] + np.arange(SAMPLES) / RATE) / second
        same = ("binary", "func_type", "byte_ordering", "ord_data_type", "abscissa_spacing")
        same += ("abscissa_spec_data_type", "abscissa_axis_units_lab")
        units = {"ordinate_spec_data_type": type_, "ordinate_axis_units_lab": label}
        units |= {"abscissa_inc": 1.0 / RATE / second, **{name: how[name] for name in same}}
        yield dataset_58(data, time, node, direction, id1=f"signal {node}", **units)


def write(path, how, values):
    """Write the file."""
    sets = [*datasets(how, values)]
    if how["sets"] == "the same twice":
        sets.append(sets[-1])
    pyuff.UFF(str(path)).write_sets(sets, "add")
    content = _header_changed(path.read_bytes(), how)
    if how["lines"] != "\n" and not how["binary"]:
        content = content.replace(b"\r\n", b"\n").replace(b"\n", how["lines"].encode())
    if how["sets"] == "the last one cut":
        content = content[: len(content) - 300]
    path.write_bytes(content)


def _header_changed(content, how):
    """The bytes with another number of samples or step in the headers: pyuff writes right ones."""
    second = {"ms": 1e-3}.get(how["abscissa_axis_units_lab"], 1.0)
    step = f"{1.0 / RATE / second:.5e}"
    other = {"right": f" {step}", "0": f" {0.0:.5e}", "negative": f"-{step}", "nan": f"{'nan':>12}"}
    content = content.replace(f" {step}".encode(), other[how["step"]].encode())
    return content.replace(f"{SAMPLES:10d}".encode(), f"{how['samples']:10d}".encode())


def owed_here(how, owed):
    """What is owed, where habits decide together."""
    uneven = how["abscissa_spacing"] == 0
    if uneven and how["step"] != "right":  # it is not read
        return EITHER
    time = how["abscissa_axis_units_lab"] in ("s", "ms", "NONE")
    if how["abscissa_spec_data_type"] == 18 or (how["abscissa_spec_data_type"] == 0 and not time):
        return REFUSED
    return owed


def unit_of(how):
    """The unit of the acceleration as the file states it, "" for none."""
    label = how["ordinate_axis_units_lab"].strip()
    if label in ("", "NONE"):
        return {"mm": "mm s-2", "m": "m s-2", None: ""}[how["units"]]
    return label


def test_universal_files_of_recorders_are_refused_or_right(reliability):
    tried = Tried()
    noise = np.random.default_rng(3).standard_normal((2, SAMPLES)).round(5)

    @given(st.data())
    def check(data):
        how, owed = drawn(data.draw)
        owed = owed_here(how, owed)
        with folder_of_example() as folder:
            path = folder / "run.uff"
            if how["binary"] and how["ord_data_type"] == 5:
                return  # pyuff writes no such file
            write(path, how, noise)
            outcome, result = tried.add(
                guarded(lambda: read_uff(path), ImportProblem, [folder], ["run.uff"])
            )
        told = {habit: way for habit, way in how.items() if way != HABITS[habit][0][0]}, owed
        if outcome == "refused":
            assert owed != RIGHT, (told, result)
            return
        assert owed != REFUSED, told
        force, *others = result
        even = how["abscissa_spacing"] == 1  # else times of six digits say the rate
        assert len({signal.name for signal in result}) == len(result), told
        for signal, written in zip((force, others[0]), noise, strict=True):
            assert signal.rate == pytest.approx(RATE, rel=1e-5 if even else 1e-3), told
            np.testing.assert_allclose(signal.values, written, rtol=1e-4, atol=1e-4)
        assert force.force and not any(signal.force for signal in others), told
        axis = how["rsp_dir"]
        expected = np.sign(axis) * np.eye(3)[abs(axis) - 1] if 0 < abs(axis) < 4 else None
        found = others[0].direction
        assert (found is None) == (expected is None) and np.all(found == expected), told
        if how["ordinate_axis_units_lab"] != "furlong" and unit_of(how):
            factor = si_factor(unit_of(how), "acceleration")
            assert si_factor(others[0].unit, "acceleration") == pytest.approx(factor), told
        else:
            assert others[0].unit in ("", "furlong"), told
        if how["units"]:
            np.testing.assert_allclose(others[0].point, (1e-3 * OFFSET_MM, 0, 0), err_msg=str(told))

    check()
    reliability.inputs("universal files of recorders: types, units, nodes, steps, signs", tried)

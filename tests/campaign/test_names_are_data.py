"""Names of channels and records are data: figures and tables show them letter by letter."""

import csv

import pytest
import yaml
from matplotlib.text import Text

from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.importing.sidecar import read_sidecar
from vibroimpact.io.records import read_table, write_table
from vibroimpact.io.signal_files.signals import ImportProblem
from vibroimpact.reports.figures.drawing import drawn
from vibroimpact.reports.figures.quicklook import quicklook

NAMES = ["=1+2", "+low", "-tip", "@shaker", "'=1", "''+x", "'x", "-", "plain", "-1.5", "\tx", "+ y"]


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_a_text_in_a_table_and_comes_back(tmp_path, name):
    path = tmp_path / "table.csv"
    write_table([{"name": name, "value": -1.5}], path)
    assert read_table(path, ("name",)) == [{"name": name, "value": -1.5}]
    cell, number = list(csv.reader(path.read_text().splitlines()))[1]
    assert cell in ("-", "-1.5") or cell[0] not in "=+-@\t"  # no formula for a spreadsheet
    assert number == "-1.5"


@pytest.mark.parametrize("character", ["\x07", "\u202e", "\u200f"])
def test_a_name_that_can_not_be_shown_is_refused(tmp_path, character):
    path = tmp_path / "campaign.yaml"
    sensor = {"name": f"tip{character}x", "unit": "N", "point_m": [0, 0, 0], "direction": "y"}
    channel = sensor | {"name": "top", "unit": "m", "kind": "displacement"}
    content = {"forces": [sensor], "channels": [channel], "records": [{"name": "a", "file": "a"}]}
    path.write_text(yaml.safe_dump(content, allow_unicode=True))
    with pytest.raises(ImportProblem, match=r"forces\[0\].name|can not be read"):
        read_sidecar(path)


def test_names_are_drawn_letter_by_letter(tmp_path):
    # matplotlib would set what is between two $ as mathematics, and raise where it is none.
    campaign = sound_campaign()
    campaign["channel_name"].values[:] = ["$x_{$", "=1+2", "tip <b>"]
    campaign["record_name"].values[:] = ["+low", "$\\frac$", "@high"]
    sheet = drawn(quicklook(campaign))
    sheet.save(tmp_path)
    texts = sheet.figure.findobj(Text)
    assert any(text.get_text().startswith("$x_{$, acceleration") for text in texts)
    assert not any(text.get_parse_math() for text in texts)
    rows = read_table(tmp_path / "quicklook.csv", ("curve",))
    assert {"+low", "$\\frac$", "@high"} <= {row["curve"] for row in rows}

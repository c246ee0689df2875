"""Suites of other seeds or longer records: their names, their seeds, and how they are held against
the plain one.
"""

import json

import pytest

from tests.unit.test_suite_page import effect, truth_of, verdict_of
from vibroimpact.acceptance.shards import suite_name, suite_of
from vibroimpact.acceptance.verdict_agreement import AGREE, agreement, differences
from vibroimpact.discrepancy.workbench import Workbench
from vibroimpact.verdict.file import write_verdict

FOUND = effect("dry_friction", "mu", 0.2, 0.16, 0.24)
MOVED = effect("dry_friction", "mu", 0.22, 0.2, 0.24)


@pytest.mark.parametrize(
    ("seed", "seconds", "draw"), [(5, 20, 0), (5, 49, 0), (5, 20, 2), (3812913005, 49, 1)]
)
def test_a_suite_is_known_by_its_name(seed, seconds, draw):
    assert suite_of(suite_name(seed, seconds, draw)) == {
        "seed": seed,
        "seconds": seconds,
        "draw": draw,
    }


def test_the_plain_suite_has_the_plain_name():
    assert suite_name(5) == "suite_5"


def test_draws_share_no_seed():
    class Bench:
        draw = 0
        signals = type("Signals", (), {"gap": [1e-4, 2e-4]})

    seeds = []
    for draw in (0, 1, 2):
        Bench.draw = draw
        seeds.append(
            {
                seed
                for first in (0, 900, 20000)
                for _, _, seed in Workbench.runs(Bench, [0, 1], 16, first)
            }
        )
    assert seeds[0] & set(range(16)) and not seeds[0] & seeds[1] and not seeds[1] & seeds[2]


def written(folder, verdicts):
    """A folder of a suite: friction hidden in every campaign."""
    for number, verdict in enumerate(verdicts):
        name = f"campaign_{number:04d}"
        (folder / name).mkdir(parents=True)
        write_verdict(verdict, folder / name / "verdict.json")
        (folder / "truth").mkdir(exist_ok=True)
        (folder / "truth" / f"{name}.json").write_text(
            json.dumps(truth_of("strong", ("dry_friction", {"mu": 0.2})))
        )
    return folder


def test_verdicts_of_two_suites_are_compared(tmp_path):
    friction, lobes = ["dry_friction"], ["foliate_obstacle"]
    plain = written(
        tmp_path / "plain",
        [
            verdict_of("named", [friction], [FOUND]),
            verdict_of("ambiguous", [friction, lobes]),
            verdict_of("unknown"),
            verdict_of("named", [lobes]),
        ],
    )
    other = written(
        tmp_path / "other",
        [
            verdict_of("named", [friction], [MOVED]),
            verdict_of("named", [lobes]),
            verdict_of("unknown"),
            verdict_of("unknown"),
        ],
    )
    rows = differences(plain, other, [f"campaign_{number:04d}" for number in range(4)])
    assert [[row[quantity] for quantity in AGREE] for row in rows] == [
        [True, True, True, True],
        [False, False, True, False],
        [True, True, True, True],
        [False, False, False, True],
    ]
    assert (
        rows[0]["moved_in_widths"] == pytest.approx(0.25)
        and rows[0]["other_value"] == 0.22
        and rows[1]["parameter"] == ""
    )
    rate = {row["quantity"]: row for row in agreement(rows)}
    same = rate["same verdict"]
    assert same["rate"] == 0.5 and same["low"] < 0.5 < same["high"] and same["campaigns"] == 4
    assert (rows[1]["verdict"], rows[1]["other_verdict"]) == ("ambiguous", "named")


def test_campaigns_that_one_suite_lacks_are_no_difference(tmp_path):
    plain = written(tmp_path / "plain", [verdict_of("unknown")])
    with pytest.raises(KeyError, match="campaign_0001"):
        differences(plain, plain, ["campaign_0001"])

"""The coefficients of the Silverbox beside those that the benchmark's authors publish.

python examples/silverbox/published.py TABLE.csv VERDICT.json COMPLETED.json
"""

import sys

from vibroimpact.completion.store import read_values
from vibroimpact.records import write_table
from vibroimpact.verdict.file import read_verdict

# u = mass y'' + damping y' + stiffness y + quadratic y² + cubic y³, volts and seconds. Source: Noel
# and Schoukens, Int. J. Control 2017.
PUBLISHED = {"cubic": 3.97, "quadratic": -0.26, "frequency_Hz": 68.58, "damping_ratio": 0.0468}


def silverbox_table(verdict, completed):
    """Return rows {quantity, identified, low, high, published, relative_difference} from a Verdict
    and the values of its completed model.
    """
    modes = completed["trial"]["modes"]
    found = {
        "frequency_Hz": (modes["frequency"][0],) * 3,
        "damping_ratio": (modes["damping_ratio"][0],) * 3,
    }
    for effect in verdict.effects:
        for name, each in effect.parameters.items():
            found[name.removesuffix("_stiffness")] = each.value, each.low, each.high
    return [
        {
            "quantity": name,
            "identified": value,
            "low": low,
            "high": high,
            "published": PUBLISHED.get(name, float("nan")),
            "relative_difference": (
                value / PUBLISHED[name] - 1.0 if name in PUBLISHED else float("nan")
            ),
        }
        for name, (value, low, high) in found.items()
    ]


if __name__ == "__main__":
    table_file, verdict_file, completed_file = sys.argv[1:]
    rows = silverbox_table(read_verdict(verdict_file), read_values(completed_file))
    write_table(rows, table_file)

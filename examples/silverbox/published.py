"""The coefficients of the Silverbox beside those that the benchmark's authors publish.

    python examples/silverbox/published.py TABLE.csv RESULTS

RESULTS: the folder of results of the campaign, with verdict.json and model_updated.yaml.
"""

import sys
from pathlib import Path

from vibroimpact.config.reading import read_yaml
from vibroimpact.diagnosis.verdict.content import read_verdict
from vibroimpact.io.records import write_table

# u = mass y'' + damping y' + stiffness y + quadratic y² + cubic y³, volts and seconds. Source: Noel
# and Schoukens, Int. J. Control 2017.
PUBLISHED = {"cubic": 3.97, "quadratic": -0.26, "frequency_Hz": 68.58, "damping_ratio": 0.0468}


def silverbox_table(verdict, model):
    """Return rows {quantity, identified, low, high, published, relative_difference} from a Verdict
    and the values of its completed model.
    """
    mode = model["structure"]["modes"][0]
    found = {name: (mode[name],) * 3 for name in ("frequency_Hz", "damping_ratio")}
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
    table_file, results = sys.argv[1:]
    folder = Path(results)
    completed = read_yaml(str(folder / "model_updated.yaml"))
    write_table(silverbox_table(read_verdict(folder / "verdict.json"), completed), table_file)

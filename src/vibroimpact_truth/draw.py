"""The seeded draw: which campaigns a seed stands for, over the arms of the acceptance table in
their proportions.

Any first N campaigns of a seed keep the proportions of the arms as well as N allows, and every arm
walks through its effects in a shuffled order before it repeats one. A campaign depends on the seed
and its number alone, so shards and counts do not change it.
"""

import numpy as np

from vibroimpact_truth.amounts import AMOUNTS
from vibroimpact_truth.campaign import CHANNELS, LEVELS, Plan
from vibroimpact_truth.hidden import EFFECTS, STRANGERS

# Campaigns of each arm in the full table; "left_out" is the true effect taken out of the catalogue
# of who judges.
ARMS = {
    "null": 60,
    "strong": 60,
    "medium": 60,
    "stranger": 40,
    "two": 30,
    "left_out": 20,
    "alias": 24,
    "fault": 24,
}
ALIASES = (
    ("gap", "sensor_gain"),
    ("hertz", "contact_stiffness"),
    ("hunt_crossley", "contact_damping"),
    ("added_mass", "mode_frequency_error"),
)
FAULTS = ("sensor_gain", "swap", "clip", "sensor_delay", "dropout")
NAMES = [f"{place}_{axis}" for place, axis in CHANNELS]
VERTICAL = [name for name in NAMES if name.endswith("y")]  # those that see something at every level


def arms(count):
    """(count,) the arm of every campaign: always the one that lags farthest behind its share."""
    total, given, order = sum(ARMS.values()), dict.fromkeys(ARMS, 0), []
    for number in range(count):
        arm = max(ARMS, key=lambda name: ARMS[name] * (number + 1) / total - given[name])
        given[arm] += 1
        order.append((arm, given[arm] - 1))
    return order


def cycled(seed, arm, items, number):
    """The item of an arm's number-th campaign: a shuffled pass through all items after another."""
    turn, place = divmod(number, len(items))
    return items[
        np.random.default_rng([seed, list(ARMS).index(arm), turn]).permutation(len(items))[place]
    ]


def amount_of(effect, which, rng):
    """(id, parameters) of an effect at "medium" or "strong", log-uniform within its range."""
    row = AMOUNTS[effect]
    low, high = sorted(getattr(row, which) or row.medium)
    return effect, row.parameters(float(np.exp(rng.uniform(np.log(low), np.log(high)))), rng)


def instrument(name, rng):
    """(id, parameters) of a fault of a measuring chain."""
    channel, other = rng.choice(VERTICAL, 2, replace=False)
    factor = float(rng.choice([rng.uniform(0.5, 0.8), rng.uniform(1.25, 2.0)]))
    return (
        name,
        {
            "sensor_gain": {"channel": str(channel), "factor": factor},
            "sensor_delay": {"channel": str(channel), "delay": float(rng.uniform(2e-3, 1e-2))},
            "swap": {"channel": str(channel), "other": str(other)},
            "clip": {"channel": str(channel), "fraction": float(rng.uniform(0.2, 0.5))},
            "dropout": {
                "channel": str(channel),
                "start": float(rng.uniform(0.2, 0.7)),
                "duration": float(rng.uniform(0.5, 2.0)),
            },
        }[name],
    )


def hidden_in(seed, arm, number, rng):
    """((id, parameters), ...) hidden in the number-th campaign of an arm."""
    able = [effect for effect in EFFECTS if AMOUNTS[effect].strong]
    if arm == "null":
        return ()
    if arm in ("strong", "left_out"):
        return (amount_of(cycled(seed, arm, able, number), "strong", rng),)
    if arm == "medium":
        return (amount_of(cycled(seed, arm, list(EFFECTS), number), "medium", rng),)
    if arm == "stranger":
        return (amount_of(cycled(seed, arm, list(STRANGERS), number), "strong", rng),)
    if arm == "two":
        first, second = rng.choice(able, 2, replace=False)
        return (amount_of(str(first), "strong", rng), amount_of(str(second), "strong", rng))
    if arm == "alias":
        effect = cycled(seed, arm, [effect for pair in ALIASES for effect in pair], number)
        if effect == "sensor_gain":
            return (
                (
                    "sensor_gain",
                    {
                        "channel": "all",
                        "factor": float(
                            rng.choice([rng.uniform(0.6, 0.75), rng.uniform(1.3, 1.6)])
                        ),
                    },
                ),
            )
        return (amount_of(effect, "strong", rng),)
    return (instrument(cycled(seed, arm, FAULTS, number), rng),)


def drawn(seed, count, **common):
    """The first `count` Plans of a seed; common: fields of Plan that all share (duration, tube,
    levels, ...).
    """
    plans = []
    for index, (arm, number) in enumerate(arms(count)):
        effects = hidden_in(seed, arm, number, np.random.default_rng([seed, index, 7]))
        plans.append(Plan((seed, index), effects, arm, **{"levels": LEVELS, **common}))
    return plans

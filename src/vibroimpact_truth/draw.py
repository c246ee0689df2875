"""The seeded draw: the campaigns of a seed, over the arms of the acceptance table.

The first N campaigns of a seed have the proportions of the arms as closely as N allows. Every arm
goes through its effects in a shuffled order before it repeats one. A campaign depends on the seed
and its number alone: shards and counts do not change it.
"""

import numpy as np

from vibroimpact_truth.amounts import AMOUNTS
from vibroimpact_truth.campaign import CHANNELS, LEVELS, Plan
from vibroimpact_truth.hidden import EFFECTS, STRANGERS

# Campaigns of each arm in the full table. In "left_out" the true effect is missing from the
# catalogue that is searched.
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
VERTICAL = [name for name in NAMES if name.endswith("y")]  # channels with a signal at every level


def arms(count):
    """(count,) pairs (arm, number within the arm): always the arm farthest behind its share."""
    total, given, order = sum(ARMS.values()), dict.fromkeys(ARMS, 0), []
    for number in range(count):
        arm = max(ARMS, key=lambda name: ARMS[name] * (number + 1) / total - given[name])
        given[arm] += 1
        order.append((arm, given[arm] - 1))
    return order


def cycled(seed, arm, items, number):
    """The item for the number-th campaign of an arm, from repeated shuffled passes through all."""
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
    """(id, parameters) of a fault of the measuring chain."""
    channel, other = rng.choice(VERTICAL, 2, replace=False)
    factor = float(rng.choice([rng.uniform(0.5, 0.8), rng.uniform(1.25, 2.0)]))
    parameters = {  # all are drawn, so that the sequence of random numbers is the same for all
        "sensor_gain": {"channel": str(channel), "factor": factor},
        "sensor_delay": {"channel": str(channel), "delay": float(rng.uniform(2e-3, 1e-2))},
        "swap": {"channel": str(channel), "other": str(other)},
        "clip": {"channel": str(channel), "fraction": float(rng.uniform(0.2, 0.5))},
        "dropout": {
            "channel": str(channel),
            "start": float(rng.uniform(0.2, 0.7)),
            "duration": float(rng.uniform(0.5, 2.0)),
        },
    }
    return name, parameters[name]


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
            factor = float(rng.choice([rng.uniform(0.6, 0.75), rng.uniform(1.3, 1.6)]))
            return (("sensor_gain", {"channel": "all", "factor": factor}),)
        return (amount_of(effect, "strong", rng),)
    return (instrument(cycled(seed, arm, FAULTS, number), rng),)


def draw_plans(seed, count, **common):
    """The first `count` Plans of a seed.

    common: fields that all share (duration, tube, levels, ...).
    """
    plans = []
    for index, (arm, number) in enumerate(arms(count)):
        effects = hidden_in(seed, arm, number, np.random.default_rng([seed, index, 7]))
        plans.append(Plan((seed, index), effects, arm, **{"levels": LEVELS, **common}))
    return plans

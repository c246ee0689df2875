"""The seeded draw: what varies from campaign to campaign, and what is hidden in each.

A campaign depends on the pool, the seed and its number alone, so that a draw can be sharded and
resumed. The first N of a seed have the proportions of SHARES as closely as N allows, and every kind
goes through its effects in a shuffled order before it repeats one. The pool "development" is for
tuning, "acceptance" for judging: they have other beams, laws, strangers and scatter.
"""

from dataclasses import replace

import numpy as np

from evidence.truth.amounts import AMOUNTS
from evidence.truth.beams import SHAPES
from evidence.truth.campaign import Plan, channels_of
from evidence.truth.hidden import EFFECTS, family_of
from evidence.truth.scene import Scene, sizes

POOLS = ("development", "acceptance")
# Campaigns of each kind in a whole draw of 180.
SHARES = {
    "nothing": 36,
    "strong": 32,
    "medium": 24,
    "exact_alias": 8,
    "near_alias": 12,
    "two": 20,
    "out_of_catalogue": 20,
    "other_law": 20,
    "fault": 16,
}
EXACT_ALIASES = ("gap", "sensor_gain")  # force and every response alike are a gap scaled
NEAR_ALIASES = (
    "hertz",
    "contact_stiffness",
    "hunt_crossley",
    "contact_damping",
    "added_mass",
    "mode_frequency_error",
)
FAULTS = ("sensor_gain", "swap", "clip", "sensor_delay", "dropout")
OTHER_LAWS = {
    "development": (
        "dahl_friction",
        "velocity_friction",
        "lankarani_nikravesh_contact",
        "sine_lobes",
    ),
    "acceptance": (
        "lugre_friction",
        "iwan_friction",
        "spring_damper_friction",
        "flores_contact",
        "flat_lands",
    ),
}
STRANGERS = {
    "development": (
        "loose_mass",
        "hysteretic_root",
        "drifting_gap",
        "tilted_plate",
    ),
    "acceptance": (
        "breathing_crack",
        "unmeasured_force",
        "self_excitation",
        "sliding_mass",
        "loosening_support",
        "frequency_drift",
        "parametric_stiffness",
        "sensor_saturation",
        "wrong_section",
        "wrong_length",
    ),
}
WEAK = ("quadratic_stiffness",)  # effects with no strong amount that is sound
ROOTS = ("root_stiffness", "hysteretic_root")  # effects that need two clamped ends
# Kinds of channels that are drawn. "velocity" belongs here as soon as a verdict reads it.
KINDS = ("acceleration", "displacement")
SAMPLING = (1024.0, 1280.0, 2048.0, 2560.0, 4096.0, 5120.0, 8192.0)  # Hz; 81920 is 2 n of each
STEPS_PER_SECOND = 81920  # four times the model's
NEAR_M = 2.0e-3  # of a named point: two places so close are one
LONGEST_S = 160.0  # of all records together
# RMS motion at the support that moves most, were there no contact, over the gap
LOWEST, HIGHEST = (0.12, 0.2), (2.5, 8.0)
SCATTER_LAWS = {"development": ("uniform",), "acceptance": ("laplace", "normal", "uniform")}


def kinds(count):
    """(count,) pairs (kind, number within it): always the kind farthest behind its share."""
    total, given, order = sum(SHARES.values()), dict.fromkeys(SHARES, 0), []
    for number in range(count):
        kind = max(SHARES, key=lambda name: SHARES[name] * (number + 1) / total - given[name])
        given[kind] += 1
        order.append((kind, given[kind] - 1))
    return order


def cycled(seed, kind, items, number):
    """The item for the number-th campaign of a kind, from repeated shuffled passes through all."""
    turn, place = divmod(number, len(items))
    shuffled = np.random.default_rng([seed, list(SHARES).index(kind), turn]).permutation(len(items))
    return items[shuffled[place]]


def direction_across(rng, beam, s, oblique=True):
    """(3,) direction across a beam at s [m]: y, in plane, or any."""
    angle = float(rng.choice([0.0, 0.5 * np.pi, rng.uniform(0.0, 2.0 * np.pi)]))
    if not oblique:
        angle = round(angle / (0.5 * np.pi)) * 0.5 * np.pi
    along = np.cos(angle) * np.array([0.0, 1.0, 0.0]) + np.sin(angle) * beam.across(s)
    return tuple((along.round(6) + 0.0).tolist())


def unnamed_place(rng, beam, low, high):
    """Arc length [m] between two shares of the beam, nowhere near a point that its model names."""
    named = [*beam.places.values(), *(holder.arc for holder in beam.holders)]
    while True:
        at = round(float(rng.uniform(low, high) * beam.length), 4)
        if np.abs(np.subtract(named, at)).min() > NEAR_M:
            return at


def drawn_channels(rng, plan):
    """(place, direction, kind) of 2 to 12 channels, none at a named point; the first one moves with
    the force.
    """
    count, beam = int(rng.integers(2, 13)), plan.beam
    mixed = rng.random() < 0.5
    common = str(rng.choice(KINDS, p=[0.75] + [0.25 / (len(KINDS) - 1)] * (len(KINDS) - 1)))
    rows = []
    for number in range(count):
        free = beam.ends[1] == "free"
        at = unnamed_place(rng, beam, 0.08, 1.0 if free else 0.92)
        along = direction_across(rng, beam, at)
        if number == 0:
            along = plan.drive_direction_at(at)
        rows.append((at, along, str(rng.choice(KINDS)) if mixed else common))
    return tuple(rows)


def drawn_levels(rng, size, beam):
    """(N RMS, gap %, split) of 2 to 8 levels and 1 to 3 gaps; the last records are held out."""
    count, gaps = int(rng.integers(2, 9)), int(rng.integers(1, 4))
    percents = np.round(
        np.exp(rng.uniform(np.log(0.5), np.log(1.8))) * np.array([1.0, 0.7, 1.3]), 2
    )
    gap = 0.01 * float(percents.min()) * beam.outer_diameter * smallest_factor(beam)
    low, high = (float(np.exp(rng.uniform(*np.log(ends)))) for ends in (LOWEST, HIGHEST))
    loads = gap / size.motion * np.geomspace(low, high, count)
    loads = [float(f"{load:.3g}") for load in loads]
    rows = [
        (load, float(percents[0] if load == loads[0] else percents[rng.integers(gaps)]), "fit")
        for load in loads
    ]
    held = 0 if count == 2 and rng.random() < 0.5 else 1 if count < 6 else 2
    for _ in range(held):
        load = loads[int(rng.integers(max(1, count - 2), count))]
        rows.append((load, float(percents[rng.integers(gaps)]), "holdout"))
    return tuple(rows)


def smallest_factor(beam):
    """The smallest of the supports' factors of the gap."""
    return min(holder.gap_factor for holder in beam.holders)


def bare_plan(pool, seed, number):
    """The Plan of a campaign before anything is hidden in it, and the Sizes of its beam."""
    acceptance = pool == "acceptance"
    rng = np.random.default_rng([seed, number, POOLS.index(pool)])
    shape = str(rng.choice(list(SHAPES), p=[0.4, 0.35, 0.25]))
    beam = SHAPES[shape](rng, acceptance)
    drive = beam.places["drive"]
    along = (
        (0.0, 1.0, 0.0)
        if rng.random() < 0.6 or beam.holders[0].profile == "lands"
        else direction_across(rng, beam, drive, acceptance)
    )
    sampling = float(rng.choice(SAMPLING, p=[0.15, 0.1, 0.3, 0.15, 0.15, 0.1, 0.05]))
    band = (
        float(round(rng.uniform(4.0, 8.0), 1)),
        float(round(min(0.3 * sampling, np.exp(rng.uniform(np.log(150.0), np.log(400.0)))))),
    )
    size = sizes(beam, band, along)
    levels = drawn_levels(rng, size, beam)
    longest = min(60.0, LONGEST_S / len(levels))
    spread = (0.6, 1.5) if acceptance else (0.7, 1.2)
    widths = [value * rng.uniform(*spread) for value in (0.02, 0.003, 0.10)]
    plan = Plan(
        (seed, number, POOLS.index(pool)),
        tube=beam,
        levels=levels,
        duration=float(round(np.exp(rng.uniform(np.log(10.0), np.log(longest))))),
        sampling=sampling,
        steps_per_second=STEPS_PER_SECOND,
        start_up="rest" if rng.random() < 0.5 else "stationary",
        band=band,
        drive_direction=along,
        gain_scatter=float(widths[0]),
        frequency_scatter=float(widths[1]),
        damping_scatter=float(widths[2]),
        scatter_law=str(rng.choice(SCATTER_LAWS[pool])),
        force_gain=float(round(1.0 + rng.uniform(-0.015, 0.015), 4)),
        noise=float(np.exp(rng.uniform(np.log(0.001), np.log(0.05)))),
        noise_floor=bool(rng.random() < 0.3),
    )
    return replace(plan, channels=drawn_channels(rng, plan)), size


def scene_of(plan, size, rng):
    """The Scene of a plan: the place of an effect is between its sensors and at no named point."""
    beam = plan.beam
    place = unnamed_place(rng, beam, 0.12, 0.88)
    names = [holder.name for holder in beam.holders]
    alone = len(names) > 1 and rng.random() < 0.35
    gaps = [percent for _, percent, _ in plan.levels]
    vertical = plan.drive_direction
    driven = [channel["name"] for channel in channels_of(plan)[0] if aligned(channel, vertical)]
    return Scene(
        rng,
        beam,
        size,
        place,
        plan.drive_direction_at(place)
        if rng.random() < 0.7
        else direction_across(rng, beam, place),
        plan.drive_direction,
        str(rng.choice(names)) if alone else "all",
        0.01 * float(np.median(gaps)) * beam.outer_diameter,
        max(load for load, *_ in plan.levels),
        plan.duration * len(plan.levels),
        str(rng.choice(driven)),
    )


def aligned(channel, direction):
    """Whether a channel moves with a force along a direction (3,), out of plane or in plane."""
    mine, other = abs(channel["direction"][1]), abs(direction[1])
    return min(mine, other) > 0.3 or max(mine, other) < 0.95


def instrument(name, scene, plan):
    """(id, parameters) of a fault of the measuring chain, where a channel moves with the force."""
    rng, names = scene.rng, [channel["name"] for channel in channels_of(plan)[0]]
    other = str(rng.choice([each for each in names if each != scene.channel]))
    factor = float(rng.choice([rng.uniform(0.5, 0.8), rng.uniform(1.25, 2.0)]))
    parameters = {  # all are drawn, so that the sequence of random numbers is the same for all
        "sensor_gain": {"factor": factor},
        "sensor_delay": {"delay": float(rng.uniform(2e-3, 1e-2))},
        "swap": {"other": other},
        "clip": {"fraction": float(rng.uniform(0.2, 0.5))},
        "dropout": {
            "start": float(rng.uniform(0.2, 0.7)),
            "duration": float(rng.uniform(0.5, 2.0)),
        },
    }
    return name, {"channel": scene.channel} | parameters[name]


def able(beam, names):
    """Those of some effects that a beam can have."""
    round_holes = all(holder.profile == "circle" for holder in beam.holders)
    return [
        name
        for name in names
        if (beam.ends == ("clamped", "clamped") or name not in ROOTS)
        and (round_holes or family_of(name) != "shape of the hole")
    ]


def hidden_names(pool, seed, kind, number, beam, rng):
    """Names of what is hidden in the number-th campaign of a kind."""
    strong = [name for name in EFFECTS if name not in WEAK]

    def one(names):
        """The first of the shuffled passes from the number-th on that the beam can have."""
        return next(
            name
            for name in (cycled(seed, kind, names, number + k) for k in range(3 * len(names)))
            if name in able(beam, names)
        )

    if kind == "nothing":
        return ()
    if kind == "two":
        first, second = one(strong), None
        while second is None or family_of(second) == family_of(first):
            second = str(rng.choice(able(beam, strong)))
        return first, second
    pools = {
        "strong": strong,
        "medium": list(EFFECTS),
        "exact_alias": EXACT_ALIASES,
        "near_alias": NEAR_ALIASES,
        "out_of_catalogue": STRANGERS[pool],
        "other_law": OTHER_LAWS[pool],
        "fault": FAULTS,
    }
    return (one(list(pools[kind])),)


def parameters_of(name, kind, plan, scene, amount):
    """(id, parameters) of what is hidden, at a factor `amount` of where it starts."""
    if kind == "fault":
        return instrument(name, scene, plan)
    if name == "sensor_gain":
        rng = scene.rng
        factor = float(rng.choice([rng.uniform(0.6, 0.75), rng.uniform(1.3, 1.6)]))
        return name, {"channel": "all", "factor": factor}
    row = AMOUNTS[name]
    return name, row.parameters(min(amount * row.start, row.most), scene)


def hide(plan, size, pool, names, amounts):
    """The plan with effects hidden in it.

    amounts: a factor of the start of each. What else of an effect is drawn does not depend on it.
    """
    seed, number, _ = plan.seed
    effects = []
    for place, (name, amount) in enumerate(zip(names, amounts, strict=True)):
        rng = np.random.default_rng([seed, number, POOLS.index(pool), 7, place])
        scene = scene_of(plan, size, rng)
        effects.append(parameters_of(name, plan.kind, plan, scene, amount))
    return replace(plan, effects=tuple(effects))


def draw(pool, seed, number):
    """(Plan, Sizes, names) of a campaign; its effects are at the amounts they start from."""
    kind, within = kinds(number + 1)[number]
    plan, size = bare_plan(pool, seed, number)
    plan = replace(plan, kind=kind)
    names = hidden_names(
        pool, seed, kind, within, plan.beam, np.random.default_rng([seed, number, 11])
    )
    return hide(plan, size, pool, names, [1.0] * len(names)), size, names

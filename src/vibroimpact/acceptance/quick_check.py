"""A few sealed campaigns whose quick verdicts must be right: the check of the whole chain that a
change can afford.
"""

from dataclasses import dataclass, field

from vibroimpact.effects.registry import EFFECTS

CONTACT = {
    "gap",
    "contact_stiffness",
    "contact_damping",
    "hunt_crossley",
    "hertz",
    "dry_friction",
    "support_offset",
    "foliate_obstacle",
    "preload",
    "plate_flexibility",
}


@dataclass(frozen=True)
class Check:
    """hidden: ((id, parameters), ...) of vibroimpact_truth; wanted: sets of ids that must be in the
    ambiguity set, none of them for the verdict none; never: ids that must be in no set; model: {id:
    parameters} of effects that the model has and the structure has not; within: {parameter: (low,
    high)}, where the estimates must lie.
    """

    hidden: tuple
    wanted: tuple
    never: frozenset = frozenset()
    model: dict = field(default_factory=dict)
    within: dict = field(default_factory=dict)

    def values(self, config):
        """Return the configuration in plain values with the effects that only the model has,
        everywhere.
        """
        for effect_id, parameters in self.model.items():
            config = EFFECTS[effect_id].apply(config, parameters, "all")
        return config

    def faults(self, verdict):
        """Return the sentences of what a Verdict gets wrong, none where it is right."""
        sets = [sorted(row) for row in verdict.ambiguity_set]
        said = f"the verdict is {verdict.verdict} with {sets}"
        wrong = (
            [] if self.wanted or verdict.verdict == "none" else [f"nothing is hidden, but {said}"]
        )
        wrong += [
            f"{ids} is not in the set: {said}" for ids in self.wanted if sorted(ids) not in sets
        ]
        rows = (
            [
                row
                for effect in (*verdict.effects, *verdict.most_probable)
                for row in effect.parameters.items()
            ]
            if self.within
            else []
        )
        found = {name: row.value for name, row in rows}
        wrong += [
            f"{name} must be from {low} to {high}, but is {found.get(name)}: {said}"
            for name, (low, high) in self.within.items()
            if not low <= found.get(name, float("nan")) <= high
        ]
        return wrong + [
            f"{name} can not be, but {said}"
            for name in sorted(self.never & {name for row in sets for name in row})
        ]


CHECKS = {
    "nothing": Check((), ()),
    "contact_damping": Check((("contact_damping", {"damping": 600.0}),), (("contact_damping",),)),
    "one_gain": Check(
        (("sensor_gain", {"channel": "right_leg_upper_y", "factor": 0.6}),),
        (("sensor_gain",),),
        frozenset(CONTACT),
    ),
    # mutations of the measuring chain: the force alone is a gain and no contact effect; force and
    # every response alike are a gap scaled
    "force_gain": Check(
        (("sensor_gain", {"channel": "force", "factor": 1.1}),),
        (("sensor_gain",),),
        frozenset(CONTACT),
    ),
    "common_gain": Check(
        (("sensor_gain", {"channel": "all", "factor": 1.3}),), (("gap",), ("sensor_gain",))
    ),
    # measured and simulated in each other's place: the model's clearance is 1.6 times too large, so
    # what is missing shrinks it to 0.625
    "swapped": Check(
        (),
        (("gap",), ("sensor_gain",)),
        model={"gap": {"gap_factor": 1.6}},
        within={"gap_factor": (0.5, 0.8)},
    ),
}
SEED, SECONDS = 77, 20.0
COMPARED_S = 10.0  # of each record: from rest, all of it counts


def table(verdicts):
    """Return rows {check, hidden, verdict, ambiguity_set, right, faults} of {check: Verdict}."""
    rows = []
    for name, verdict in verdicts.items():
        faults = CHECKS[name].faults(verdict)
        rows.append(
            {
                "check": name,
                "hidden": "+".join(effect for effect, _ in CHECKS[name].hidden) or "nothing",
                "verdict": verdict.verdict,
                "ambiguity_set": "|".join("+".join(row) for row in verdict.ambiguity_set),
                "right": not faults,
                "faults": "; ".join(faults),
            }
        )
    return rows

"""Every number of a configuration, moved by a tenth, changes what is computed, or is refused.

What is computed are the reduced model and the force for the keys that make them, and the settings
of a stage for the others.
"""

import copy
import hashlib
import re
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from tests.config.test_config import leaves, put
from tests.properties.full_configurations import (
    BASE,
    CHAIN,
    CONFIGURATIONS,
    MODES,
    OBLIQUE,
    SECTIONS,
    changed,
)
from vibroimpact.config.idle_keys import idle_keys
from vibroimpact.config.key_reference import declared_sections
from vibroimpact.config.problems import ConfigError
from vibroimpact.config.reading import check_config
from vibroimpact.config.stage_keys import MODEL, STAGE_KEYS, select
from vibroimpact.integration.batch import Schedule
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import all_cases
from vibroimpact.study.model_checks import check_model
from vibroimpact.study.simulation import seed_forces

MOVES = (1.1, 0.9, 1.01, 0.99, 4.0, 0.02)  # until one acts: cut-offs are crossed seldom
EXEMPT = {
    "record.stress_limit_Pa": "changes a flag alone",
    "flow.velocity_m_per_s": "is read by `vibroimpact stability` alone",
    "flow.criterion": "is read by `vibroimpact stability` alone",
    "flow.turbulence": "is read by `vibroimpact stability` alone",
    "flow.coupling.reduced_velocity": "makes a warning alone",
    "wear.": "acts on the wear life alone, see tests/wear",
    "structure.points": "are rows of matrices in files",
    "excitation.sampling_frequency_Hz": "must agree with the measured file",
    "initial.displacement.values.0.at_m": "is an end of the tube, within 5 mm",
    "initial.displacement.values.2.at_m": "is an end of the tube, within 5 mm",
    "initial.velocity.values.0.at_m": "is an end of the tube, within 5 mm",
    "initial.velocity.values.2.at_m": "is an end of the tube, within 5 mm",
}


def digest(value):
    """A digest of arrays, numbers and texts inside dataclasses, tuples and dictionaries."""
    told = hashlib.sha256()

    def add(part):
        if is_dataclass(part):
            for field in fields(part):
                add(getattr(part, field.name))
        elif isinstance(part, dict):
            add(tuple(part.items()))
        elif isinstance(part, (tuple, list)):
            for each in part:
                add(each)
        elif isinstance(part, np.ndarray):
            told.update(repr(part.shape).encode() + np.ascontiguousarray(part).tobytes())
        else:
            told.update(repr(part).encode())

    add(value)
    return told.hexdigest()


def computed(config, place):
    """What is computed of a configuration as far as a key can change it."""
    top = place.split(".")[0]
    if any(key.split(".")[0] == top for key in MODEL if not key.startswith("record")):
        step, record = config.integration, config.record
        schedule = Schedule(
            step.steps_per_second, record.sampling_frequency_Hz, 0.0, 1.0, step.scheme
        )
        forces = seed_forces(config, schedule, 0, 1)
        return digest((build_model(config), [force.values(0, 512) for force in forces]))
    values = config.model_dump(mode="json")
    stages = {name: keys for name, keys in STAGE_KEYS.items() if len(keys) < len(values)}
    return digest((all_cases(config.grid), [select(values, keys) for keys in stages.values()]))


def moved(value, factor):
    """A number moved by a factor; a whole number by at least 1."""
    if isinstance(value, int):
        return value + (max(1, round(value * (factor - 1))) if factor > 1 else -1)
    return value * factor


def at(mapping, parts):
    """What stands at a place of nested mappings and lists, None where there is none."""
    for part in parts:
        try:
            mapping = mapping[int(part) if part.isdigit() else part]
        except (LookupError, TypeError):
            return None
    return mapping


def numbers(name):
    """Yield (place, value) of the numbers of mappings that a configuration states and no earlier
    one did.
    """
    stated = CONFIGURATIONS[name]
    earlier = [*CONFIGURATIONS.values()][: [*CONFIGURATIONS].index(name)]
    for place, value in leaves(stated):
        parts = place.split(".")
        around = parts[:-1] or parts
        if not isinstance(value, (int, float)) or isinstance(value, bool) or value == 0:
            continue
        # the length of a direction does not matter, and a chain has one
        exempt = place.startswith(tuple(EXEMPT)) or (
            name in ("chain", "modes") and "direction" in parts
        )
        if not exempt and all(at(stated, around) != at(other, around) for other in earlier):
            yield place, value


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_every_number_acts_or_is_refused(name):
    stated = CONFIGURATIONS[name]
    config = check_config(stated, name)
    assert [*idle_keys(config)] == []
    before, idle = {}, []
    for place, value in numbers(name):
        after = []
        for factor in MOVES:
            changed = copy.deepcopy(stated)
            put(changed, place, moved(value, factor))
            try:
                after.append(computed(check_config(changed, name), place))
            except (ConfigError, ValueError):
                continue  # the checks say why not
            kind = place.split(".")[0]
            before.setdefault(kind, computed(config, place))
            if after[-1] != before[kind]:
                break
        else:
            idle += [place] if after else []
    assert idle == []


CLAMPED = changed(
    BASE, structure__start={"kind": "clamped"}, points__root=BASE["structure"]["start_m"]
)
AT_ROOT = {"point": "root", "direction": OBLIQUE}
IDLE = {
    "excitation.turn_about": changed(BASE, excitation__turn_deg=0.0, excitation__turn_about="tube"),
    "supports[1].gap_factor": changed(BASE, supports__1__gap_factor=1.2),
    "supports[0].stick_stiffness_ratio": changed(BASE, supports__0__friction=0.0),
    "supports[0].points": changed(CHAIN, supports__0__points=7),
    "supports[0].height_m": changed(CHAIN, supports__0__height_m=0.02),
    "structure.section.shear_coefficient": changed(
        BASE, structure__theory="euler_bernoulli", structure__section__shear_coefficient=0.6
    ),
    "structure.section.enclosed_area_m2": changed(
        BASE, structure__section=SECTIONS["general"], structure__fluid=[]
    ),
    "structure.mesh.elements_per_bend": changed(
        BASE,
        structure__segments=[{"kind": "straight", "length_m": 1.3}],
        structure__mesh={"elements_per_span": 4, "elements_per_bend": 5},
    ),
    "record.shape_line.points": changed(CHAIN, record__shape_line={"points": 9}),
    "initial.base_velocity_m_per_s": changed(BASE, initial={"base_velocity_m_per_s": 0.1}),
    "basis.constrained_modes_to_Hz": changed(BASE, supports=[], elements=[], identification=None),
    "integration.imperfection": changed(BASE, supports=[], identification=None),
    "damping": changed(CHAIN, structure={"kind": "identified", "modes": MODES}, initial=None),
    "damping.first_ratios": changed(CHAIN, damping__first_ratios=[0.01] * 9),
    "elements[1].slip_limit_N": changed(BASE, elements__1__stick_stiffness_N_per_m=0.0),
    "elements[1].stick_stiffness_N_per_m": changed(BASE, elements__1__slip_limit_N=0.0),
    "elements[1].saturation_stiffness_N_per_m": changed(BASE, elements__1__saturation_limit_N=0.0),
    "elements[0].damping_limit_N": changed(BASE, elements__0__damping_N_s_per_m=0.0),
    "elements[0].drag_partner": changed(BASE, elements__0__drag_N_s2_per_m2=0.0),
    "elements[0].drag_partner = 'two' acts at": changed(BASE, elements__1__point="tip"),
    "elements[0].drag_partner = 'two' acts along": changed(
        BASE, elements__1__direction=[-0.6, -2.0, 0.0]
    ),
    "elements[0] = 'empty'": changed(
        BASE, elements=[{"name": "empty", "point": "tip", "direction": OBLIQUE}]
    ),
    "masses[0].point": changed(CLAMPED, masses=[{"name": "m", "point": "root", "mass_kg": 1.0}]),
    "excitation.also[0].point": changed(CLAMPED, excitation__also=[AT_ROOT]),
    "excitation.constant[0].point": changed(
        CLAMPED, excitation__constant=[AT_ROOT | {"force_N": 1.0}]
    ),
    "supports[0]: 'stop' has no effect": changed(
        CHAIN, supports__0__profile={"kind": "planes", "normals_deg": [90.0, 270.0]}
    ),
}


@pytest.mark.parametrize("place", IDLE)
def test_a_key_without_effect_is_refused(place):
    problems = check_model(check_config(IDLE[place], "mine")).problems
    assert any(problem.startswith(place) for problem in problems), problems


def test_every_number_of_the_schema_is_stated_somewhere():
    """Each is then moved by the test above."""
    stated = {
        re.sub(r"\.\d+", "", place)
        for name in CONFIGURATIONS
        for place, _ in leaves(CONFIGURATIONS[name])
    }
    texts = "\n".join(stated) + "\n"
    declared = {
        f"{section.place}.{key.name}".replace("[]", "").removeprefix(".")
        for section in declared_sections()
        for key in section.keys
        if key.unit
    }
    missing = {key for key in declared if not re.search(rf"^{re.escape(key)}[.\n]", texts, re.M)}
    assert {key for key in missing if not key.startswith(tuple(EXEMPT))} == set()

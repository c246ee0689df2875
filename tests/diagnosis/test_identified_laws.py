"""Laws between three masses, simulated by another integrator: their parameters come back, and the
choice among them follows the levels set aside.
"""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import linalg

from tests.support import joint
from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.diagnosis.diagnose import run_diagnosis
from vibroimpact.diagnosis.identified.identified import identified
from vibroimpact.diagnosis.identified.levels import naming_split
from vibroimpact.diagnosis.identified.local_laws import LAWS
from vibroimpact.diagnosis.identified.search import leading
from vibroimpact.diagnosis.identified.trial import LocalTerm, Trial
from vibroimpact.reduction.modal_structure import IdentifiedModes

UP = (0.0, 0.0, 1.0)
STATED = MeasuredStructure(
    kind="identified",
    band_Hz=list(joint.BAND),
    residual_modes=[False, False],
    places={"joint": {"a2": -1.0, "a3": 1.0}},
    candidates=["cubic_stiffness.joint", "single_friction.joint", "clearance.joint"],
    additions=[],
)
NAMED = {"cubic": "cubic_stiffness", "friction": "coulomb_friction", "clearance": "clearance"}


@functools.cache
def runs():
    """The records of every law."""
    return joint.simulate()


def campaign_of(law):
    """The records of a law, the third of four levels held out."""
    force, response = runs()[law]
    names = [f"a{number + 1}" for number in range(3)]
    channels = [
        Channel(name, (float(number), 0.0, 0.0), UP, "m s-2", "acceleration")
        for number, name in enumerate(names)
    ]
    return campaign_dataset(
        force[:, None],
        response,
        channels,
        [Channel("force", (0.0, 0.0, 0.0), UP, "N", "force")],
        [
            Level(f"level {number + 1}", np.nan, 0, "holdout" if number == 2 else "fit")
            for number in range(len(joint.LEVELS))
        ],
        joint.RATE,
        period_samples=joint.PERIOD,
        transient_periods=2,
        antialias="none",
    )


def test_modes_of_the_lowest_level_are_those_of_the_masses():
    mass, damping, stiffness = joint.matrices()
    squares, shapes = linalg.eigh(stiffness, mass)
    modes = identified(campaign_of("clearance"), STATED)[0].linear.base
    assert modes.frequency == pytest.approx(np.sqrt(squares) / (2.0 * np.pi), rel=2.0e-3)
    ratios = np.diag(shapes.T @ damping @ shapes) / (2.0 * np.sqrt(squares))
    assert modes.damping_ratio == pytest.approx(ratios, rel=0.1)
    signs = np.sign(shapes[0] * modes.shapes[:, 0])
    assert modes.shapes == pytest.approx((shapes * signs).T, abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "wanted"),
    [
        ("cubic", {"cubic_stiffness": joint.CUBIC}),
        ("friction", {"force": joint.SLIP, "stick_stiffness": joint.STICK}),
        ("clearance", {"half_gap": joint.HALF_GAP, "stiffness": joint.STOP}),
    ],
)
def test_law_is_named_and_its_parameters_come_back(law, wanted):
    own = run_diagnosis(campaign_of(law), STATED)
    verdict = own.verdict
    assert (verdict.verdict, verdict.ambiguity_set) == ("named", [[NAMED[law]]])
    found = {name: each.value for name, each in verdict.effects[0].parameters.items()}
    assert {name: found[name] for name in wanted} == pytest.approx(wanted, rel=0.05)
    rows = own.grounds.own.prediction(own.grounds.chosen)
    held = [row for row in rows if row["split"] == "holdout"]
    assert all(row["error_completed"] < 0.3 * row["error_linear"] for row in held)


def test_the_equivalent_joint_softens():
    """A slider that slips is softer by up to its stick stiffness."""
    own, _ = identified(campaign_of("friction"), STATED)
    change = own.ranking["joint"].k
    assert change[-1] == pytest.approx(-joint.STICK, rel=0.35) and change[0] == 0.0


def test_held_out_levels_choose_nothing():
    """The fitted level below the highest tells the name; held-out ones where two are fitted."""
    records = [("fit", 1.0), ("fit", 2.0), ("holdout", 3.0), ("fit", 4.0)]
    levels = [SimpleNamespace(split=split, load_rms=load) for split, load in records]
    assert naming_split(levels) == ((levels[0], levels[3]), (levels[1],))
    assert naming_split(levels[1:]) == ((levels[1], levels[3]), (levels[2],))


def test_of_places_that_explain_alike_the_first_stated_leads():
    def found(law, place, gain):
        terms = (SimpleNamespace(law=law, place=place),)
        return SimpleNamespace(point=SimpleNamespace(terms=terms), apart=gain)

    rows = [found("drag", "a", 1.95), found("friction", "a", 1.9), found("friction", "b", 2.0)]
    assert leading(rows, None) is rows[1]
    assert leading([found("friction", "a", 1.0), rows[2]], None) is rows[2]


def test_sliders_that_carry_the_structure_are_no_model():
    modes = IdentifiedModes(
        frequency=np.array([5.0]),
        damping_ratio=np.array([0.01]),
        shapes=np.ones((1, 1)),
        drive=0,
        kinds=("displacement",),
        names=("a",),
        residual=np.zeros(1, bool),
    )
    stiffness = float(modes.omega[0] ** 2)
    for share, holds in ((0.9, True), (1.1, False)):
        values = np.array([share * stiffness, 1.0e-3])
        term = LocalTerm("single_friction", "a", np.ones(1), values)
        assert Trial(modes, (term,)).holds() is holds


@pytest.mark.parametrize("name", LAWS)
def test_a_law_tells_its_parameters_and_columns(name):
    law = LAWS[name]
    values = np.arange(1.0, len(law.parameters) + 1.0)
    assert all(np.size(column) == law.elements for column in law.columns(values).values())
    assert all(np.isfinite(value) for value, _ in law.summary(values).values())

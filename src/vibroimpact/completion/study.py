"""What a completion needs to be told of a measured structure: its band, the channel at the drive,
places for local laws, and the candidates.
"""

from dataclasses import dataclass, field

ELSEWHERE = "elsewhere"  # a place that no channel shows: its participation in the modes is fitted


@dataclass(frozen=True)
class Study:
    """name; band_Hz; drive: name of the channel at the drive point; residual_modes (below, above)
    the band; mean: whether the mean counts.

    places {name: {channel name: coefficient}}: relative displacements over the channels, the first
    one where an effect is suspected; candidates: names "law.place"; additions: names "law.place"
    that are tried as second effect with the best candidate. emphasis: how much more a strong level
    counts in the fit than a weak one, see trial.Records. mounting: the place whose equivalent
    stiffness and damping are tabled against level; peak_Hz: where its peak is looked for. units
    {unit of a mechanical law: unit here}.
    """

    name: str
    band_Hz: tuple
    drive: str
    residual_modes: tuple
    mean: bool
    places: dict
    candidates: tuple
    additions: tuple
    emphasis: float = 0.0
    mounting: str = ""
    peak_Hz: tuple = ()
    units: dict = field(default_factory=dict)

    def unit(self, unit):
        """Return the unit of a law's parameter as this structure has it: an electronic one counts
        in volts.
        """
        return self.units.get(unit, unit)


# Candidate names are file names too; LAWS holds the laws.
F16 = Study(
    name="f16",
    band_Hz=(2.0, 15.0),
    drive="acceleration 1",
    residual_modes=(True, True),
    mean=False,
    places={
        "mounting": {"acceleration 2": -1.0, "acceleration 3": 1.0},
        "inboard": {"acceleration 1": -1.0, "acceleration 2": 1.0},
        "payload": {"acceleration 3": 1.0},
        "shaker": {"acceleration 1": 1.0},
        ELSEWHERE: None,
    },
    candidates=(
        "cubic_stiffness.mounting",
        "quadratic_stiffness.mounting",
        "quadratic_drag.mounting",
        "saturation_stiffness.mounting",
        "clearance.mounting",
        "single_friction.mounting",
        "coulomb_friction.mounting",
        "coulomb_friction.inboard",
        "coulomb_friction.payload",
        "coulomb_friction.shaker",
    ),
    additions=("few_frictions.elsewhere", "clearance.mounting", "cubic_stiffness.mounting"),
    mounting="mounting",
    peak_Hz=(6.8, 7.8),
)
SILVERBOX = Study(
    name="silverbox",
    band_Hz=(0.0, 300.2),
    drive="output",
    residual_modes=(False, False),
    mean=True,
    places={"ground": {"output": 1.0}},
    candidates=(
        "cubic_stiffness.ground",
        "quadratic_stiffness.ground",
        "quadratic_drag.ground",
        "saturation_stiffness.ground",
        "clearance.ground",
        "single_friction.ground",
    ),
    additions=("quadratic_stiffness.ground", "quadratic_drag.ground", "single_friction.ground"),
    emphasis=1.0,
    mounting="ground",
    peak_Hz=(50.0, 100.0),
    units={"N/m3": "V-2", "N/m2": "V-1", "N/m": "1", "N": "V", "m": "V", "N s2/m2": "s2 V-1"},
)
STUDIES = {study.name: study for study in (F16, SILVERBOX)}


def study_of(name, prepared=None):
    """Return the Study of a name: that of `prepared` (values with the key study) where it is given,
    else the one of STUDIES; None where refused.
    """
    if prepared is None:
        return STUDIES[name]
    values = prepared["study"]
    if values is None:
        return None
    tuples = ("band_Hz", "residual_modes", "candidates", "additions", "peak_Hz")
    return Study(**{key: tuple(value) if key in tuples else value for key, value in values.items()})


def row_of(study, place, names):
    """Return (channel,) the coefficients of a place over the channels `names`, None for a place
    that no channel shows. Raises ValueError.
    """
    if place not in study.places:
        raise ValueError(f"place '{place}' is not among {', '.join(study.places)}")
    weights = study.places[place]
    if weights is None:
        return None
    unknown = set(weights) - set(names)
    if unknown:
        raise ValueError(
            f"place '{place}' needs the channels {', '.join(sorted(unknown))}: the records have"
            f" {', '.join(names)}"
        )
    return tuple(float(weights.get(name, 0.0)) for name in names)

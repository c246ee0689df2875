"""What a completion needs to be told of a measured structure: its band, the channel at the drive,
places for local laws, and the candidates.
"""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Study:
    """name; band_Hz; drive: name of the channel at the drive point; residual_modes (below, above)
    the band; mean: whether the mean counts.

    places {name: {channel name: coefficient}}: relative displacements over the channels, the first
    one where an effect is suspected; candidates: names "law.place", which name files as well;
    additions: names "law.place" that are tried as second effect with the best candidate. emphasis:
    how much more a strong level counts in the fit than a weak one, see trial.Records. mounting: the
    place whose equivalent stiffness and damping are tabled against level; peak_Hz: where its peak
    is looked for. units {unit of a mechanical law: unit here}.
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


def study_of(prepared):
    """Return the Study in the values of prepare.prepared; None where the campaign was refused."""
    values = prepared["study"]
    if values is None:
        return None
    tuples = ("band_Hz", "residual_modes", "candidates", "additions", "peak_Hz")
    return Study(**{key: tuple(value) if key in tuples else value for key, value in values.items()})


def laws_to_fit(prepared, kind):
    """Return the names of the "candidates" or "additions" in the values of prepare.prepared; none
    where the campaign was refused.
    """
    return () if prepared["refused"] else getattr(study_of(prepared), kind)


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

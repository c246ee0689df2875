"""A sensor that reads too much or too little."""

from .effect import Effect, Parameter

EFFECT = Effect(
    id="sensor_gain",
    family="sensor",
    explanation="a sensor reads by a factor too much or too little",
    law="reading = factor times the signal",
    source="calibration",
    parameters=(Parameter("factor", "1", 0.25, 4.0, 1.0, meaning="reading over the true signal"),),
    linear=True,
    measured=True,
    broken=("T1",),
    aliases=("gap",),
)

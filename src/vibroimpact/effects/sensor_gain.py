"""A sensor that reads too much or too little."""

from .effect import Effect, Parameter

EFFECT = Effect(
    id="sensor_gain",
    explanation="a sensor reads by a factor too much or too little",
    source="calibration",
    parameters=(Parameter("factor", "1", 0.25, 4.0, 1.0),),
    linear=True,
    measured=True,
    broken=("T1",),
    aliases=("gap",),
)

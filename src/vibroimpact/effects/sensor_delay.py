"""A sensor that reads late."""

from .effect import Effect, Parameter

EFFECT = Effect(
    id="sensor_delay",
    family="sensor",
    explanation="a sensor reads late",
    law="reading(t) = signal(t - delay)",
    source="filters, wireless links, separate recorders",
    parameters=(
        Parameter("delay", "s", -0.01, 0.01, 0.0, log=False, meaning="delay of the channel"),
    ),
    linear=True,
    measured=True,
    broken=("T1",),
)

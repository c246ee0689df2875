"""Two masses with a law between them, driven at the upper one: simulated by Runge-Kutta, as
campaigns that a user would bring.
"""

import numpy as np

from vibroimpact.campaign.file import Channel, Level, campaign_dataset

MASS = (2.0, 1.0)  # kg
GROUND, JOINT = (1.2e4, 8.0), (8.0e3, 6.0)  # N/m and N s/m
RATE, PERIOD, SUBSTEPS = 128.0, 1024, 10
BAND = (3.0, 45.0)  # Hz
LEVELS = (0.5, 2.0, 4.0, 8.0, 12.0)  # N RMS
SPLITS = ("fit", "fit", "fit", "holdout", "fit")
NOISE = 0.002  # of the lower mass's acceleration at the lowest level
CUBIC = 3.0e8  # N/m3
STICK, SLIP = 5.0e3, 1.5  # N/m, N


def _nothing(w, speed, z):
    return 0.0 * w, 0.0 * w


def _cubic(w, speed, z):
    return CUBIC * w**3, 0.0 * w


def _friction(w, speed, z):
    pull = STICK * speed
    return z, np.where((np.abs(z) >= SLIP) & (z * pull > 0.0), 0.0, pull)


def _bouc_wen(w, speed, z):
    return z, 4.0e3 * speed - 1.2e3 * np.abs(speed) * z + 0.4e3 * speed * np.abs(z)


LAWS = {
    "nothing": _nothing,
    "cubic": _cubic,
    "friction": _friction,
    "bouc_wen": _bouc_wen,
}  # law(relative displacement, speed, state) -> force, rate of the state


def force_of(periodic, periods, seed=5):
    """(2 * SUBSTEPS * time,) N of unit RMS: every line of BAND with a random phase, or Gaussian
    without a period.
    """
    draw = np.random.default_rng(seed)
    size = PERIOD if periodic else PERIOD * periods
    frequency = np.fft.rfftfreq(size, 1.0 / RATE)
    lines = np.exp(2j * np.pi * draw.uniform(size=frequency.size)) * (
        1.0 if periodic else draw.rayleigh(size=frequency.size)
    )
    lines[(frequency < BAND[0]) | (frequency > BAND[1])] = 0.0
    fine = np.fft.irfft(np.pad(lines, (0, size * SUBSTEPS - size // 2)), size * 2 * SUBSTEPS)
    return np.tile(fine / fine.std(), periods if periodic else 1)


def simulate(law, force, levels):
    """(force (level, time), acceleration (level, 2, time)) from rest under force (2 * SUBSTEPS *
    time,) times each level.
    """
    loads, step = np.array(levels), 1.0 / (RATE * SUBSTEPS)

    def rate(state, push):
        x, v, z = state[:2], state[2:4], state[4]
        w, speed = x[1] - x[0], v[1] - v[0]
        added, change = LAWS[law](w, speed, z)
        joint = JOINT[0] * w + JOINT[1] * speed + added
        upper = (push * loads - GROUND[0] * x[0] - GROUND[1] * v[0] + joint) / MASS[0]
        return np.array([v[0], v[1], upper, -joint / MASS[1], change])

    state, kept = np.zeros((5, loads.size)), np.empty((force.size // (2 * SUBSTEPS), 2, loads.size))
    for sample in range(len(kept)):
        kept[sample] = rate(state, force[2 * SUBSTEPS * sample])[2:4]
        for sub in range(SUBSTEPS):
            at = 2 * (SUBSTEPS * sample + sub)
            half, end = force[at + 1], force[(at + 2) % force.size]
            a = rate(state, force[at])
            b = rate(state + 0.5 * step * a, half)
            c = rate(state + 0.5 * step * b, half)
            d = rate(state + step * c, end)
            state = state + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            if law == "friction":
                state[4] = np.clip(state[4], -SLIP, SLIP)
    return force[:: 2 * SUBSTEPS] * loads[:, None], kept.transpose(2, 1, 0)


def campaign(law, periodic=True, periods=4):
    """The campaign Dataset of a law, without its period stated."""
    force, response = simulate(law, force_of(periodic, periods), LEVELS)
    response = response + NOISE * response[0, 1].std() * np.random.default_rng(1).standard_normal(
        response.shape
    )
    up = (0.0, 0.0, 1.0)
    places = (
        ("upper", (0.0, 0.0, 0.0), up),
        ("lower", (0.0, 0.0, -0.5), up),
    )
    channels = [Channel(*place, "m s-2", "acceleration") for place in places]
    drive = Channel("shaker", (0.0, 0.0, 0.0), up, "N", "force")
    records = [
        Level(f"{level:g} N", np.nan, 0, split) for level, split in zip(LEVELS, SPLITS, strict=True)
    ]
    return campaign_dataset(
        force[:, None],
        response,
        channels,
        [drive],
        records,
        RATE,
        antialias="none",
        start_up="rest",
        source="two masses, simulated",
    )

"""A small campaign without a fault: accelerometers on the tube of the study, three levels."""

import numpy as np

from vibroimpact.campaign.file import Channel, Level, campaign_dataset

RATE_HZ = 512.0
SAMPLES = 4096
NATURAL_HZ, DAMPING = 21.0, 0.02
# On the tube of the study, in the order of the channels.
POINTS_M = ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), (-0.2121, 0.0, 0.9121))
Y, X = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)


def sound_campaign(points=POINTS_M, drive_m=(-0.2121, 0.0, 0.9121)):
    """Return the Dataset of a campaign: one mode under a random force, and a little noise.

    The first channels measure along the force, the second one across it.
    """
    draw = np.random.default_rng(5)
    lines = np.fft.rfftfreq(SAMPLES, 1.0 / RATE_HZ)
    omega, pole = 2.0 * np.pi * lines, 2.0 * np.pi * NATURAL_HZ
    transfer = -(omega**2) / (pole**2 - omega**2 + 2j * DAMPING * pole * omega)
    force, response = [], []
    for load in (0.5, 2.0, 8.0):
        spectrum = np.fft.rfft(draw.standard_normal(SAMPLES)) * ((lines > 5.0) & (lines < 100.0))
        values = np.fft.irfft(spectrum, SAMPLES)
        scale = load / np.sqrt(np.mean(values**2))
        moving = np.fft.irfft(scale * spectrum * transfer, SAMPLES)
        force.append(scale * values[None])
        response.append(
            np.stack([moving * (1.0 - 0.2 * index) for index in range(len(points))])
            + 0.01 * load * draw.standard_normal((len(points), SAMPLES))
        )
    channels = [
        Channel(f"tip {index}", point, X if index == 1 else Y, "m s-2", "acceleration")
        for index, point in enumerate(points)
    ]
    drive = Channel("shaker", drive_m, Y, "N", "generic")
    levels = [Level("low", 2.9e-4), Level("middle", 2.9e-4), Level("high", 2.9e-4, split="holdout")]
    return campaign_dataset(force, response, channels, [drive], levels, RATE_HZ, source="a test")

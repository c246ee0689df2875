"""Campaigns whose supports are known: simulated tubes, and linear tubes on a spring and damper."""

from dataclasses import replace

import numpy as np

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.identify.linear.responses import frf

Y = (0.0, 1.0, 0.0)
NOISE = 0.01  # of the RMS of each channel


def campaign_of_records(config, model, records, sensors, noise=NOISE):
    """The campaign of simulated records [(Case, Dataset)]: accelerations of some sensors of a
    model, with noise.
    """
    rows = [model.sensor_names.index(name) for name in sensors]
    random = np.random.default_rng(54)
    response = np.array([record["acceleration"].values[rows] for _, record in records], float)
    size = np.sqrt(np.mean(response**2, axis=-1, keepdims=True))
    response += noise * size * random.standard_normal(response.shape)
    channels = [
        Channel(name, tuple(model.sensor_positions[row]), Y, "m s-2", "acceleration")
        for name, row in zip(sensors, rows, strict=True)
    ]
    drive = Channel("shaker", config.points[config.excitation.point], Y, "N", "generic")
    levels = [Level(case.id, case.gap_m, case.seed) for case, _ in records]
    force = np.array([record["force"].values for _, record in records])[:, None]
    rate = config.record.sampling_frequency_Hz
    return campaign_dataset(force, response, channels, [drive], levels, rate, source="simulated")


class LinearCampaigns:
    """Records of the linear tube of a configuration on a support (k in N/m, c in N s/m).

    drives: named points of forces across the plane of the tube. sensors: of the model.
    """

    def __init__(self, config, model, support, drives, sensors, rate=512, duration_s=96.0):
        self.config, self.model, self.rate = config, model, rate
        self.drives, self.sensors, self.samples = drives, sensors, round(duration_s * rate)
        shape = [model.sensor_names.index(f"{name}.y") for name in drives]
        driven = replace(model, drive_shapes=model.sensor_shapes[:, shape])
        self.rows = [model.sensor_names.index(name) for name in sensors]
        self.lines = np.fft.rfftfreq(self.samples, 1.0 / rate)
        seen = model.sensor_shapes[:, self.rows]
        self.response = np.array(
            [
                frf(driven, *support, self.lines, seen, "acceleration", channel)
                for channel in range(len(drives))
            ]
        )

    def campaign(self, records, mix=((1.0,),), psd=None, gap_m=2.8886e-4):
        """A campaign of some records.

        mix (force, source): forces over independent sources. psd (line,): relative, of all forces.
        """
        random = np.random.default_rng(7)
        inside = (self.lines >= 5.0) & (self.lines <= 200.0)
        weight = inside * (1.0 if psd is None else np.sqrt(psd))
        mix, forces, responses = np.array(mix), [], []
        for _ in range(records):
            source = random.standard_normal((mix.shape[1], self.samples))
            lines = mix @ (np.fft.rfft(source, axis=-1) * weight)
            forces.append(np.fft.irfft(lines, self.samples, axis=-1))
            moved = np.fft.irfft(
                np.einsum("jsf,jf->sf", self.response, lines), self.samples, axis=-1
            )
            size = np.sqrt(np.mean(moved**2, axis=-1, keepdims=True))
            size = np.where(size > 0.0, size, size.max())  # a sensor across the forces
            responses.append(moved + NOISE * size * random.standard_normal(moved.shape))
        force = np.array(forces)
        force /= np.sqrt(np.mean(force[:, :1] ** 2, axis=-1, keepdims=True))
        channels = [
            Channel(
                name,
                tuple(self.model.sensor_positions[row]),
                tuple(self.model.sensor_directions[row]),
                "m s-2",
                "acceleration",
            )
            for name, row in zip(self.sensors, self.rows, strict=True)
        ]
        drives = [
            Channel(f"force at {name}", self.config.points[name], Y, "N", "generic")
            for name in self.drives
        ]
        levels = [Level(f"run {number}", gap_m, number) for number in range(records)]
        return campaign_dataset(force, responses, channels, drives, levels, float(self.rate))


def without_force(campaign):
    """The campaign as a recorder without a force channel would have written it."""
    names = [name for name in campaign.variables if str(name).startswith("force")]
    return campaign.drop_vars([*names, "load_rms"])

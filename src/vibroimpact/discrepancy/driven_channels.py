"""Which channels the force drives, and which of the others show but a few bursts."""

import numpy as np

from vibroimpact.observation.sensed_motion import motion_there

from . import priors


def bursting(bench, records, driven):
    """Return (record, feature) bool: features of channels that the force does not drive and whose
    measured record is a few bursts over noise.

    Motion across the force is an instability: whether and when it breaks out for a moment is no
    property that two codes of one tube share, and the power of the record is that of the moment.
    Such features tell no more than to within features.BLEND.
    """
    layout, measured = bench.layout, bench.measured_features[records]
    peaked = measured[:, layout.kind == "kurtosis"] > priors.BURST
    return (peaked & ~driven)[:, layout.channel]


def driven_channels(bench):
    """Return (channel,): whether the linear structure answers to a force there; a contact force,
    whether it does at its support.
    """
    shapes, drive = motion_there(bench.bare, bench.signals.kinds), np.abs(bench.bare.drive_shapes)
    size = (np.abs(shapes)[:, :, None] * drive[:, None, :]).max(axis=(0, 2))
    return size > 1.0e-3 * size.max()

"""Which channels the force drives, and which of the others have only a few bursts."""

import numpy as np

from vibroimpact.observation.sensed_motion import motion_there

from . import priors
from .workbench import Workbench


def bursting(bench: Workbench, records: np.ndarray, driven: np.ndarray) -> np.ndarray:
    """Return (record, feature) bool: features of channels that the force does not drive and whose
    measured record has a few bursts above the noise.

    records (record,): indices. driven (channel,) bool: see driven_channels. Motion across the force
    is an instability. Two codes of one tube do not agree on whether and when it sets in, and the
    power of the record is that of the bursts. Such features are known to within features.BLEND.
    """
    layout, measured = bench.layout, bench.measured_features[records]
    peaked = measured[:, layout.kind == "kurtosis"] > priors.BURST
    return (peaked & ~driven)[:, layout.channel]


def driven_channels(bench: Workbench) -> np.ndarray:
    """Return (channel,) bool: whether the linear structure responds to a force at the channel, for
    a contact force at its support.
    """
    shapes, drive = motion_there(bench.bare, bench.signals.kinds), np.abs(bench.bare.drive_shapes)
    size = (np.abs(shapes)[:, :, None] * drive[:, None, :]).max(axis=(0, 2))
    return size > 1.0e-3 * size.max()

"""What is fitted of modes to one record: frequencies, damping, participations."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg


@dataclass(frozen=True)
class ModalFit:
    """Modal parameters fitted to one record.

    modes (fitted,): indices of the model's modes.
    log_frequency, log_damping (fitted,): ln of the fitted over the model's value.
    participation (channel, fitted): response per unit modal response to the force on drive.
    drive (fitted, force_channel).
    covariance (2 fitted, 2 fitted): of [log_frequency, log_damping].
    shape_covariance (channel, fitted, fitted): of participations with these fixed.
    shape_slopes (channel, fitted, 2 fitted): derivatives of participations by these.
    delay (channel,): s by which a channel lags the fit of the others, 0 where not significant.
    residual (channel,): RMS of the residual over that of the noise and of RESIDUAL_SHARE of the
    response, in the band.
    share (channel,): residual over response, RMS.
    """

    modes: np.ndarray
    drive: np.ndarray
    log_frequency: np.ndarray
    log_damping: np.ndarray
    participation: np.ndarray
    covariance: np.ndarray
    shape_covariance: np.ndarray
    shape_slopes: np.ndarray
    delay: np.ndarray
    residual: np.ndarray
    share: np.ndarray

    def of_modes(self, kept: np.ndarray) -> ModalFit:
        """Return the ModalFit of some modes, kept (fitted,) bool or their positions in another
        order, with the residual of all of them.
        """
        kept = np.arange(len(self.modes))[kept]
        both = np.concatenate([kept, kept + len(self.modes)])
        return replace(
            self,
            modes=self.modes[kept],
            drive=self.drive[kept],
            log_frequency=self.log_frequency[kept],
            log_damping=self.log_damping[kept],
            participation=self.participation[:, kept],
            covariance=self.covariance[np.ix_(both, both)],
            shape_covariance=self.shape_covariance[:, kept][:, :, kept],
            shape_slopes=self.shape_slopes[:, kept][:, :, both],
        )

    @property
    def joint_covariance(self) -> np.ndarray:
        """Return the covariance of [log_frequency, log_damping, participation], channel by channel
        of the last: of two close modes a channel determines the sum and hardly the difference.
        """
        channels, modes = self.participation.shape
        slopes = self.shape_slopes.reshape(channels * modes, 2 * modes)
        along = np.vstack([np.eye(2 * modes), slopes])
        alone = linalg.block_diag(np.zeros((2 * modes, 2 * modes)), *self.shape_covariance)
        return along @ self.covariance @ along.T + alone

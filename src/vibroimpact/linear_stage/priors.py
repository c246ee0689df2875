"""Every threshold and prior of the linear stage, of features and of maps, in one file."""

from math import exp

# Priors of the nuisances of a measured structure, one relative sigma: the differences that a modal
# test finds from a good model. An effect within them is not named.
FREQUENCY_SD = 0.003  # of each modal frequency
DAMPING_SD = 0.10  # of each modal damping
GAIN_SD = 0.02  # of each channel
NINETY_SD = 1.645  # sigma: half width of the 90 % interval of a normal law
SHAPE_SD = 0.003  # of a mode shape, relative to its largest value among the channels
# Of the change of a mode shape by an effect: it depends on the frequencies without the effect,
# which scatter.
SHAPE_LAW_SD = 0.01
# Degrees of freedom of the Student law of these differences, and the most that their spread is
# taken to be over these: it differs from structure to structure, which makes tails heavier than
# those of a normal law, yet no sound structure is off by many times as much. Both are assumptions.
TAILS = 8.0
WIDEST = 2.0
PULLED = 2.0  # sigma of the prior: few nuisances of the lowest record are farther off
# Share of the nuisances: where more are beyond PULLED and the lowest record is not linear, none is
# taken from it.
FEW_PULLED = 0.15
# sigma of the prior: mode_frequency_error, modal_damping and sensor_gain are named only where their
# interval lies outside
NAMED_BEYOND = 2.0

# Differences between two codes of the same physics in a feature, one sigma, in addition to the
# scatter of seeds.
FEATURE_SD = {
    "power": 0.15,
    "coherence": 0.03,
    "co": 0.05,
    "quad": 0.05,
    "skewness": 0.12,
    "kurtosis": 0.12,
}
# One sigma of the common damping factor of the modes that the lowest record does not show. The runs
# for the covariance vary it.
UNSEEN_DAMPING = 0.6
# dB, common to all bands and channels that the force drives in the linear structure (True), or does
# not drive
LEVEL_SD = {
    True: 0.2,
    False: 1.2,
}
LAW_SD = 0.08  # of the change of a feature by an effect: two codes never have exactly the same law
# the same, common to all features of the channels that the force drives, or does not drive
LAW_COMMON_SD = 0.15
# ln of kurtosis over that of a normal law: above it, a channel that the force does not drive has a
# few bursts
BURST = 2.0
RESIDUAL_SD = 0.15  # of ln of the low-level residual over noise

# s of the lowest record that are read, fewer where the records fill more than one batch, but at
# least the second value
READ_S, LEAST_READ_S = 24.0, 12.0

# residual over noise of the lowest record in a driven channel: above it, the structure is not
# linear there
LINEAR_RESIDUAL = 2.0
# residual over response, median of the driven channels: above it, the lowest record says nothing
# about the linear structure
UNREAD = 0.5
LINEAR_GAIN = 8.0  # of log likelihood: a linear effect is adopted above it
# sigma: corrections of nuisances are limited to it, so that they can not hide an effect. The limit
# is where an effect is adopted, as nothing else would correct a mode with a smaller error: 6.7 by
# the Student law, 6.5 with the spread limited to WIDEST.
CORRECTION_LIMIT = ((TAILS + 1.0) * exp(2.0 * LINEAR_GAIN / (TAILS + 1.0)) - TAILS) ** 0.5
LINEAR_SECOND = 8.0  # the same for two effects over the better one of them
# in all, including those of the lowest record: with more, differences between two codes in the
# first effects are named as another
MOST_EFFECTS = 2
PARAMETER_COST = 3.0  # of log likelihood per parameter beyond the first
NO_EXCESS = 0.5  # of the floor: a smaller excess is negligible
# p value of all features below which the bare model and the measurement disagree, and the
# false-discovery rate of marked bands of the map
SIGNIFICANT = 0.01
# of log likelihood on the lowest record: faults of the measuring chain closer than this to the best
# are ambiguous
LINEAR_AMBIGUOUS = 3.0
# Share of the chi-square beyond chance that a full explanation must remove; with less it is a
# partial one.
EXPLAINED = 0.75

"""Every threshold and prior of the linear stage, of features and of maps, in one file."""

# Nuisance of a measured structure, one sigma: what a modal test of a good model finds. Nothing
# within it is named.
FREQUENCY_SD = 0.003  # of each modal frequency
DAMPING_SD = 0.10  # of each modal damping
GAIN_SD = 0.02  # of each channel
NINETY_SD = 1.645  # sigma: half of the interval of 90 % of a normal law
SHAPE_SD = 0.003  # of a mode shape, relative to its largest value among the channels
# of what an effect changes of a mode shape: frequencies that scatter before it acts mix its modes
# otherwise
SHAPE_LAW_SD = 0.01
PULLED = 2.0  # sigma: of few nuisances only is the lowest record's pull beyond it
# of all nuisances: a lowest record that is not linear and pulls more so far tells the bare model
# none
FEW_PULLED = 0.15
# sigma of the prior: mode_frequency_error, modal_damping and sensor_gain are named only with their
# interval outside
NAMED_BEYOND = 2.0

# What two codes of the same physics differ by in a feature, one sigma, beside the scatter of seeds.
FEATURE_SD = {
    "power": 0.15,
    "coherence": 0.03,
    "co": 0.05,
    "quad": 0.05,
    "skewness": 0.12,
    "kurtosis": 0.12,
}
# factor of the damping of modes that the lowest record does not show, one sigma: what it changes is
# a direction left free
UNSEEN_DAMPING = 0.6
# dB common to all bands and channels that the force drives in the linear structure, and that it
# does not
LEVEL_SD = {
    True: 0.2,
    False: 1.2,
}
LAW_SD = 0.08  # of an effect's own change of a feature: two codes never share a law to the letter
LAW_COMMON_SD = (
    0.15  # the same, common to all features of the channels that the force drives, or does not
)
# ln of kurtosis over that of a normal law: above it a channel that the force does not drive holds a
# few bursts
BURST = 2.0
RESIDUAL_SD = 0.15  # of ln of the low-level residual over noise

# of the lowest record are read, less where the records fill more than one batch; no less than the
# second
READ_S, LEAST_READ_S = 24.0, 12.0

# of the lowest record's residual over noise, in a driven channel: above it the structure is not
# linear there
LINEAR_RESIDUAL = 2.0
# of the responses that the force drives: where modes leave more, the lowest record tells nothing of
# the linear structure
UNREAD = 0.5
LINEAR_GAIN = 8.0  # of log likelihood: a linear effect is adopted above it
# sigma: a nuisance is not corrected beyond it, so that it can not hide an effect; it is where one
# is adopted, for nothing would mend a mode that is off by less
CORRECTION_LIMIT = (2.0 * LINEAR_GAIN) ** 0.5
LINEAR_SECOND = 8.0  # the same of two over the better of them
# in all, those of the lowest record included: with more, what two codes of the first differ by
# finds a name
MOST_EFFECTS = 2
PARAMETER_COST = 3.0  # of log likelihood per parameter beyond the first
NO_EXCESS = 0.5  # floors: below it there is no excess to close
# global p below which the bare model and the measurement disagree, and the rate of bands of the map
# that are marked though nothing is there
SIGNIFICANT = 0.01
# of log likelihood on the lowest record: faults of the chain nearer than this to the best are not
# told apart
LINEAR_AMBIGUOUS = 3.0
# Share of the chi-square beyond chance that an explanation must take away; with less it is a part
# of one.
EXPLAINED = 0.75

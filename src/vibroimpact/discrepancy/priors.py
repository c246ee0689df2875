"""Every threshold and prior of the discrepancy workflow, in one file. Frozen before an acceptance
draw; see docs/method.md for what each was tuned on.

Nineteenth freeze: after what the fifth draw showed of noise, rest and runs that are thrown off, the
sixth of places, the seventh and eighth of noise that impacts hide and of pairs, which do not add
and are looked at closely only where they gain, the ninth of effects in excess of two and of
nuisances beside what bends the lowest record, the tenth of where such an effect is searched from
and of effects that held-out records contradict, the eleventh of nuisances that are free where such
an effect is judged, and of searches beside a mass, the thirteenth of laws that no campaign tells,
of runs that go two ways, and of explanations that make all records worse, the fourteenth of how a
candidate's own runs scatter, the fifteenth of the order in which what is named is told, the
sixteenth of designs that were too coarse, the seventeenth of pairs beside a linear effect, the
eighteenth of channels so late that they spoil a fit, of noise read low, and of an explanation that
makes all records worse by half.
"""

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
CORRECTION_LIMIT = (
    2.0  # sigma: a nuisance is not corrected beyond it, so that it can not hide an effect
)
# of all nuisances beyond that limit: a lowest record that is not linear and pulls more tells the
# bare model none
FEW_PULLED = 0.15
# of chi-square per value: readings of the lowest record that differ by more, differ by more than
# nuisances
CREDIBLE = 4.0
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
# degrees of freedom of the multivariate t law of a record's features: what no model explains shall
# not outvote the rest
TAIL = 100.0
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

# of every record are compared while candidates are calibrated, less where the records fill more
# than one batch
COMPARED_S = 24.0
SCREENED_S = 12.0  # of every record are simulated while all candidates are screened
NULL_SEEDS = 16  # runs of every record without an effect
FINAL_SEEDS = 8  # of the finalists and of the verification
FINALISTS = 4

# of the lowest record's residual over noise, in a driven channel: above it the structure is not
# linear there
LINEAR_RESIDUAL = 2.0
# of the responses that the force drives: where modes leave more, the lowest record tells nothing of
# the linear structure
UNREAD = 0.5
LINEAR_GAIN = 8.0  # of log likelihood: a linear effect is adopted above it
LINEAR_SECOND = 8.0  # the same of two over the better of them
# of the first effect's gain: a second effect that adds less may be what two codes of the first
# differ by
SECOND_SHARE = 0.1
# in all, those of the lowest record included: with more, what two codes of the first differ by
# finds a name
MOST_EFFECTS = 2
# of log likelihood: least gain of an effect that is named, beside the threshold from null seeds
GAIN = 15.0
PARAMETER_COST = 3.0  # of log likelihood per parameter beyond the first
# of log likelihood: candidates nearer than this to the best are not told apart; an effect that
# held-out records lose more by is vetoed
AMBIGUOUS = 8.0
ALIAS_AMBIGUOUS = 40.0  # the same for effects that the catalogue lists as aliases of the best
# of the best gain: other laws of the same quantity (of the contact's stiffness, of its damping)
# above it are not told apart
SAME_QUANTITY = 0.75
NULL_SIGMA = (
    2.054  # of the best gains of null seeds above their mean: the 98th percentile of a normal law
)
NO_EXCESS = 0.5  # floors: below it there is no excess to close
EXPLAINED_Z = (
    -3.4
)  # sigma by which a record's chi-square is too large: the model still misses something
# global p below which the bare model and the measurement disagree, and the rate of bands of the map
# that are marked though nothing is there
SIGNIFICANT = 0.01
# of log likelihood on the lowest record: linear effects nearer than this to the best; aliases of
# the catalogue
LINEAR_AMBIGUOUS = 3.0
LINEAR_ALIAS = 8.0
PARTLY = 0.5  # closed share above which an explanation that leaves something is still partly one
LEAST_CLOSED = 0.15  # closed share below which a gain of likelihood is no explanation

"""Every threshold and prior of the discrepancy workflow, in one file. Frozen before an acceptance draw; see docs/method.md for what each was tuned on."""

# Nuisance of a measured structure, one sigma: what a modal test of a good model finds. Nothing within it is named.
FREQUENCY_SD = 0.003  # of each modal frequency
DAMPING_SD = 0.10  # of each modal damping
GAIN_SD = 0.02  # of each channel
SHAPE_SD = 0.003  # of a mode shape, relative to its largest value among the channels
CORRECTION_LIMIT = 2.0  # sigma: a nuisance is not corrected beyond it, so that it can not hide an effect
NAMED_BEYOND = 2.0  # sigma of the prior: mode_frequency_error, modal_damping and sensor_gain are named only with their interval outside

# What two codes of the same physics differ by in a feature, one sigma, beside the scatter of seeds.
FEATURE_SD = {"power": 0.15, "coherence": 0.03, "co": 0.05, "quad": 0.05, "skewness": 0.05, "kurtosis": 0.04}
LAW_SD = 0.10  # of an effect's own change of a feature: two codes never share a law to the letter
RESIDUAL_SD = 0.15  # of ln of the low-level residual over noise

NULL_SEEDS = 16  # runs of every record without an effect
FINAL_SEEDS = 8  # of the finalists and of the verification
FINALISTS = 5

"""Every tuned number of the diagnosis. Priors have a source; the others were chosen on development
campaigns.
"""

# Priors of the nuisances of a measured structure, one relative sigma: what a modal test finds a
# good model to be off by.
FREQUENCY_SD = 0.003
DAMPING_SD = 0.15
GAIN_SD = 0.02

STRENGTH = 5.0  # of the dampers, over the impedance of the structure at its sensors
# Share of the lines that count as independent. A window ties neighbours together, and errors of a
# model repeat from line to line, as noise does not.
INDEPENDENT = 0.1
FORGET_S = 0.7  # of a stretch: until its unknown start is forgotten
STRETCH_S, SCREENED_S = 4.0, 2.8  # of a stretch that is fitted, and of one that is screened

# Gain in mean log power, on stretches that took no part, that one more effect must bring: at least,
# and as a share of what is gained without it.
LEAST_GAIN, LEAST_SHARE = 0.05, 0.1


# Decision: gains in mean log power on stretches that took no part.
NULL_GAIN, NULL_WIDTH = 0.12, 0.02  # at which an effect is as likely as nothing, and how sharply
RIVAL, RIVAL_SHARE = (
    0.02,
    0.04,
)  # difference of rivals that counts e-fold, and its share of the gain
REST, REST_WIDTH = 1.7, 0.25  # log power over the floor: something else is as likely as not
NOTHING_LEFT = 0.7  # log power over the floor, below which no further effect is looked for
# Excess in dB of the spectra of free runs over their floor. Of the model as given: something is
# missing, even if the holding force tells nothing. Of the completed model: it is refuted.
FREE_EXCESS_DB, REFUTED_DB = 1.5, 3.0
# Of an effect that free runs alone show: the least share of the excess that it closes, and the
# difference of rivals that counts e-fold.
CLOSED, FREE_RIVAL_DB = 0.6, 1.0
NAMED = 0.8  # probability from which an explanation is named
PARTLY = 0.5  # share of what is beyond the floor, from which a part is explained


def needed_gain(gained: float) -> float:
    """Return the gain that one more effect must bring beside what gains so much."""
    return LEAST_GAIN + LEAST_SHARE * max(gained, 0.0)

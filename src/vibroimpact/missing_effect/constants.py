"""Every constant that decides what is named, with its source; beside priors.EXPLAINED, which the
linear stage has too.
"""

ELSE = "+?"  # after the name of an explanation beside something else

# Prior probabilities, stated and not tuned.
NOTHING = 0.3  # that nothing is missing
SOMETHING_ELSE = 0.1  # that an effect is missing which the catalogue does not hold
PAIRS = 0.1  # of all that is left: two effects of the catalogue
NAMED = 0.9  # probability from which an explanation is named, or a set of them given
# Probability by chance of all that is measured, from which on nothing is looked for.
CHANCE = 0.5
# Share of the excess of the misfit that a completed model must close on the records that took no
# part; with less it is a part of what is missing.
CLOSED = 0.5

# What laws of one effect differ by, as a share of what the effect changes: of each value, and of
# all values of a group of channels together. Measured between this code and an independent one.
# (share, prior probability): none, that between two codes of one law, that between laws of a
# family.
LAWS = ((0.02, 0.4), (0.08, 0.4), (0.3, 0.2))
LAW_COMMON = 1.0  # times the share: all values of a group of channels together
# Changes smaller than this, squared and in units of the scatter, cannot be told from nothing.
SEEN = 30.0

# Something else looks like effects do, and in part like none: the share of its variance that is
# the same in all values; its size, in units of the scatter.
WHITE = 0.2
SIZES = (1.0, 30.0)
# What two right codes differ by looks like effects too, in the same units: one code's contact
# dissipates a little more than another's. Most likely of two structures in which nothing is
# hidden: 0.2 and 0.4, together 0.3.
ALIKE = 0.3

# Standard deviation of the logarithm of clearances that are right, in records at the onset of
# contact: two right codes, and a drawing and a support, differ by as much in how near a tube comes.
CLEARANCE_SD = 0.03

# Runs.
NULL_DRAWS = 12  # of nuisances
MEAN_RUNS = 12  # of the most probable ones
LENGTHS = (0.06, 0.15, 0.3, 0.6, 1.2)  # of the searched range: how far a simulated point tells
FEW_RUNS = 4  # of an explanation, for each parameter: with fewer, one of FEW_LENGTHS
FEW_LENGTHS = LENGTHS[1:3]

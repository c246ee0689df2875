"""The support of a linear model at one load and gap: read off a study, or estimated without one,
and written for finite-element programs. `measured` takes it from a campaign.

May import everything but reports and stages.
"""

"""Checks of a campaign: every check a row with a level and a sentence."""

"""Structures without a model: modes identified at the lowest level, completed by local laws.

Data flow one way: records -> levels -> modes -> places -> laws fitted -> hypotheses, which the
decision and the verdict of every diagnosis are given.
"""

"""Campaigns with a hidden effect, made by a code that shares nothing with `vibroimpact` but the
written campaign contract.
"""

"""Campaigns with a hidden effect, made by an independent code.

It shares nothing with `vibroimpact` but the written campaign contract.
"""

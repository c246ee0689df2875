"""Verification and validation against closed forms, published numbers and other codes.

The claims of the paper are judged here too.
"""

"""The evidence for vibroimpact: validation, acceptance draws, other codes, speed.

It imports the library; the library never imports it. `evidence.truth` imports nothing of either: it
is the independent code that makes campaigns with hidden effects.
"""

"""Wear life: from the work rate at a support to the depth in the wall of the tube.

It owns the worn volumes and shapes, and the command for them. It imports the configuration, the
geometry of sections and the records of a study.
"""

"""Supports and local elements: where they act, and their force laws."""

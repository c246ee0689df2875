"""Supports and local elements: their places, and their force laws."""

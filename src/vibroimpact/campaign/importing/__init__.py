"""Measurements into a campaign: UFF dataset 58, MATLAB, CSV and netCDF files, and the sidecar
campaign.yaml that says what they are.
"""

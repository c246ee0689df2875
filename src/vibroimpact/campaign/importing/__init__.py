"""Import of measurements into a campaign.

Read are UFF dataset 58, MATLAB, CSV and netCDF files, and the sidecar campaign.yaml that describes
them.
"""

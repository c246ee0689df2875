"""Recorded signals in files of other programs: CSV, MATLAB and netCDF, with units and sampling."""

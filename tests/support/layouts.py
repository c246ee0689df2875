"""A layout of spectra for tests of the identification."""

from vibroimpact.identify.spectra_layout import SpectraLayout

LAYOUT = SpectraLayout(
    spacing_Hz=0.1,
    highest=1200,
    line_first=80,
    line_last=600,
    window="hann",
    sensors=("apex.y", "bend_45.y"),
    response=0,
    broadband=1,
    references=(0, 1),
    force_band_Hz=(5.0, 200.0),
    broadband_Hz=(6.0, 99.0),
    stiffness_range=(1.0e3, 1.0e8),
)

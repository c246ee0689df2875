"""The equivalent linear support of a response: stiffness k and damping c of a bilateral support.

One module per method. `spectra` holds averaged spectra, `linear` the linear structure that the
methods compare with. Imports no campaign and no study.
"""

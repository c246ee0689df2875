"""A structure of two matrices, as a checked configuration."""

import numpy as np

from vibroimpact.config.reading import check_config


def matrix_study(folder, mass, stiffness, points=None, **sections):
    """Return the Config of a structure whose matrices are m.npz and k.npz of a folder.

    points: {name: dof along x}; "tip" at dof 0 by default. sections: of the configuration.
    """
    np.savez(folder / "m.npz", mass=mass)
    np.savez(folder / "k.npz", stiffness=stiffness)
    places = {"tip": 0} if points is None else points
    return check_config(
        {
            "study": "bench",
            "structure": {
                "kind": "matrices",
                "mass": str(folder / "m.npz"),
                "stiffness": str(folder / "k.npz"),
                "points": {name: {"x": dof} for name, dof in places.items()},
            },
            "excitation": {"kind": "none"},
            "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
            "record": {"duration_s": 1.0, "sampling_frequency_Hz": 2048},
        }
        | sections,
        "bench",
    )

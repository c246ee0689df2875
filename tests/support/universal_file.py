"""Universal files of a structure with nodes 1 and 2, for tests of imports."""

import pyuff


def write_uff(path, *functions, nodes=True):
    """Write datasets 58 into a file in SI units, with node 2 at x = 0.2 m; return it."""
    units = pyuff.prepare_164(
        units_code=1,
        units_description="SI",
        temp_mode=1,
        length=1.0,
        force=1.0,
        temp=1.0,
        temp_offset=0.0,
    )
    places = pyuff.prepare_15(
        node_nums=[1, 2],
        def_cs=[0, 0],
        disp_cs=[0, 0],
        color=[1, 1],
        x=[0.0, 0.2],
        y=[0.0, 0.0],
        z=[0.0, 0.0],
    )
    pyuff.UFF(str(path)).write_sets([units, *([places] if nodes else []), *functions], "overwrite")
    return path

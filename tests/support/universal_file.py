"""Universal files of a structure with nodes 1 and 2, for tests of imports."""

import pytest
import pyuff

# pyuff leaves a file that it writes to unclosed.
UNCLOSED = [
    pytest.mark.filterwarnings(
        "ignore:Exception ignored in.*uff:pytest.PytestUnraisableExceptionWarning"
    ),
    pytest.mark.filterwarnings("ignore:unclosed file.*uff:ResourceWarning"),
]


def dataset_58(values, x, node, direction, **stated):
    """A dataset 58 with values (sample,) over x (sample,), of a record in time if nothing else is
    stated; direction: 1, 2, 3 along an axis, negative against it.
    """
    usual = {
        "binary": 0,
        "func_type": 1,
        "id1": "signal",
        "load_case_id": 0,
        "rsp_ent_name": "NONE",
        "ref_node": 0,
        "ref_dir": 0,
        "ord_data_type": 4,
        "abscissa_spacing": 1,
        "abscissa_min": x[0],
        "abscissa_inc": x[1] - x[0],
        "num_pts": len(values),
        "z_axis_value": 0.0,
        "abscissa_spec_data_type": 17,
        "abscissa_axis_units_lab": "s",
        "orddenom_spec_data_type": 0,
    }
    return pyuff.prepare_58(data=values, x=x, rsp_node=node, rsp_dir=direction, **usual | stated)


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

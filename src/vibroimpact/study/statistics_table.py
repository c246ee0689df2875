"""The scalar statistics of a record as rows of a table."""

import xarray as xr

from vibroimpact.integration.energy_limit import energy_flag

AXES = ("support", "section", "element")
CASE = ("load_rms_N", "gap_m", "seed")


def statistics_rows(record: xr.Dataset) -> list[dict]:
    """Return a row for every value of the scalar and one-dimensional statistics of a record.

    Keys of a row: load_rms_N, gap_m, seed, quantity, of (name of the support, section or element;
    empty for the whole case), value, unit, flag (why the values of this case are of no use; empty
    if its energy balance closes).
    """
    case = {key: record.attrs[key] for key in CASE}
    flag = energy_flag(record)
    rows = []
    for name, variable in record.data_vars.items():
        if variable.ndim == 0:
            values = [("", float(variable))]
        elif variable.dims[0] in AXES and variable.ndim == 1:
            places = record[variable.dims[0]].values
            values = [
                (str(place), float(value))
                for place, value in zip(places, variable.values, strict=True)
            ]
        else:
            continue
        unit = variable.attrs["units"]
        rows += [
            {**case, "quantity": name, "of": place, "value": value, "unit": unit, "flag": flag}
            for place, value in values
        ]
    return rows

"""The scalar statistics of a record as rows of a table: what an engineer reads first."""

import xarray as xr

AXES = ("support", "section", "element")
CASE = ("load_rms_N", "gap_m", "seed")


def statistics_rows(record: xr.Dataset) -> list[dict]:
    """Return one row per quantity of a record with at most one named axis (support, section or
    element).

    Row keys: load_rms_N, gap_m, seed, quantity, of (name of the support, section or element; empty
    for the whole case), value, unit.
    """
    case = {key: record.attrs[key] for key in CASE}
    rows = []
    for name, variable in record.data_vars.items():
        if variable.ndim == 0:
            rows.append(
                {
                    **case,
                    "quantity": name,
                    "of": "",
                    "value": float(variable),
                    "unit": variable.attrs["units"],
                }
            )
        elif variable.dims[0] in AXES and variable.ndim == 1:
            places = record[variable.dims[0]].values
            rows += [
                {
                    **case,
                    "quantity": name,
                    "of": str(place),
                    "value": float(value),
                    "unit": variable.attrs["units"],
                }
                for place, value in zip(places, variable.values, strict=True)
            ]
    return rows

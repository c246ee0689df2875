"""Tables of numbers as programs write them: where their names stand, and what divides the cells."""

import numpy as np
import pytest
import yaml

from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.io.signal_files.csv_table import read_csv
from vibroimpact.io.signal_files.signals import UNREAD, ImportProblem

TABLE = np.array([[0.0, 1.25, -0.5], [0.001, 1.5, 0.75], [0.002, -0.25, 0.5]])
NAMED = [("force", "N", [1.25, 1.5, -0.25]), ("acc", "m/s^2", [-0.5, 0.75, 0.5])]


def read(tmp_path, text):
    path = tmp_path / "run.csv"
    path.write_text(text, encoding="utf-8")
    return [(signal.name, signal.unit, signal.values.tolist()) for signal in read_csv(path)]


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
@pytest.mark.parametrize(
    "header", ["time (s),force (N),acc (m/s^2)", "time(s), \t force(N), \t acc(m/s^2)"]
)
def test_names_of_numpy_savetxt_are_read(tmp_path, delimiter, header):
    path = tmp_path / "run.csv"
    np.savetxt(path, TABLE, delimiter=delimiter, header=f"run of 3 March\n{header}")
    found = read_csv(path)
    assert [(signal.name, signal.unit, signal.values.tolist()) for signal in found] == NAMED
    assert {signal.rate for signal in found} == {1000.0}


@pytest.mark.parametrize(
    "text",
    [
        "Zeit [s];force [N];acc [m/s^2]\n0,000;1,25;-0,50\n0,001;1,5;0,75\n0,002;-0,25;0,5\n",
        "time\tforce [N]\tacc [m/s^2]\n0\t1,25\t-0,5\n0,001\t1,5\t0,75\n0,002\t-0,25\t0,5\n",
        ",time,force [N],acc [m/s^2]\n,0,1.25,-.5\n,0.001,1.5,.75\n,0.002,-.25,.5\n",
        "time,force [N],acc [m/s^2],\n0,1.25,-.5,\n0.001,1.5,.75,\n0.002,-.25,.5,\n",
        "time,force [N],acc [m/s^2]\n# note\n0,1.25,-.5\n0.001,1.5,.75\n0.002,-.25,.5\n",
        '"time";"force [N]";"acc [m/s^2]"\n0;1.25;-.5\n0.001;1.5;.75\n0.002;-.25;.5\n',
        "% time,force [N],acc [m/s^2]\n0,1.25,-.5\n0.001,1.5,.75\n0.002,-.25,.5\n",
    ],
    ids=["decimal comma", "and tab", "begins empty", "ends empty", "comment", "quoted", "percent"],
)
def test_tables_of_many_programs_are_read(tmp_path, text):
    assert read(tmp_path, text) == NAMED


@pytest.mark.parametrize(
    "text, told",
    [
        (
            "0,1.25,-.5\n0.001,1.5,.75\n0.002,2,3\n",
            "line 1 holds numbers, the names of the columns",
        ),
        ("# of May\n0,1,2\n1,2,3\n2,3,4\n", "comment above line 2 has 1 names for 3 columns"),
        ("time,force\n0,1,2\n1,2,3\n", "line 2: 3 cells under 2 names"),
        ("time;force\n0,1;1.5\n0,2;2.5\n", "line 2, column time: '0,1' is no number"),
        ("time,,force\n0,1,2\n1,,3\n", "line 3, column : '' is no number"),
        ("time,force\n0,1\n", "holds no table|holds one sample"),
        ("LabVIEW Measurement,\nWriter_Version,2\n", "is a LabVIEW measurement file"),
    ],
)
def test_a_table_that_can_not_be_read_says_why(tmp_path, text, told):
    with pytest.raises(ImportProblem, match=told):
        read(tmp_path, text)


@pytest.mark.parametrize("described", [True, False])
@pytest.mark.parametrize("suffix", sorted(UNREAD))
def test_files_of_other_recorders_are_named(tmp_path, suffix, described):
    (tmp_path / f"run{suffix}").write_bytes(b"LabVIEW Measurement")
    if described:
        (tmp_path / "other.csv").write_text("time,force\n0,1\n1,2\n")
        sensor = {"point_m": [0, 0, 0], "direction": "+x"}
        sidecar = {
            "forces": [{"name": "force", **sensor}],
            "channels": [{"name": "tip", **sensor}],
            "records": [{"file": f"run{suffix}"}],
        }
        (tmp_path / "campaign.yaml").write_text(yaml.safe_dump(sidecar))
    with pytest.raises(ImportProblem) as problem:
        import_folder(tmp_path)
    assert str(problem.value) == f"{tmp_path / f'run{suffix}'}: {UNREAD[suffix]}"

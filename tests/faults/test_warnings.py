"""A warning of numpy in a job's log (division by zero, invalid value, cast) is said at the end."""

import subprocess
import sys

import pytest
import yaml

from tests.faults.runs import Runs
from tests.support.tiny_study import ROOT
from vibroimpact_workflow.run_report import warnings_text

WARNING = "RuntimeWarning: divide by zero encountered in divide"


def test_warnings_in_logs_are_named_with_their_log(tmp_path):
    logs = [tmp_path / f"simulate_{number}.log" for number in range(8)]
    for log in logs[1:]:
        log.write_text(f"begun\n/a b/c.py:12: {WARNING}\n  1 / x\n/a b/c.py:13: UserWarning: x\n")
    logs[0].write_text("no Warning: here\n")
    lines = warnings_text([*logs, tmp_path / "none.log"]).splitlines()
    assert lines[0].startswith("7 jobs warned; look at the numbers")
    assert lines[1] == f"  {logs[1]}: {WARNING}" and lines[-1] == "  and 2 more"
    assert len(lines) == 7
    assert warnings_text(logs[:1]) == ""


@pytest.mark.parametrize(
    ("expression", "warned"),
    [
        ("numpy.float64(1.0) / numpy.zeros(1)", "divide by zero"),
        ("numpy.zeros(1) / numpy.zeros(1)", "invalid value encountered in divide"),
        ("numpy.array([numpy.inf]).astype(int)", "invalid value encountered in cast"),
        ("numpy.array([1e300]) ** 2", "overflow encountered in square"),
    ],
)
def test_a_job_that_warns_is_found_by_its_log(expression, warned, tmp_path, reliability):
    program = f"""
import sys
sys.path.insert(0, {str(ROOT / "src")!r})
from vibroimpact.io.job_log import redirect_output
import numpy
redirect_output("job.log")
{expression}
"""
    (tmp_path / "script.py").write_text(program)
    subprocess.run([sys.executable, "script.py"], cwd=tmp_path, check=True)
    assert warned in warnings_text([tmp_path / "job.log"])
    reliability.fault(
        "a job divides by zero, overflows or casts a NaN", "the end of the run names the job"
    )


@pytest.mark.slow
@pytest.mark.parametrize("configuration", ["smoke", "study"])
def test_no_job_of_a_study_warns(configuration, tmp_path, reliability):
    file = ROOT / "config" / f"{configuration}.yaml"
    runs = Runs(tmp_path, yaml.safe_load(file.read_text(encoding="utf-8")))
    code, told = runs.run()
    assert code == 0 and " warned; " not in told, told
    logs = list(runs.results.glob("logs/*.log"))
    assert len(logs) > 10 and warnings_text(logs) == ""
    assert [log.name for log in logs if "Warning" in log.read_text(encoding="utf-8")] == []
    name = {"smoke": "small", "study": "default"}[configuration]
    reliability.fault(f"warnings of numpy in the {name} study", "none in the log of any job")

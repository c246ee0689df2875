"""What a run says at its end: the headline of a study, or what failed and what to do about it."""

import numpy as np

from vibroimpact.study.headline import headline
from vibroimpact.study.reasons import NOT_MOVED
from vibroimpact_workflow.run_report import failure_text, success_text


def row(gap_m, load_rms_N, k, agreement, group="all", direction="y", reason=""):
    """A row of equivalent.csv, as far as the headline reads it."""
    return {
        "gap_m": gap_m,
        "load_rms_N": load_rms_N,
        "group": group,
        "direction": direction,
        "k_N_per_m": k,
        "agreement_k": agreement,
        "reason_k": reason,
    }


ROWS = [
    row(2.9e-4, 0.1, np.nan, "unresolved", reason="too soft"),
    row(2.9e-4, 20.0, 1.1e6, "agree"),
    row(2.9e-4, 2.0, 1.2e4, "spread"),
    row(5.0e-5, 20.0, 9.0e6, "agree"),
    row(2.9e-4, 20.0, np.nan, "unresolved", direction="x", reason=NOT_MOVED),
]
LOG = """\
[Tue Nov 24 06:47:40 2026]
Job 6: Simulation at 0.1 N RMS: 4 of 12 cases
Job 7: Simulation at 4 N RMS: 4 of 12 cases
[Tue Nov 24 06:47:46 2026]
Error in rule _simulate:
    message: None
    jobid: 7
    output: results/smoke/records/load_4_gap_0.0001_seed_0.nc
    log: {log} (check log file(s) for error details)

Shutting down, this might take some time.
"""


def test_headline_is_of_the_largest_gap():
    assert headline(ROWS) == (
        "k from 1.2e4 N/m at 2 N to 1.1e6 N/m at 20 N (gap 0.29 mm). 2 of 3 pairs of load and gap"
        " that the methods resolve agree on k within 25 %; in 1 they are more than 25 % apart; in 1"
        " k is not resolved"
    )


def test_headline_of_one_resolved_load_names_it_once():
    assert headline(ROWS[:2]).startswith("k = 1.1e6 N/m at 20 N (gap 0.29 mm). 1 of 1 pairs")


def test_headline_says_when_nothing_is_resolved():
    assert headline(ROWS[:1]) == (
        "no load at which k is resolved (gap 0.29 mm). The methods resolve k in none of 1 pairs of"
        " load and gap; in 1 k is not resolved"
    )


def test_headline_names_each_group_of_supports():
    groups = [row(3e-4, 15.0, 4.3e3, "agree", "plate"), row(3e-4, 15.0, 5.2e5, "spread", "bars")]
    assert headline(groups) == (
        "plate in y: k = 4.3e3 N/m at 15 N; bars in y: k = 5.2e5 N/m at 15 N (gap 0.3 mm). 1"
        " of 2 cases that the methods resolve agree on k within 25 %; in 1 they are more than 25 %"
        " apart"
    )


def test_success_names_the_files_that_are_there(tmp_path):
    folder = tmp_path / "mine"
    (folder / "figures").mkdir(parents=True)
    (folder / "consistency.csv").touch()
    told = success_text(folder, ROWS).splitlines()
    assert told[0].startswith("Study 'mine': k from ")
    assert told[1:] == [f"  {folder}/consistency.csv", f"  {folder}/figures"]
    assert success_text(folder, []).splitlines()[0] == f"  {folder}/consistency.csv"


def test_failure_names_case_log_and_remedy(tmp_path):
    log = tmp_path / "simulate_load_4.log"
    lines = "".join(f"line {number}\n" for number in range(20))
    log.write_text(lines + "IntegrationError: big\n\n")
    told = failure_text(LOG.format(log=log) * 2).splitlines()  # Snakemake may log a job twice
    assert told[:2] == ["1 job failed:", "  Simulation at 4 N RMS: 4 of 12 cases (rule simulate)"]
    assert told[2] == f"    {log} ends with"
    assert told[3:9] == [f"      line {n}" for n in range(15, 20)] + ["      IntegrationError: big"]
    assert told[-1].startswith("Mend what the last line says and give the same command again")


def test_failure_with_an_empty_log_speaks_of_memory(tmp_path):
    (tmp_path / "empty.log").touch()
    told = failure_text(LOG.format(log=tmp_path / "empty.log"))
    assert "empty.log is empty: see the lines above. A job that is stopped" in told


def test_a_job_that_a_later_attempt_finished_has_not_failed():
    told = LOG.format(log="none.log") + "Finished jobid: 7 (Rule: _simulate)\n"
    assert failure_text(told) == ""
    other = told + told.split("\n", 3)[3].replace("jobid: 7", "jobid: 6").split("Finished")[0]
    assert failure_text(other).startswith("1 job failed:\n  Simulation at 0.1 N RMS")


def test_a_run_without_failed_jobs_says_nothing():
    assert failure_text("Finished job 0.\n") == ""

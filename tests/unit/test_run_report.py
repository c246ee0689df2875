"""What a run says at its end: the headline of a study, or what failed and what to do about it."""

import numpy as np

from vibroimpact.study.run_report import failure_text, headline, success_text


def rows(gap_m, load_rms_N, stiffness, verdict):
    """Rows of the summary of one load and gap: the three independent methods, and another."""
    values = zip(("lscf", "ods", "broadband", "secant"), (*stiffness, 1.0), strict=True)
    return [
        {
            "gap_m": gap_m,
            "load_rms_N": load_rms_N,
            "method": method,
            "k_median": value,
            "verdict": verdict,
        }
        for method, value in values
    ]


SUMMARY = [
    *rows(2.9e-4, 0.1, (np.nan, 5.0e3, np.nan), "unresolved"),
    *rows(2.9e-4, 20.0, (1.0e6, 1.1e6, 1.3e6), "agree"),
    *rows(2.9e-4, 2.0, (1.2e4, 1.0e4, 3.0e4), "spread"),
    *rows(5.0e-5, 20.0, (9.0e6, 9.0e6, 9.0e6), "agree"),
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


def test_headline_is_of_the_largest_gap_and_its_median():
    assert headline(SUMMARY) == (
        "k from 1.2e4 N/m at 2 N to 1.1e6 N/m at 20 N (gap 0.29 mm); methods agree in 2 of 4"
        " pairs of load and gap"
    )


def test_headline_of_one_resolved_load_names_it_once():
    assert headline(SUMMARY[:8]).startswith("k = 1.1e6 N/m at 20 N (gap 0.29 mm); methods agree")


def test_headline_says_when_nothing_is_resolved():
    assert headline(SUMMARY[:4]) == (
        "no load at which all three methods resolve the support (gap 0.29 mm); methods agree in 0"
        " of 1 pairs of load and gap"
    )


def test_success_names_the_files_that_are_there(tmp_path):
    folder = tmp_path / "mine"
    (folder / "figures").mkdir(parents=True)
    (folder / "consistency.csv").touch()
    told = success_text(folder, SUMMARY).splitlines()
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


def test_a_run_without_failed_jobs_says_nothing():
    assert failure_text("Finished job 0.\n") == ""

# Around the jobs: whose the folder is, what a run writes and says at its start and end, how
# Snakemake picks its next jobs. The library is imported by runs alone, never by a dry run or a job.
from snakemake.logging import logger

LOCK = ".snakemake/vibroimpact_run.txt"


def planned_jobs():
    """The jobs of this run."""
    return list(workflow.dag.needrun_jobs(exclude_finished=False))


def begin_run():
    """Take the folder, clean up after a killed run, and write the files of this one.

    Exits with a sentence where another run is at work in it or it cannot be written.
    """
    from vibroimpact.io.whole_file import RecordError, remove_left_over
    from vibroimpact_workflow.run_lock import FolderTaken, require_past, start_text, take_folder

    try:
        require_past(str(file) for job in planned_jobs() for file in job.input)
        killed = take_folder(LOCK, sys.argv) if workflow.is_main_process else ""
        folders = {Path(file).parent for job in planned_jobs() for file in job.output}
        for line in start_text(killed, remove_left_over(folders)):
            logger.info(line)
        write_files_of_run(folders)
    except (FolderTaken, RecordError) as error:
        sys.exit(str(error))


def write_files_of_run(folders):
    """Write provenance into every folder in results/ that this run writes to, and the configuration
    of a study, or of the model that a campaign is compared with.
    """
    from vibroimpact.study.run_files import write_run_files

    configurations = {Path(RESULTS): STUDY, Path("results/validation"): STUDY}
    if not WITHOUT_MODEL:
        if any(job.rule.name.startswith("_discrepancy") for job in planned_jobs()):
            configurations[Path(DISCREPANCY)] = MODEL
        configurations[Path(f"results/{MEASURED}")] = MODEL
    for folder in {Path(*folder.parts[:2]) for folder in folders if folder.parts[0] == "results"}:
        values = configurations.get(folder)
        write_run_files(folder, values and values.model_dump(mode="json"), sys.argv)


def say_success():
    """Say the headline of the study where this run has completed it, and which jobs warned."""
    from vibroimpact.io.records import read_table
    from vibroimpact_workflow.run_report import success_text

    say_warnings()
    if "all" in {job.rule.name for job in workflow.dag.finished_jobs}:
        table = Path(RESULTS, "equivalent.csv")
        logger.info(success_text(RESULTS, read_table(table) if table.is_file() else []))


def say_failure(logs):
    """Say which jobs failed, the ends of their logs, and what to do next.

    logs: the log files that Snakemake wrote of this run.
    """
    from vibroimpact.io.whole_file import read_text
    from vibroimpact_workflow.run_report import failure_text

    text = failure_text("".join(read_text(file) for file in logs if Path(file).is_file()))
    if text:
        logger.error(text)
    say_warnings()


def say_warnings():
    """Say which logs of this run hold warnings."""
    from vibroimpact_workflow.run_report import warnings_text

    text = warnings_text([str(file) for job in workflow.dag.finished_jobs for file in job.log])
    if text:
        logger.warning(text)


def start_no_timers():
    """Lift the limit of 100 started jobs per second that Snakemake sets where none is given.

    With a limit, each round of scheduling starts a thread that starts another round a second later,
    which starts another thread. Every job that ends begins one more such chain: threads, and rounds
    per second, grow with the jobs done. A limit given by --max-jobs-per-timespan stays.
    """
    limit = getattr(workflow.scheduler, "job_rate_limiter", None)
    if limit is not None and (limit.max_jobs, limit.timespan) == (100, 1):
        workflow.scheduler.job_rate_limiter = None

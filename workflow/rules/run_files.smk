# What a run writes beside its results and says at its end: its configuration, where it comes from,
# the headline of the study, or what failed.
from snakemake.logging import logger
from vibroimpact.io.records import read_table, read_text
from vibroimpact.study.run_files import write_run_files
from vibroimpact.study.run_owner import FolderTaken, require_past, start_text, take_folder
from vibroimpact.study.run_report import failure_text, success_text, warnings_text
from vibroimpact.io.whole_file import RecordError, remove_left_over

# Whose this folder is. The lock that goes with it takes the place of Snakemake's, see the profile.
MARK = ".snakemake/vibroimpact_run.json"


def planned_jobs():
    """The jobs of this run."""
    return list(workflow.dag.needrun_jobs(exclude_finished=False))


def result_folders():
    """The folders in results/ that the jobs of this run write to."""
    files = [Path(file) for job in planned_jobs() for file in job.output]
    return {Path(*file.parts[:2]) for file in files if file.parts[0] == "results"}


def begin_run():
    """Take the folder, clean up after a killed run, and write the files of this one.

    Exits with a sentence where another run is at work in it or it cannot be written.
    """
    try:
        require_past(str(file) for job in planned_jobs() for file in job.input)
        killed = take_folder(MARK, sys.argv) if workflow.is_main_process else None
        folders = {Path(file).parent for job in planned_jobs() for file in job.output}
        for line in start_text(killed, remove_left_over(folders)):
            logger.info(line)
        write_files_of_run()
    except (FolderTaken, RecordError) as error:
        sys.exit(str(error))


def write_files_of_run():
    """Write provenance into every folder that this run writes to, and the configuration of a study,
    or of the model that a campaign is compared with.
    """
    configurations = {Path(RESULTS): STUDY, Path("results/validation"): STUDY}
    if not WITHOUT_MODEL and any(
        job.rule.name.startswith("_discrepancy") for job in planned_jobs()
    ):
        configurations[Path(DISCREPANCY)] = MODEL
    if not WITHOUT_MODEL:
        configurations[Path(f"results/{MEASURED}")] = MODEL
    for folder in result_folders():
        values = configurations.get(folder)
        write_run_files(folder, values and values.model_dump(mode="json"), sys.argv)


def say_success():
    """Say the headline of the study where this run has completed it, and which jobs warned."""
    table = Path(RESULTS, "equivalent.csv")
    say_warnings()
    if "all" in {job.rule.name for job in workflow.dag.finished_jobs}:
        rows = read_table(table) if table.is_file() else []
        logger.info(success_text(RESULTS, rows))


def say_failure(logs):
    """Say which jobs failed, the ends of their logs, and what to do next.

    logs: the log files that Snakemake wrote of this run.
    """
    text = failure_text("".join(read_text(file) for file in logs if Path(file).is_file()))
    if text:
        logger.error(text)
    say_warnings()


def say_warnings():
    """Say which logs of this run hold warnings."""
    logs = [str(file) for job in workflow.dag.finished_jobs for file in job.log]
    text = warnings_text(logs)
    if text:
        logger.warning(text)

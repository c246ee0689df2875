# The campaign or the folder of measurements that --config names: its name, and what its file
# states, are checked before a job is planned. The library is imported where one is asked for.
from functools import cache

from vibroimpact.config.reserved_names import name_problem

IMPORTED = Path(REQUEST.get("import", "import")).resolve().name


def require_free_folder(key, name):
    """Exit with a sentence where the results of --config key=PATH would overwrite others."""
    problem = name_problem(name, STUDY.study)
    if key in REQUEST and problem:
        sys.exit(f"{key} = '{REQUEST[key]}': {problem}: give it another name")


require_free_folder("campaign", LOOKED_AT)
require_free_folder("equivalent_of", MEASURED)
require_free_folder("import", IMPORTED)


@cache
def described(file, force_needed=True):
    """A campaign file without its signals.

    Exits with a sentence for everything it states that can not be.
    """
    from vibroimpact.campaign.file import CampaignError, checked_description
    from vibroimpact.io.whole_file import RecordError

    try:
        return checked_description(file, force_needed)
    except (CampaignError, RecordError) as error:
        sys.exit(str(error))


if STUDY.overlay.campaign is not None:
    described(STUDY.overlay.campaign)


def asked_campaign(wildcards):
    """The file of --config campaign=FILE, which keeps the contract of campaign files."""
    file = requested("campaign", "FILE.nc")(wildcards)
    described(file)
    return file


def measured_campaign(wildcards):
    """The file of --config equivalent_of=FILE; it may hold no force."""
    from vibroimpact.equivalent_support.measured.usable import identification_problems

    file = requested("equivalent_of", "FILE.nc")(wildcards)
    if WITHOUT_MODEL:
        sys.exit("model = 'identified' has no supports to identify: give model=FILE of the tube")
    problems = identification_problems(MODEL, described(file, force_needed=False))
    if problems:
        sys.exit("\n".join(f"{file}: {problem}" for problem in problems))
    return file


@cache
def require_comparable():
    """Exit where a model can not be compared; say which channels are left out of a comparison."""
    from vibroimpact.diagnosis.measurement.comparable import channel_rows, comparison_problems

    file = REQUEST["campaign"]
    problems = comparison_problems(MODEL, described(file))
    if problems:
        sys.exit("\n".join(f"{file}: {problem}" for problem in problems))
    if workflow.is_main_process:
        for row in channel_rows(described(file)):
            print(f"{file}: {row['message']}", file=sys.stderr)


def compared_campaign(wildcards):
    """The file of --config campaign=FILE, which can be compared with the model."""
    file = asked_campaign(wildcards)
    require_comparable()
    return file


def measured_files(wildcards):
    """The files of --config import=FOLDER that are read, as an input function.

    Exits with the problems where they can not be imported, before a job is planned: Snakemake tells
    of a job that fails in sixty lines.
    """
    return folder_to_import(REQUEST["import"])


@cache
def folder_to_import(folder):
    """The files that the import of a folder reads; where there is no campaign.yaml, a draft is
    written.
    """
    from vibroimpact.campaign.importing.draft import checked_folder
    from vibroimpact.campaign.importing.raw_files import raw_files
    from vibroimpact.io.signal_files.signals import ImportProblem

    try:
        if not workflow.is_main_process:
            return [str(file) for file in raw_files(folder)]
        return [
            str(file) for file in checked_folder(folder, f"results/{IMPORTED}/campaign.draft.yaml")
        ]
    except ImportProblem as problem:
        sys.exit(str(problem))

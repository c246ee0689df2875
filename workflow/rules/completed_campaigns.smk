# The campaigns whose structure is identified from their records, and the files of their completion.
from dataclasses import asdict

from vibroimpact.completion.store import read_values
from vibroimpact.completion.structure_file import read_structure
from vibroimpact.completion.study import laws_to_fit

# Campaigns whose structure is identified from their records: {name of the folder of results:
# (campaign file, StructureFile)}.
COMPLETED = {LOOKED_AT: (REQUEST.get("campaign", ""), OWN)} if OWN is not None else {}


def complete(name, campaign, model):
    """Complete a campaign file with the structure of a YAML file, in results/<name>/."""
    COMPLETED[name] = (campaign, read_structure(model))


def downloaded(key, default, pattern, what):
    """The files in the folder that --config key=FOLDER gives, as an input.

    The run stops with a sentence where there are none.
    """

    def paths(wildcards):
        folder = REQUEST.get(key, default)
        found = sorted(Path(folder).glob(pattern))
        if not found:
            shown = pattern.replace("*", "<N>").replace("?", "u")
            sys.exit(
                f"{key} = '{folder}' holds no file {shown}: download {what} from"
                f" nonlinearbenchmark.org and give its folder: --config {key}=FOLDER"
            )
        return [str(file) for file in found]

    return paths


def campaign_completed(wildcards):
    """The campaign file of wildcard {structure}; a sentence where --config names one that is not
    there.
    """
    if wildcards.structure == LOOKED_AT and OWN is not None:
        return asked_campaign(wildcards)
    return COMPLETED[wildcards.structure][0]


def structure_completed(wildcards):
    """What is stated of the structure of wildcard {structure}."""
    return asdict(COMPLETED[wildcards.structure][1])


def law_files(structure, kind):
    """The files of a structure's "candidates", or of "additions" to the best of them."""
    prepared = checkpoints._completion_prepare.get(structure=structure).output.study
    return [
        f"results/{structure}/{kind}/{name}.json"
        for name in laws_to_fit(read_values(prepared), kind)
    ]


def candidate_files(wildcards):
    """The files of all single candidates of wildcard {structure}."""
    return law_files(wildcards.structure, "candidates")


def addition_files(wildcards):
    """The files of all second effects tried with the best candidate of wildcard {structure}."""
    return law_files(wildcards.structure, "additions")

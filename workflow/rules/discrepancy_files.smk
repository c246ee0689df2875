# The files of candidates, finalists and pairs, known once earlier jobs have named them.
from vibroimpact.discrepancy.dag import finalist_names, pair_names, screened_files, screened_names


def path_files(wildcards):
    """The files of the candidates that are screened, after the linear stage."""
    names = screened_names(checkpoints._discrepancy_prepare.get().output.prepared)
    return [str(file) for file in screened_files(names, DISCREPANCY, BANK)]


def finalist_files(wildcards):
    """The files of the finalists of the screening."""
    names = finalist_names(checkpoints._discrepancy_screening.get().output.screening)
    return [f"{DISCREPANCY}/finalists/{name}.npz" for name in names]


def pair_files(wildcards):
    """The files of the pairs of effects to simulate."""
    return [
        f"{DISCREPANCY}/pairs/{name}.npz"
        for name in pair_names(checkpoints._discrepancy_pairs.get().output.pairs)
    ]

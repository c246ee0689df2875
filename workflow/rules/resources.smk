# What a job asks a cluster for. Values in rules are those of the first attempt: a job that fails,
# for lack of memory or time, asks for as much again with each attempt (`--retries`).


def memory(first_MB):
    """The memory of a job in MB, by its attempt.

    first_MB: covers the script and two Snakemake processes of about 160 MB each, which a job of
        a cluster has beside its script.
    """
    return lambda wildcards, attempt: first_MB * attempt


def minutes(first):
    """The longest time that a job may take in minutes, by its attempt."""
    return lambda wildcards, attempt: first * attempt

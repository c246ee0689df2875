# Which campaigns of a suite are judged, and the verdicts that another suite is compared with.
from vibroimpact.acceptance.shards import numbers_added, numbers_judged, shard_of, suite_name


def suite_campaigns(suite, added):
    """The numbers of the campaigns to judge.

    They are those of the shard that are not in the campaigns.csv files `added`; with count=judged,
    those that have a verdict.
    """
    count = REQUEST.get("count", "12")
    try:
        known = numbers_added(added, Path(suite).name)
        numbers = (
            numbers_judged(suite)
            if count == "judged"
            else shard_of(count, REQUEST.get("shard", "0/1"))
        )
    except ValueError as problem:
        sys.exit(str(problem))
    return [number for number in numbers if number not in known]


def plain_verdicts(seed, suite, campaigns):
    """The verdicts of the plain suite of the same seed, as an input function.

    Exits with a sentence where `suite` is the plain one itself.
    """

    def paths(wildcards):
        plain = f"results/{suite_name(seed)}"
        if suite == plain:
            sys.exit(
                "suite_difference compares with the plain suite: say what differs, as in --config"
                " seconds=49 or draw=1"
            )
        return [f"{plain}/campaign_{number:04d}/verdict.json" for number in campaigns]

    return paths

# Which campaigns of a draw are judged.
from evidence.acceptance.shards import WHOLE_DRAW, numbers_added, numbers_judged, shard_of


def drawn_campaigns(draw, added):
    """The numbers of the campaigns to judge.

    They are those of the shard that are not in the campaigns.csv files `added`; with count=judged,
    those that have a verdict.
    """
    count = REQUEST.get("count", str(WHOLE_DRAW))
    try:
        known = numbers_added(added, Path(draw).name)
        numbers = (
            numbers_judged(draw)
            if count == "judged"
            else shard_of(count, REQUEST.get("shard", "0/1"))
        )
    except ValueError as problem:
        sys.exit(str(problem))
    return [number for number in numbers if number not in known]

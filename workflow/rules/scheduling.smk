# How Snakemake picks its next jobs: where its own way costs more with every job that is done.


def start_no_timers():
    """Lift the limit of 100 started jobs per second that Snakemake sets where none is given.

    With a limit, each round of scheduling starts a thread that starts another round a second later,
    which starts another thread. Every job that ends begins one more such chain: threads, and rounds
    per second, grow with the jobs done. A limit given by --max-jobs-per-timespan stays.
    """
    limit = getattr(workflow.scheduler, "job_rate_limiter", None)
    if limit is not None and (limit.max_jobs, limit.timespan) == (100, 1):
        workflow.scheduler.job_rate_limiter = None

# Campaigns in which another code hid an effect, judged:
# `snakemake -j2 suite --config suite_seed=1 count=90 shard=0/1`.
# Shards add up, and a rerun continues. Without suite_seed the seed comes from the file of
# thresholds. seconds=49 makes the campaigns longer, draw=1 simulates with other seeds, and
# suite_difference compares such a suite with the plain one. count=judged writes the page of the
# campaigns that have a verdict; add=FILE,FILE adds the campaigns.csv of shards that were judged
# elsewhere.
from vibroimpact.acceptance.shards import SUITE_NAME, SUITE_S, frozen_seed, suite_name

SUITE_SEED = number_asked("suite_seed", example="1", whole=True)
if SUITE_SEED is None:
    SUITE_SEED = frozen_seed(f"{SOURCE}/vibroimpact/discrepancy/priors.py")
SUITE_SEED = int(SUITE_SEED)
SECONDS = int(number_asked("seconds", example="49", whole=True) or SUITE_S)
SUITE = f"results/{suite_name(SUITE_SEED, SECONDS, DRAW)}"
SUITE_ADDED = [file for file in REQUEST.get("add", "").split(",") if file]
SUITE_CAMPAIGNS = suite_campaigns(SUITE, SUITE_ADDED)
SUITE_FIGURES = (
    "suite_rates",
    "suite_confusion",
    "suite_strength",
    "suite_parameters",
)  # in the order of the page


wildcard_constraints:
    suite=SUITE_NAME,
    number=r"[0-9]{4}",


rule _suite_bank:
    output:
        campaign="results/{suite}/bank/bank.nc",
        done="results/{suite}/bank/verdict.json",
    log:
        "results/{suite}/logs/bank.log",
    benchmark:
        "results/{suite}/benchmarks/bank.tsv"
    threads: 8
    resources:
        mem_mb=memory(6000),
        runtime=minutes(120),
    params:
        library=library("suite_bank"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Candidates without a hidden effect, for all campaigns of {wildcards.suite}"
    script:
        "../scripts/suite_bank.py"


rule _suite_campaign:
    input:
        bank="results/{suite}/bank/verdict.json",
    output:
        verdict="results/{suite}/campaign_{number}/verdict.json",
        truth="results/{suite}/truth/campaign_{number}.json",
    log:
        "results/{suite}/logs/campaign_{number}.log",
    benchmark:
        "results/{suite}/benchmarks/campaign_{number}.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=library("suite_campaign"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Campaign {wildcards.number} of {wildcards.suite}"
    script:
        "../scripts/suite_campaign.py"


rule suite:
    """Judge verdicts on campaigns in which an effect is hidden: --config count=N."""
    input:
        template=f"{SOURCE}/vibroimpact/reports/suite_page.html",
        added=SUITE_ADDED,
        verdicts=[f"{SUITE}/campaign_{number:04d}/verdict.json" for number in SUITE_CAMPAIGNS],
    output:
        rates=f"{SUITE}/rates.csv",
        campaigns=f"{SUITE}/campaigns.csv",
        confusion=f"{SUITE}/confusion.csv",
        detection=f"{SUITE}/detection.csv",
        figures=[
            f"{SUITE}/figures/{name}.{suffix}"
            for name in SUITE_FIGURES
            for suffix in ("png", "pdf", "csv", "txt")
        ],
        page=f"{SUITE}/report.html",
    log:
        f"{SUITE}/logs/suite.log",
    benchmark:
        f"{SUITE}/benchmarks/suite.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(10),
    params:
        library=library("suite"),
        campaigns=len(SUITE_CAMPAIGNS),
        seed=SUITE_SEED,
    message:
        f"Suite of seed {SUITE_SEED}: {SUITE}/report.html"
    script:
        "../scripts/suite.py"


rule suite_difference:
    """Judge a suite again with other seeds or lengths: --config draw=1 or seconds=49."""
    input:
        plain=plain_verdicts(SUITE_SEED, SUITE, SUITE_CAMPAIGNS),
        other=[f"{SUITE}/campaign_{number:04d}/verdict.json" for number in SUITE_CAMPAIGNS],
    output:
        campaigns=f"{SUITE}/difference.csv",
        rates=f"{SUITE}/difference_rates.csv",
    log:
        f"{SUITE}/logs/suite_difference.log",
    benchmark:
        f"{SUITE}/benchmarks/suite_difference.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("suite_difference"),
        campaigns=[f"campaign_{number:04d}" for number in SUITE_CAMPAIGNS],
    message:
        f"Verdicts of {SUITE} against those of the plain one: {SUITE}/difference.csv"
    script:
        "../scripts/suite_difference.py"


include: "suite_check.smk"

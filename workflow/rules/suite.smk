# The hidden-effect suite: `snakemake -j2 suite --config suite_seed=1 count=90 shard=0/1`. Shards add up; what is done is kept. Without a seed it is that of
# the frozen thresholds.

SUITE_SEED = int(REQUEST.get("suite_seed", frozen_seed(f"{SOURCE}/vibroimpact/discrepancy/priors.py")))
SUITE = f"results/suite_{SUITE_SEED}"
SUITE_S = int(REQUEST.get("seconds", 20))
SUITE_CAMPAIGNS = shard_of(int(REQUEST.get("count", 12)), REQUEST.get("shard", "0/1"))
SUITE_FIGURES = ("suite_rates", "suite_confusion", "suite_strength", "suite_parameters")  # in the order of the page


rule suite_bank:
    input:
        library=library("suite_bank"),
    output:
        campaign=f"{SUITE}/bank/bank.nc",
        done=f"{SUITE}/bank/verdict.json",
    params:
        config=MODEL.model_dump(mode="json"),
        seconds=SUITE_S,
    log:
        f"{SUITE}/logs/bank.log",
    benchmark:
        f"{SUITE}/benchmarks/bank.tsv"
    threads: 1
    resources:
        mem_mb=3000,
        runtime=120,
    message:
        "Suite: candidates simulated on a campaign with nothing hidden, for all campaigns of the suite"
    script:
        "../scripts/suite_bank.py"


rule suite_campaign:
    input:
        library=library("suite_campaign"),
        bank=f"{SUITE}/bank/verdict.json",
    output:
        verdict=f"{SUITE}/campaign_{{number}}/verdict.json",
        truth=f"{SUITE}/truth/campaign_{{number}}.json",
    params:
        config=MODEL.model_dump(mode="json"),
        seed=SUITE_SEED,
        seconds=SUITE_S,
    log:
        f"{SUITE}/logs/campaign_{{number}}.log",
    benchmark:
        f"{SUITE}/benchmarks/campaign_{{number}}.tsv"
    threads: 1
    resources:
        mem_mb=3000,
        runtime=60,
    message:
        "Suite: campaign {wildcards.number}"
    script:
        "../scripts/suite_campaign.py"


rule suite:
    input:
        library=library("suite"),
        template=f"{SOURCE}/vibroimpact/suite_page.html",
        verdicts=[f"{SUITE}/campaign_{number:04d}/verdict.json" for number in SUITE_CAMPAIGNS],
    output:
        rates=f"{SUITE}/rates.csv",
        campaigns=f"{SUITE}/campaigns.csv",
        confusion=f"{SUITE}/confusion.csv",
        detection=f"{SUITE}/detection.csv",
        figures=[f"{SUITE}/figures/{name}.{suffix}" for name in SUITE_FIGURES for suffix in ("png", "pdf", "csv", "txt")],
        page=f"{SUITE}/report.html",
    params:
        campaigns=len(SUITE_CAMPAIGNS),
        seed=SUITE_SEED,
    log:
        f"{SUITE}/logs/suite.log",
    benchmark:
        f"{SUITE}/benchmarks/suite.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    message:
        f"Suite of seed {SUITE_SEED}: {SUITE}/report.html"
    script:
        "../scripts/suite.py"


include: "suite_check.smk"

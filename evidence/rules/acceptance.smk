# Campaigns in which another code hid an effect, judged:
# `snakemake -j2 acceptance --config count=120 shard=0/2`.
# Shards add up, and a rerun continues. The seed is the digest of all source of library and
# evidence: the draw can not precede the code. draw_seed=1 makes a development draw, of other
# shapes and laws.
# count=judged writes the page of the campaigns that have a verdict; add=FILE,FILE adds the
# campaigns.csv of shards that were judged elsewhere.
from evidence.acceptance.shards import draw_name, frozen_seed, source_digest_of
from vibroimpact.config.reserved_names import DRAW_NAME

DRAW_SEED = number_asked("draw_seed", example="1", whole=True)
DRAWN = (
    f"results/{draw_name('acceptance', frozen_seed(source_digest_of(SOURCE, EVIDENCE)))}"
    if DRAW_SEED is None
    else f"results/{draw_name('development', int(DRAW_SEED))}"
)
DRAWN_ADDED = [file for file in REQUEST.get("add", "").split(",") if file]
DRAWN_CAMPAIGNS = drawn_campaigns(DRAWN, DRAWN_ADDED)
ACCEPTANCE_FIGURES = (
    "acceptance_rates",
    "acceptance_reliability",
    "acceptance_confusion",
    "acceptance_strength",
    "acceptance_parameters",
)  # in the order of the page


wildcard_constraints:
    drawn=DRAW_NAME.replace("(", "(?:"),
    number=r"[0-9]{4}",


rule _acceptance_campaign:
    output:
        verdict="results/{drawn}/campaign_{number}/verdict.json",
        model="results/{drawn}/campaign_{number}/model.yaml",
        truth="results/{drawn}/truth/campaign_{number}.json",
    log:
        "results/{drawn}/logs/campaign_{number}.log",
    benchmark:
        "results/{drawn}/benchmarks/campaign_{number}.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=evidence("acceptance_campaign"),
    message:
        "Campaign {wildcards.number} of {wildcards.drawn}"
    script:
        "../scripts/acceptance_campaign.py"


rule acceptance:
    """Judge verdicts on campaigns in which an effect is hidden: --config count=N."""
    input:
        template=f"{EVIDENCE}/acceptance/page.html",
        added=DRAWN_ADDED,
        verdicts=[f"{DRAWN}/campaign_{number:04d}/verdict.json" for number in DRAWN_CAMPAIGNS],
    output:
        table=f"{DRAWN}/table.csv",
        campaigns=f"{DRAWN}/campaigns.csv",
        reliability=f"{DRAWN}/reliability.csv",
        confusion=f"{DRAWN}/confusion.csv",
        detection=f"{DRAWN}/detection.csv",
        figures=[
            f"{DRAWN}/figures/{name}.{suffix}"
            for name in ACCEPTANCE_FIGURES
            for suffix in ("png", "pdf", "csv", "txt")
        ],
        page=f"{DRAWN}/report.html",
    log:
        f"{DRAWN}/logs/acceptance.log",
    benchmark:
        f"{DRAWN}/benchmarks/acceptance.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(10),
    params:
        library=evidence("acceptance"),
        campaigns=len(DRAWN_CAMPAIGNS),
    message:
        f"The acceptance table: {DRAWN}/report.html"
    script:
        "../scripts/acceptance.py"

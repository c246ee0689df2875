# A small suite: a few hidden effects in quick mode. It fails where a verdict is wrong.
from vibroimpact.acceptance.quick_check import CHECKS

SUITE_CHECK = "results/suite_check"


rule _suite_check_campaign:
    output:
        verdict=f"{SUITE_CHECK}/{{check}}/verdict.json",
    log:
        f"{SUITE_CHECK}/logs/{{check}}.log",
    benchmark:
        f"{SUITE_CHECK}/benchmarks/{{check}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(20),
    params:
        library=library("suite_check_campaign"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Quick verdict of a sealed campaign: {wildcards.check}"
    script:
        "../scripts/suite_check_campaign.py"


rule suite_check:
    """Judge six small hidden effects in quick mode."""
    input:
        verdicts=[f"{SUITE_CHECK}/{name}/verdict.json" for name in CHECKS],
    output:
        table=f"{SUITE_CHECK}/table.csv",
    log:
        f"{SUITE_CHECK}/logs/suite_check.log",
    benchmark:
        f"{SUITE_CHECK}/benchmarks/suite_check.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("suite_check"),
        checks=list(CHECKS),
    message:
        f"Check of quick verdicts: {SUITE_CHECK}/table.csv"
    script:
        "../scripts/suite_check.py"

# A measured campaign against a model:
# `snakemake -j2 discrepancy --config campaign=FILE [model=config/x.yaml]`.
# bank=FOLDER takes the simulations of the candidates from another campaign of the same model, loads
# and gaps; draw=1, 2, ... simulates with other seeds.
from vibroimpact.discrepancy.dag import NULL_PARTS

BANK = REQUEST.get("bank", "")
NULLS = [f"{DISCREPANCY}/null/{part}.npz" for part in range(NULL_PARTS)]
BANK_NULLS = [f"{BANK}/null/{part}.npz" for part in range(NULL_PARTS)] if BANK else []


wildcard_constraints:
    part=r"[0-9]+",
    candidate=r"[a-z_]+@[A-Za-z0-9_.-]+(@alone)?",
    pair=r"[a-z_]+@[A-Za-z0-9_.-]+(@alone)?(\+[a-z_]+@[A-Za-z0-9_.-]+)?",


checkpoint _discrepancy_prepare:
    input:
        campaign=after_model_checks(MODEL, MODEL_FILES, compared_campaign),
    output:
        prepared=f"{DISCREPANCY}/prepared.json",
    log:
        f"{DISCREPANCY}/logs/prepare.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/prepare.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(20),
    params:
        library=library("discrepancy_prepare"),
        config=MODEL.model_dump(mode="json"),
        compared_s=COMPARED_S,
        draw=DRAW,
    message:
        "Checks and linear stage of the campaign"
    script:
        "../scripts/discrepancy_prepare.py"


rule _discrepancy_null:
    input:
        campaign=compared_campaign,
        prepared=f"{DISCREPANCY}/prepared.json",
    output:
        null=f"{DISCREPANCY}/null/{{part}}.npz",
    log:
        f"{DISCREPANCY}/logs/null_{{part}}.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/null_{{part}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(60),
    params:
        library=library("discrepancy_null"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Null: seeds of the bare model, part {wildcards.part}"
    script:
        "../scripts/discrepancy_null.py"


rule _discrepancy_candidate:
    input:
        campaign=compared_campaign,
        prepared=f"{DISCREPANCY}/prepared.json",
    output:
        path=f"{DISCREPANCY}/paths/{{candidate}}.npz",
    log:
        f"{DISCREPANCY}/logs/candidate_{{candidate}}.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/candidate_{{candidate}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(60),
    params:
        library=library("discrepancy_candidate"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Candidate {wildcards.candidate}: simulated at its first parameters"
    script:
        "../scripts/discrepancy_candidate.py"


checkpoint _discrepancy_screening:
    input:
        campaign=compared_campaign,
        prepared=f"{DISCREPANCY}/prepared.json",
        null=NULLS,
        paths=path_files,
        bank_null=BANK_NULLS,
    output:
        screening=f"{DISCREPANCY}/screening.json",
    log:
        f"{DISCREPANCY}/logs/screening.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/screening.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(30),
    params:
        library=library("discrepancy_screening"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Screening of all candidates"
    script:
        "../scripts/discrepancy_screening.py"


rule _discrepancy_finalist:
    input:
        campaign=compared_campaign,
        prepared=f"{DISCREPANCY}/prepared.json",
        null=NULLS,
        paths=path_files,
        bank_null=BANK_NULLS,
        screening=f"{DISCREPANCY}/screening.json",
    output:
        finalist=f"{DISCREPANCY}/finalists/{{candidate}}.npz",
    log:
        f"{DISCREPANCY}/logs/finalist_{{candidate}}.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/finalist_{{candidate}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=library("discrepancy_finalist"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Finalist {wildcards.candidate}: refined by direct simulation"
    script:
        "../scripts/discrepancy_finalist.py"


checkpoint _discrepancy_pairs:
    input:
        campaign=compared_campaign,
        prepared=f"{DISCREPANCY}/prepared.json",
        null=NULLS,
        paths=path_files,
        bank_null=BANK_NULLS,
        screening=f"{DISCREPANCY}/screening.json",
        finalists=finalist_files,
    output:
        pairs=f"{DISCREPANCY}/pairs.json",
    log:
        f"{DISCREPANCY}/logs/pairs.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/pairs.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(30),
    params:
        library=library("discrepancy_pairs"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Second effect: which pairs to simulate"
    script:
        "../scripts/discrepancy_pairs.py"


rule _discrepancy_pair:
    input:
        campaign=compared_campaign,
        prepared=f"{DISCREPANCY}/prepared.json",
        null=NULLS,
        paths=path_files,
        bank_null=BANK_NULLS,
        pairs=f"{DISCREPANCY}/pairs.json",
    output:
        pair=f"{DISCREPANCY}/pairs/{{pair}}.npz",
    log:
        f"{DISCREPANCY}/logs/pair_{{pair}}.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/pair_{{pair}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=library("discrepancy_pair"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Pair {wildcards.pair}: refined by direct simulation"
    script:
        "../scripts/discrepancy_pair.py"


rule _discrepancy_verdict:
    input:
        campaign=compared_campaign,
        prepared=f"{DISCREPANCY}/prepared.json",
        null=NULLS,
        paths=path_files,
        bank_null=BANK_NULLS,
        screening=f"{DISCREPANCY}/screening.json",
        finalists=finalist_files,
        pairs=pair_files,
        mode=f"{DISCREPANCY}/mode.txt",
    output:
        verdict=f"{DISCREPANCY}/verdict.json",
        map=f"{DISCREPANCY}/map.nc",
        map_after=f"{DISCREPANCY}/map_after.nc",
        ranking=f"{DISCREPANCY}/ranking.csv",
        model=f"{DISCREPANCY}/model_updated.yaml",
    log:
        f"{DISCREPANCY}/logs/verdict.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/verdict.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=library("discrepancy_verdict"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Verdict, verified on fresh seeds"
    script:
        "../scripts/discrepancy_verdict.py"

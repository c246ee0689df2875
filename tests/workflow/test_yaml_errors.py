"""What snakemake is given that it can not use: YAML files, and values of --config."""

import os
from pathlib import Path

import pytest

from tests.support.snakemake_runs import snakemake
from vibroimpact_workflow.yaml_files import give_cache, require_yaml

ROOT = Path(__file__).parents[2]


def refusal(*arguments, target="all"):
    """The last line of a dry run of snakemake that is refused."""
    run = snakemake(ROOT, "--dry-run", target, *arguments, timeout=60)
    assert run.returncode == 1 and "Traceback" not in run.stderr, run.stderr
    return run.stderr.strip().splitlines()[-1]


@pytest.mark.parametrize(
    "arguments",
    [
        ["--configfile", "{broken}"],
        ["--configfile={broken}"],
        ["--configfile", "config/smoke.yaml", "--config", "model={broken}"],
    ],
    ids=["configfile", "configfile=", "model"],
)
def test_snakemake_names_file_line_and_column(tmp_path, arguments):
    broken = tmp_path / "broken.yaml"
    broken.write_text("study: mine\nseed: [1\nspectra: {}\n")
    last = refusal(*(argument.format(broken=broken) for argument in arguments))
    assert last.startswith(f"{broken}: line 3, column 8: the list that [ opens in line 2")


BOMB = b"a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + b"".join(
    b"%c: &%c [%s]\n" % (letter + 1, letter + 1, 9 * (b"*%c, " % letter))
    for letter in range(ord("a"), ord("z"))
)
DAMAGED = {
    "binary file": (b"\x89HDF\r\n\x1a\n\0\0", "is a binary file"),
    "UTF-16 text": ("study: mine\n".encode("utf-16"), "save the file as UTF-8"),
    "Latin-1 text": (b"study: mine # \xb5\n", "line 1, column 15: a character that is not UTF-8"),
    "text of 10000 brackets": (b"study: " + 10000 * b"[", "nested in more than 30 blocks"),
    "list of aliases that repeat each other": (BOMB, "more than 100000 values"),
    "template that runs code": (
        b"__use_yte__: true\n?1/0: 1\n",
        "would run the content of the file",
    ),
}


@pytest.mark.parametrize(("content", "part"), DAMAGED.values(), ids=DAMAGED)
def test_snakemake_refuses_a_damaged_configuration(tmp_path, content, part, reliability, request):
    damaged = tmp_path / "damaged.yaml"
    damaged.write_bytes(content)
    with pytest.raises(SystemExit) as end:
        require_yaml(["-n", "--configfile", str(damaged)])
    assert str(end.value).startswith(f"{damaged}: ") and part in str(end.value)
    what = request.node.callspec.id
    reliability.fault(f"a configuration that is a {what}", "refused with a sentence")


REQUESTS = {
    # value of --config: target, how the sentence begins
    "draw_seed=abc": ("acceptance", "draw_seed = 'abc': give a whole number"),
    "count=-1": ("acceptance", "count = -1: give how many campaigns"),
    "count=10000": ("acceptance", "count = 10000: give how many campaigns, at most 9999"),
    "shard=9/3": ("acceptance", "shard = 9/3: give i/n"),
    "add=none.csv": ("acceptance", "add = none.csv is not there"),
    "compared_s=49": ("discrepancy", "config/smoke.yaml: unknown key 'compared_s'"),
    "effort=much": ("discrepancy", "effort = 'much': give one of quick, standard, thorough"),
    "campaign=src": ("discrepancy", "campaign = 'src' is no file"),
    "campaign=none.nc": ("discrepancy", "campaign = 'none.nc' is not there"),
    "model=src": ("discrepancy", "src: is a folder"),
    "import=Snakefile": ("import_campaign", "import = 'Snakefile' is no folder"),
    "import=none": ("import_campaign", "import = 'none' is not there"),
}


@pytest.mark.parametrize(
    "value",
    [
        pytest.param(value, marks=[] if number < 3 else pytest.mark.slow)
        for number, value in enumerate(REQUESTS)
    ],
)
def test_a_value_beside_the_study_is_refused(value):
    target, part = REQUESTS[value]
    given = ["--configfile", "config/smoke.yaml", "--config", value]
    assert refusal(*given, target=target).startswith(part)


def test_a_broken_configfile_ends_snakemake_with_a_sentence(tmp_path):
    broken = tmp_path / "broken.yaml"
    broken.write_text("a: [1\nb: 2\n")
    for arguments in (["-n", "--configfile", str(broken)], [f"--configfiles={broken}", "-j2"]):
        with pytest.raises(SystemExit, match="broken.yaml: line 2, column 2"):
            require_yaml(arguments)
    require_yaml(["-n", "--configfile", str(ROOT / "config" / "study.yaml")])


def test_a_home_that_can_not_be_written_gets_a_cache_here(tmp_path, monkeypatch, reliability):
    (tmp_path / "home").write_text("a file, no folder")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    give_cache()
    assert os.environ["XDG_CACHE_HOME"] == str(tmp_path / ".snakemake" / "cache")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    give_cache()
    assert os.environ["XDG_CACHE_HOME"] == ""
    reliability.fault(
        "a HOME that can not be written", "Snakemake keeps its cache in the working folder"
    )

"""A YAML error in a configuration, whichever way snakemake is given the file."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def refusal(*arguments):
    """The last line of a dry run of snakemake that is refused."""
    run = subprocess.run(
        [sys.executable, "-m", "snakemake", "--dry-run", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=ROOT,
        timeout=60,
    )
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
    "template that runs code": (b"__use_yte__: true\n?1/0: 1\n", "would run what the file holds"),
}


@pytest.mark.parametrize(("content", "part"), DAMAGED.values(), ids=DAMAGED)
def test_snakemake_refuses_a_damaged_configuration(tmp_path, content, part, reliability, request):
    damaged = tmp_path / "damaged.yaml"
    damaged.write_bytes(content)
    sentence = refusal("--configfile", damaged)
    assert sentence.startswith(f"{damaged}: ") and part in sentence
    assert refusal("--configfile", "config/smoke.yaml", "--config", f"model={damaged}") == sentence
    what = request.node.callspec.id
    reliability.fault(f"a configuration that is a {what}", "refused with a sentence")

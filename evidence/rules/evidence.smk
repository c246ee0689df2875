# The rules of a checkout that judge the library: validation, acceptance draws, the law that ships
# with it. An installed package has none of them.
EVIDENCE = as_input(ROOT / "evidence")
sys.path.append(os.path.abspath(ROOT))
os.environ.update(PYTHONPATH=os.pathsep.join(map(os.path.abspath, (SOURCE, ROOT))))


def evidence(script):
    """The digest of the files that a script of the evidence imports, as a param."""
    return library(script, f"{EVIDENCE}/scripts")


include: "acceptance_files.smk"
include: "acceptance.smk"
include: "equivalent_law.smk"
include: "validation_convergence.smk"
include: "validation_judges.smk"
include: "validation.smk"

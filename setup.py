"""What pyproject.toml can not state: the wheel brings workflow, configurations and examples.

They live at the top of the repository and are copied to vibroimpact/share/, where
vibroimpact.study.folder finds them.
"""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).parent
SHARED = (
    "Snakefile",
    "workflow/Snakefile",
    "workflow/rules/*.smk",
    "workflow/scripts/*.py",
    "workflow/vibroimpact_workflow/*.py",
    "workflow/profiles/*/config.yaml",
    "workflow/report/*",
    "config/**/*",
    "examples/**/*",
)


def shared_files() -> list[Path]:
    """Return the shared files by their paths below the repository, sorted."""
    found = {file for pattern in SHARED for file in ROOT.glob(pattern) if file.is_file()}
    return sorted(file.relative_to(ROOT) for file in found if "__pycache__" not in file.parts)


class BuildWithSharedFiles(build_py):
    """Copies the shared files beside the library's. An editable install reads them in place."""

    def run(self):
        super().run()
        if not self.editable_mode:
            for source, target in self._copies():
                self.mkpath(str(Path(target).parent))
                self.copy_file(source, target)

    def get_output_mapping(self):
        mapping = super().get_output_mapping()
        return mapping if self.editable_mode else mapping | {to: at for at, to in self._copies()}

    def get_outputs(self, include_bytecode=1):
        return [*super().get_outputs(include_bytecode), *(to for _, to in self._copies())]

    def get_source_files(self):
        return [*super().get_source_files(), *map(str, shared_files())]

    def _copies(self) -> list[tuple[str, str]]:
        """Return [(path in the repository, path in the build)]."""
        share = Path(self.build_lib, "vibroimpact", "share")
        return [(str(file), str(share / file)) for file in shared_files()]


setup(cmdclass={"build_py": BuildWithSharedFiles})

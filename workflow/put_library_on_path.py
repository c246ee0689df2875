"""Put src on the path of the environment that runs this: an edit of the library counts at once."""

import sysconfig
from pathlib import Path

source = Path(__file__).resolve().parents[1] / "src"
scripts = Path(sysconfig.get_path("scripts"))
Path(sysconfig.get_path("purelib"), "vibroimpact.pth").write_text(f"{source}\n")
command = scripts / "vibroimpact"
command.write_text(f"#!{scripts}/python\nfrom vibroimpact.cli import main\n\nmain()\n")
command.chmod(0o755)

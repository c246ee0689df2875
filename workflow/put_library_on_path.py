"""Put src on the path of the environment that runs this: an edit of the library counts at once."""

import shlex
import sysconfig
from pathlib import Path

source = Path(__file__).resolve().parents[1] / "src"
scripts = Path(sysconfig.get_path("scripts"))
Path(sysconfig.get_path("purelib"), "vibroimpact.pth").write_text(f"{source}\n")
command = scripts / "vibroimpact"
# Through sh: the first line of a script may not name a path with a space.
python = shlex.quote(f"{scripts}/python")
command.write_text(f'#!/bin/sh\nexec {python} -m vibroimpact "$@"\n')
command.chmod(0o755)

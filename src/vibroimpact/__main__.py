"""`python -m vibroimpact`: the command line."""

import sys

from vibroimpact.cli import main

if __name__ == "__main__":
    sys.exit(main())

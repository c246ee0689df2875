"""The command `vibroimpact contact`: the contact of the supports for another program.

The library is imported when the command runs, so that `--help` answers at once.
"""

import argparse
import sys

from .command import add_file_arguments

FORMATS = ("abaqus", "opensees", "code_aster")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("config", metavar="CONFIG", help="configuration of the structure")
    parser.add_argument(
        "--gap", type=float, required=True, metavar="M", help="radial gap of the case in m"
    )
    parser.add_argument(
        "--export",
        nargs=2,
        required=True,
        metavar=("FORMAT", "FILE"),
        help=f"format and path of the file; FORMAT: {', '.join(FORMATS)}",
    )
    add_file_arguments(parser)
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Run the command. Return 1 if nothing was written, or something was left out."""
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.config.reading import load_config
    from vibroimpact.io.records import RecordError, write_text
    from vibroimpact.reduction.reduced_model import build_model

    from .answer import EquivalentError
    from .contact_points import contact_set
    from .export_formats.registry import contacts_text

    form, path = options.export
    try:
        if not 0.0 < options.gap < 1.0:
            raise EquivalentError(
                f"--gap {options.gap:g} must be above 0 and below 1: give it in m"
            )
        config = load_config(options.config)
        contacts = contact_set(config, build_model(config, motion_only=True), options.gap)
        content, left_out = contacts_text(contacts, form, options.unit, options.first_number)
        write_text(content, path)
    except (EquivalentError, ConfigError, RecordError, OSError) as error:
        print(error, file=sys.stderr)
        return 1
    for sentence in left_out:
        print(f"left out: {sentence}", file=sys.stderr)
    print(f"{path}: contact of {len(contacts.points)} points")
    return 1 if left_out else 0

"""The commands `vibroimpact equivalent` and `vibroimpact contact`: k and c, and the contact of the
supports for another program; their arguments, output and files.

The library is imported when the command runs, so that `--help` answers at once.
"""

import argparse
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibroimpact.reduction.modal_model import ModalModel

    from .answer import Answer

LARGEST = 1e20
FORMATS = ("nastran", "code_aster", "abaqus", "opensees", "csv", "json")
CONTACT_FORMATS = ("abaqus", "opensees", "code_aster")


def _positive(text: str) -> float:
    """Return the positive number of an argument. Raises ArgumentTypeError."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value <= LARGEST:
        raise argparse.ArgumentTypeError(f"'{text}' is no positive number: give it in SI units")
    return value


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "study",
        metavar="STUDY",
        nargs="?",
        help="a finished study: its name under results/, or the folder of its results",
    )
    parser.add_argument(
        "--load", type=_positive, required=True, metavar="N", help="RMS of the force in N"
    )
    parser.add_argument("--gap", type=_positive, required=True, metavar="M", help="radial gap in m")
    parser.add_argument(
        "--config",
        metavar="FILE",
        help="configuration: of the estimate, or of a study without model.nc",
    )
    parser.add_argument(
        "--estimate",
        action="store_true",
        help="estimate from a law, without a simulation; needs --config and no study",
    )
    parser.add_argument(
        "--anyway",
        choices=("lscf", "ods", "broadband"),
        metavar="METHOD",
        help="if the methods differ or too few resolve a value, take that of one of them (lscf,"
        " ods, broadband); a warning stands at the head of every export",
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print JSON in place of the text")
    form.add_argument("--csv", action="store_true", help="print CSV in place of the text")
    _add_export_arguments(parser)
    parser.set_defaults(command=run)


def _add_export_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--export",
        nargs=2,
        metavar=("FORMAT", "FILE"),
        help=f"write springs and dampers to ground; FORMAT: {', '.join(FORMATS)}",
    )
    parser.add_argument(
        "--points",
        choices=("each", "one"),
        default="each",
        help="export: springs at each contact point (default), or one at each support",
    )
    parser.add_argument(
        "--across",
        choices=("same", "none"),
        default="same",
        help="export: a transverse direction that was not identified gets the k and c of the other"
        " one (default), or no spring",
    )
    add_file_arguments(parser, "export: ")


def add_file_arguments(parser: argparse.ArgumentParser, about: str = "") -> None:
    """Declare the unit and the numbers of a file for another program; about: begins their help."""
    parser.add_argument(
        "--unit",
        choices=("m", "mm"),
        default="m",
        help=f"{about}m, N, kg, s (default) or mm, N, t, s",
    )
    parser.add_argument(
        "--first-number",
        type=int,
        default=900001,
        metavar="ID",
        help=f"{about}first number of nodes and elements (default 900001)",
    )


def run(options: argparse.Namespace) -> int:
    """Run the command. Return 1 if there is no answer, or a k or c has no value and no bound."""
    import json

    from vibroimpact.config.problems import ConfigError
    from vibroimpact.io.records import RecordError

    from .answer import EquivalentError
    from .answer_text import as_csv, as_plain, as_text

    try:
        answer, model = _answer(options)
        answer = answer.anyway(options.anyway) if options.anyway else answer
        left_out = _write_export(options, answer, model) if options.export else ()
    except (EquivalentError, ConfigError, RecordError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    if options.json:
        print(json.dumps(as_plain(answer), indent=2, ensure_ascii=False))
    else:
        print(as_csv(answer) if options.csv else as_text(answer))
    missing = [*answer.unresolved, *(line for line in left_out if line not in answer.unresolved)]
    for sentence in missing:
        print(sentence, file=sys.stderr)
    if answer.disputed:
        print("To take the value of one method: --anyway lscf, ods or broadband", file=sys.stderr)
    return 1 if missing else 0


def _answer(options: argparse.Namespace) -> "tuple[Answer, ModalModel]":
    """Return the Answer and the model that it belongs to. Raises EquivalentError, ConfigError."""
    from vibroimpact.config.reading import load_config
    from vibroimpact.reduction.reduced_model import build_model

    from .answer import EquivalentError
    from .estimate import estimate_equivalent
    from .study_answer import equivalent, model_of, study_folder
    from .study_tables import require_tables_of

    config = load_config(options.config) if options.config else None
    if options.estimate:
        if config is None or options.study:
            raise EquivalentError(
                "--estimate needs no study and a configuration: `vibroimpact equivalent --estimate"
                " --config FILE --load N --gap M`"
            )
        answer = estimate_equivalent(config, options.load, options.gap)
        return answer, build_model(config, motion_only=True)
    if not options.study:
        raise EquivalentError(
            "name a study, as in `vibroimpact equivalent gv_local --load 5 --gap 0.25e-3`, or ask"
            " for an estimate with --estimate --config FILE"
        )
    folder = study_folder(options.study)
    if config is None:
        model = model_of(folder)
    else:
        require_tables_of(folder, config, options.config)
        model = build_model(config, motion_only=True)
    return equivalent(options.study, options.load, options.gap, model), model


def _write_export(
    options: argparse.Namespace, answer: "Answer", model: "ModalModel"
) -> tuple[str, ...]:
    """Write the export. Return its omissions. Raises EquivalentError."""
    from vibroimpact.io.records import write_text

    from .answer import EquivalentError
    from .export_formats.registry import springs_text
    from .springs import point_springs

    form, path = options.export
    springs = point_springs(answer, model, options.points, options.across)
    content = springs_text(springs, form, options.unit, options.first_number)
    try:
        write_text(content, path)
    except OSError as error:
        raise EquivalentError(f"{path}: cannot be written ({error.strerror})") from error
    return springs.left_out


def add_contact_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command `contact`."""
    parser.add_argument("config", metavar="CONFIG", help="configuration of the structure")
    parser.add_argument(
        "--gap", type=float, required=True, metavar="M", help="radial gap of the case in m"
    )
    parser.add_argument(
        "--export",
        nargs=2,
        required=True,
        metavar=("FORMAT", "FILE"),
        help=f"format and path of the file; FORMAT: {', '.join(CONTACT_FORMATS)}",
    )
    add_file_arguments(parser)
    parser.set_defaults(command=run_contact)


def run_contact(options: argparse.Namespace) -> int:
    """Run the command `contact`. Return 1 if nothing was written, or something was left out."""
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

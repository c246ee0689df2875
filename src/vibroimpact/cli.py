"""The command line: lay out a study, check a file, print the JSON schema or the key reference.

Commands import what they need when they run, so that `--help` answers at once.
"""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from vibroimpact import __version__, stability_command
from vibroimpact.diagnosis import diagnose_command, supports_command
from vibroimpact.equivalent_support.command import add_arguments, add_contact_arguments
from vibroimpact.study.wear import command as wear_command

# Read when numpy is first imported. The matrices are small: threads would wait for each other, and
# take up to ten times the CPU. Runs are made side by side instead.
ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
PREFIX = {"warn": "warning: ", "not checked": "{check}: "}  # of the sentence of a check
NETCDF = (".nc", ".nc4", ".cdf")
# How netCDF files begin, of the classic format and of HDF5.
SIGNATURES = (b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF")


def main(arguments: Sequence[str] | None = None) -> int:
    """Return the exit code of a command: 0 for success, 1 for a file with problems.

    arguments: those of the command line if None. Raises SystemExit with code 2 for arguments that
    are not a command.
    """
    for name, value in ONE_THREAD.items():
        os.environ.setdefault(name, value)
    options = _parser().parse_args(arguments)
    command: Callable[[argparse.Namespace], int] = options.command
    try:
        code = command(options)
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # the reader of a pipe, such as `| head`, has closed it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


def _parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="vibroimpact",
        description="Vibration of tubes and other structures with gap supports. Studies are run"
        " with snakemake; these commands check their input.",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for name, (declare, summary, description) in COMMANDS.items():
        declare(commands.add_parser(name, help=summary, description=description))
    for name, command, what in (
        ("schema", _schema, "print the JSON schema of a study configuration"),
        ("reference", _reference, "print the reference of every configuration key as Markdown"),
    ):
        printer = commands.add_parser(name, help=what, description=f"{what.capitalize()}.")
        printer.set_defaults(command=command)
    return parser


def _check(options: argparse.Namespace) -> int:
    """Check a file. Return 1 if it has problems."""
    checked = _campaign if _is_netcdf(options.file) else _configuration
    summary, problems = checked(options.file)
    for problem in problems:
        print(problem, file=sys.stderr)
    if summary:
        print(f"{options.file}: {summary}")
    return 0 if summary else 1


def _compare(options: argparse.Namespace) -> int:
    """Compare frequency responses with a linear model. Return 1 if it can not be done."""
    from vibroimpact.campaign.file import CampaignError
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.diagnosis.measurement.linear_comparison import NotComparable, compared
    from vibroimpact.io.records import RecordError
    from vibroimpact.io.signal_files.signals import ImportProblem

    try:
        lines = compared(options.file, options.model, _is_netcdf(options.file))
    except NotComparable as problem:
        print(f"{options.file}: {problem}", file=sys.stderr)
        return 1
    except (ImportProblem, RecordError, CampaignError, ConfigError, ValueError, OSError) as error:
        print(error, file=sys.stderr)
        return 1
    print("\n".join(lines))
    return 0


def _new(options: argparse.Namespace) -> int:
    """Lay out a folder for a study. Return 1 if it can not be done."""
    from vibroimpact.study.folder.new_study import NewStudyError, new_study

    try:
        files = new_study(options.folder, options.example)
    except NewStudyError as problem:
        print(problem, file=sys.stderr)
        return 1
    print(f"{options.folder}: {', '.join(map(str, files))}")
    print("Edit config/study.yaml, then, in that folder: snakemake -j2")
    return 0


def _schema(options: argparse.Namespace) -> int:
    """Print the JSON schema."""
    import json

    from vibroimpact.config.json_schema import json_schema

    print(json.dumps(json_schema(), indent=2, ensure_ascii=False))
    return 0


def _reference(options: argparse.Namespace) -> int:
    """Print the key reference."""
    from vibroimpact.config.key_reference import markdown

    print(markdown())
    return 0


def _is_netcdf(path: str) -> bool:
    """Whether a file is netCDF, by its name or its first bytes."""
    if not os.path.isfile(path):
        return False
    if Path(path).suffix.lower() in NETCDF:
        return True
    try:
        with open(path, "rb") as file:
            return file.read(4) in SIGNATURES
    except OSError:
        return False  # reading it as a configuration says why


def _campaign(path: str) -> tuple[str | None, list[str]]:
    """Return (description of a campaign, None if it is refused; its problems and warnings)."""
    from vibroimpact.campaign.checks.file_checks import check_file, refused
    from vibroimpact.diagnosis.measurement.comparable import campaign_problems, channel_rows

    campaign, rows = check_file(path)
    problems = [
        f"{path}: {PREFIX.get(row['level'], '').format(**row)}{row['message']}"
        for row in rows
        if row["level"] != "pass"
    ]
    if campaign is None or refused(rows):
        return None, problems
    notes = [row["message"] for row in channel_rows(campaign)]
    notes += [f"{problem}." for problem in campaign_problems(campaign)]
    problems += [f"{path}: warning: {note}" for note in notes]
    sizes = campaign.sizes
    return (
        f"a campaign of {_count(sizes['record'], 'record')},"
        f" {_count(sizes['channel'], 'channel')} and"
        f" {_count(sizes['force_channel'], 'force channel')}, {_sampling(campaign)}",
        problems,
    )


def _configuration(path: str) -> tuple[str | None, list[str]]:
    """Return (description of a YAML file, None if it has problems; its problems)."""
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.config.yaml_file import read_yaml

    try:
        data = read_yaml(path)
        structure = data.get("structure")
        if "channels" in data and structure is None:
            return _sidecar(path)
        if isinstance(structure, dict) and structure.get("kind") == "identified":
            if "modes" not in structure:
                return _structure_file(path)
        return _study(data, path)
    except ConfigError as error:
        return None, error.problems


def _study(data: dict, path: str) -> tuple[str | None, list[str]]:
    """Return (description of a study, its problems). Raises ConfigError."""
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.config.reading import check_config
    from vibroimpact.study.cases import all_cases
    from vibroimpact.study.model_checks import check_model

    told: list[str] = []
    try:
        config = check_config(data, path)
    except ConfigError as error:
        if error.mended is None:
            raise
        config, told = error.mended, error.problems
    found = check_model(config)
    files, wrong = _measured_files(config)
    problems = [*found.problems, *wrong]
    if told or problems:
        return None, [*told, *(f"{path}: {problem}" for problem in problems)]
    aim = "with identification" if config.identification is not None else "without identification"
    return (
        f"study '{config.study}': structure of kind {config.structure.kind}{_named(config)},"
        f" {_count(len(config.supports), 'support')}, {_count(len(config.elements), 'element')},"
        f" excitation of kind {config.excitation.kind},"
        f" {_count(len(all_cases(config.grid)), 'case')} {aim}"
        f"{_load_of_spectrum(config)}{files}{_in_flow(config)}",
        [f"{path}: warning: {warning}" for warning in found.warnings],
    )


def _load_of_spectrum(config) -> str:
    """Return the load of a spectrum that has a level, "" for a force without one."""
    force = config.excitation
    if force.kind != "turbulence" or force.spectrum.kind == "flat":
        return ""
    from vibroimpact.excitation.turbulence import load_of_spectrum

    velocity = getattr(force.spectrum, "velocity_m_per_s", None)
    source = "its table" if velocity is None else f"{velocity:g} m/s"
    return f"; {source} is a load_rms_N of {load_of_spectrum(config.structure, force):.4g}"


def _in_flow(config) -> str:
    """Return the modes with supports open, closed and equivalent, "" without a flow."""
    if config.flow is None:
        return ""
    from vibroimpact.equivalent_support.in_flow import modes_in_flow

    return modes_in_flow(config)


def _named(config) -> str:
    """Return " of zircaloy_4 at 20 °C (...)" with the properties of a named metal, else ""."""
    structure = config.structure
    material = getattr(structure, "material", None)
    words = ""
    if material is not None and material.name is not None:
        words = (
            f" of {material.name} at {material.temperature_C:g} °C"
            f" (E {material.young_modulus_Pa / 1e9:.4g} GPa, nu {material.poisson_ratio:.3g},"
            f" {material.density_kg_per_m3:g} kg/m3)"
        )
    for fluid in getattr(structure, "fluid", ()):
        if fluid.name is not None:
            viscosity = getattr(fluid, "viscosity_Pa_s", None)
            words += (
                f" with {fluid.name} at {fluid.temperature_C:g} °C {fluid.kind}"
                f" ({fluid.density_kg_per_m3:.4g} kg/m3"
                + (f", {viscosity:.4g} Pa s)" if viscosity else ")")
            )
    return words


def _sampling(campaign) -> str:
    """Return the duration and rate of a campaign in words."""
    rate = float(campaign.attrs["sampling_frequency"])
    return f"up to {campaign.sizes['time'] / rate:.6g} s at {rate:.6g} Hz"


def _measured_files(config) -> tuple[str, list[str]]:
    """Return ("; FILE: duration and rate" of each measured file of a study, their problems)."""
    from vibroimpact.campaign.file import CampaignError, checked_description
    from vibroimpact.excitation.force_files import ForceFileError, read_force, require_lasting
    from vibroimpact.io.records import RecordError

    told, problems = "", []
    force, record, step = config.excitation, config.record, config.integration
    if force.kind == "measured":
        needed = step.start_up_s + record.duration_s
        try:
            read = read_force(force.file, force.variable, force.sampling_frequency_Hz)
            require_lasting(force.file, read, step.steps_per_second, step.start_up_s, needed)
            told += f"; {force.file}: {read.described()}"
        except ForceFileError as error:
            problems.append(str(error))
    overlaid = config.overlay.campaign
    if overlaid is not None:
        try:
            told += f"; {overlaid}: {_sampling(checked_description(overlaid))}"
        except (CampaignError, RecordError) as error:
            problems += [f"overlay.campaign: {line}" for line in str(error).splitlines()]
    return told, problems


def _sidecar(path: str) -> tuple[str | None, list[str]]:
    """Return (description of the campaign.yaml of a folder of measurements, its problems)."""
    from vibroimpact.campaign.importing.sidecar import read_sidecar
    from vibroimpact.io.signal_files.signals import ImportProblem

    try:
        sidecar = read_sidecar(path)
    except ImportProblem as problem:
        return None, str(problem).split("\n")
    return (
        f"the description of a folder of measurements: {_count(len(sidecar.records), 'record')},"
        f" {_count(len(sidecar.channels), 'channel')}, {_count(len(sidecar.forces), 'force')}",
        [],
    )


def _structure_file(path: str) -> tuple[str | None, list[str]]:
    """Return (description of a file without modes, its problems). Raises ConfigError."""
    from vibroimpact.diagnosis.identified.structure_file import read_structure

    stated = read_structure(path)
    asked = stated.band_Hz if stated is not None else None
    band = f"{asked[0]:g} to {asked[1]:g} Hz" if asked else "any band"
    return f"a structure to be identified from its campaign, {band}", []


def _count(number: int, what: str) -> str:
    """Return "1 case", "2 cases"."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def _check_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE")
    parser.set_defaults(command=_check)


def _new_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "folder", metavar="DIR", help="a folder that is empty or does not exist yet"
    )
    parser.add_argument(
        "--example",
        metavar="NAME",
        default="study",
        help="the configuration to start from; a name that does not exist lists them (default:"
        " study, the study of the paper)",
    )
    parser.set_defaults(command=_new)


def _compare_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE")
    parser.add_argument("--model", metavar="FILE", required=True, help="configuration")
    parser.set_defaults(command=_compare)


# Name -> (function that declares its arguments, help, description).
COMMANDS = {
    "check": (
        _check_arguments,
        "check a file and print every problem at once",
        "Check a study configuration (.yaml), a measured campaign (.nc), the"
        " campaign.yaml of a folder of measurements, or the small file that asks for an identified"
        " structure. Prints one line per problem, or one line that describes the file. The exit"
        " code is 1 if there are problems.",
    ),
    "new": (
        _new_arguments,
        "lay out a folder for a study of your own",
        "Lay out a folder for a study of your own: a configuration to edit, a Snakefile"
        " that uses the workflow of this package, profiles and a README. `snakemake -j2` runs it"
        " there. Nothing that exists is overwritten.",
    ),
    "equivalent": (
        add_arguments,
        "print the equivalent k and c of a study at a load and gap, and export them",
        "Print the stiffness k and damping c that a linear model needs at the supports"
        " at one load and gap: from a finished study, interpolated inside its grid, or as an"
        " estimate without a simulation. The exit code is 1 if there is no answer, or if a k"
        " or c is not resolved; unresolved values are never exported.",
    ),
    "diagnose": (
        diagnose_command.add_arguments,
        "name the effect that a model lacks, given a measured campaign",
        "Hold the model to the measured motion and name the effect that it lacks, its place, its"
        " size and its probability. Prints one line per explanation that was fitted, then the"
        " verdict. The exit code is 1 if the campaign can not be compared with the model.",
    ),
    "compare": (
        _compare_arguments,
        "hold measured frequency responses to the linear model",
        "Compare the modes of measured frequency responses with those of the linear"
        " model, and which channels contradict it: swapped, reversed, or in another unit. The file"
        " is a universal file with frequency responses (dataset 58, function type 4) of one force,"
        " or of one accelerometer under a roving hammer, with its nodes; or a measured campaign,"
        " of which the record of the lowest load is taken. Supports are taken without contact. The"
        " exit code is 1 if nothing can be compared.",
    ),
    "supports": (
        supports_command.add_arguments,
        "print the contact forces at the supports of a measured structure, from its sensors",
        "Print values at each support in every record of a measured campaign, from remote sensors:"
        " contact force, time in contact, impacts, wear work rate, secant stiffness and damping."
        " The model is held to the measured motion by dampers at the sensors; its contact forces"
        " are then those of the structure. Measured contact forces are not used, only compared."
        " Values that can not be relied on state the reason. The exit code is 1 if the campaign"
        " can not be compared with the model.",
    ),
    "stability": (
        stability_command.add_arguments,
        "print the critical velocities of a tube in a cross flow",
        "Print the ratio of the effective to the critical velocity of each mode of a"
        " tube in a cross flow, with all its supports holding and without some of them; with a"
        " fluid-elastic force also the velocity at which an eigenvalue begins to grow. The section"
        " flow of the configuration gives velocities, density and criterion. Nothing is simulated,"
        " unless --simulate asks for it.",
    ),
    "wear": (
        wear_command.add_arguments,
        "print the depth of wear at the supports of a finished study",
        "Print how deep each land of the supports wears the wall of the tube, from the"
        " work rates of a finished study: Archard's law or the slowing law EDF_MZ, and the shape of"
        " the support. One line per load and gap, for the land that wears deepest, as a range over"
        " the laws; --csv writes all. The section wear of the study's configuration gives what no"
        " argument gives.",
    ),
    "contact": (
        add_contact_arguments,
        "write the contact of the supports for another finite-element program",
        "Write gaps and contact stiffnesses of the supports of a configuration as"
        " nonlinear elements of another program, at a gap of the case. For the equivalent linear"
        " springs see `vibroimpact equivalent --export`. The exit code is 1 if a law is left"
        " out.",
    ),
}

"""vibroimpact: vibration of tubes and other structures with gap supports, and the linear support
that is equivalent to them.

The names of `vibroimpact.__all__` are the interface for notebooks and scripts of users. Each is
imported when it is first used. Modules of the library and scripts of the workflow import from the
modules themselves, so that the workflow sees which files a stage depends on.
"""

from importlib import import_module

__version__ = "0.4.0"

# Name -> module that defines it. The file __init__.pyi states the same for type checkers.
PUBLIC = {
    "Config": "config.schema",
    "ConfigError": "config.problems",
    "load_config": "config.reading",
    "check_config": "config.reading",
    "changed_config": "config.changed_keys",
    "json_schema": "config.json_schema",
    "build_model": "reduction.reduced_model",
    "basis_frequency_errors": "reduction.basis_accuracy",
    "read_model": "reduction.model_file",
    "write_model": "reduction.model_file",
    "Case": "study.cases",
    "all_cases": "study.cases",
    "cases_of_load": "study.cases",
    "simulate_case": "study.in_process",
    "identify_support": "study.in_process",
    "run_study": "study.in_process",
    "SupportEstimates": "study.support_estimates",
    "simulate_cases": "study.simulation",
    "statistics_rows": "study.statistics_table",
    "case_spectra": "study.in_process",
    "segment_spectra": "spectra.welch",
    "psd_statistics": "spectra.welch",
    "natural_frequencies": "linear.modes",
    "frf": "linear.responses",
    "identify_case": "identify.identify_case",
    "Estimate": "identify.estimate",
    "equivalent": "equivalent_support.study_answer",
    "estimate_equivalent": "equivalent_support.estimate",
    "equivalent_of": "measured_support.equivalent_of",
    "MeasuredSupports": "measured_support.equivalent_of",
    "EquivalentError": "equivalent_support.answer",
    "point_springs": "equivalent_support.springs",
    "springs_text": "equivalent_support.export_formats.registry",
    "Channel": "campaign.file",
    "Level": "campaign.file",
    "CampaignError": "campaign.file",
    "campaign_dataset": "campaign.file",
    "read_campaign": "campaign.file",
    "write_campaign": "campaign.file",
    "check_campaign": "campaign.checks.file_checks",
    "import_folder": "campaign.importing.assemble",
    "diagnose": "diagnosis.diagnose",
    "Verdict": "verdict.content",
    "virtual_supports": "diagnosis.supports",
    "stability": "flow.stability",
    "read_record": "io.records",
    "write_record": "io.records",
    "configurations": "study_folder.shared_files",
    "workflow_snakefile": "study_folder.shared_files",
}
__all__ = ["__version__", *PUBLIC]


def __getattr__(name):
    """Return a public name, imported from its module. Raises AttributeError for any other name."""
    if name not in PUBLIC:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    value = getattr(import_module(f"{__name__}.{PUBLIC[name]}"), name)
    globals()[name] = value
    return value


def __dir__():
    """Return the public names."""
    return sorted(__all__)

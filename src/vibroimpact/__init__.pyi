"""The public names: __init__.py imports each from here when it is first used."""

from .campaign.checks.file_checks import check_campaign as check_campaign
from .campaign.file import CampaignError as CampaignError
from .campaign.file import Channel as Channel
from .campaign.file import Level as Level
from .campaign.file import campaign_dataset as campaign_dataset
from .campaign.file import read_campaign as read_campaign
from .campaign.file import write_campaign as write_campaign
from .campaign.importing.assemble import import_folder as import_folder
from .config.json_schema import json_schema as json_schema
from .config.problems import ConfigError as ConfigError
from .config.reading import changed_config as changed_config
from .config.reading import check_config as check_config
from .config.reading import load_config as load_config
from .config.schema import Config as Config
from .diagnosis.diagnose import diagnose as diagnose
from .diagnosis.supports import virtual_supports as virtual_supports
from .diagnosis.verdict.content import Verdict as Verdict
from .equivalent_support.answer import EquivalentError as EquivalentError
from .equivalent_support.estimate import estimate_equivalent as estimate_equivalent
from .equivalent_support.export_formats.registry import springs_text as springs_text
from .equivalent_support.measured.equivalent_of import MeasuredSupports as MeasuredSupports
from .equivalent_support.measured.equivalent_of import equivalent_of as equivalent_of
from .equivalent_support.springs import point_springs as point_springs
from .equivalent_support.study_answer import equivalent as equivalent
from .flow.stability import stability as stability
from .identify.estimate import Estimate as Estimate
from .identify.identify_case import identify_case as identify_case
from .identify.linear.modes import natural_frequencies as natural_frequencies
from .identify.linear.responses import frf as frf
from .identify.spectra.welch import psd_statistics as psd_statistics
from .identify.spectra.welch import segment_spectra as segment_spectra
from .io.records import read_record as read_record
from .io.records import write_record as write_record
from .reduction.basis_accuracy import basis_frequency_errors as basis_frequency_errors
from .reduction.model_file import read_model as read_model
from .reduction.model_file import write_model as write_model
from .reduction.reduced_model import build_model as build_model
from .study.cases import Case as Case
from .study.cases import all_cases as all_cases
from .study.cases import cases_of_load as cases_of_load
from .study.flow_sweep import flow_sweep as flow_sweep
from .study.folder.shared_files import configurations as configurations
from .study.folder.shared_files import workflow_snakefile as workflow_snakefile
from .study.in_process import case_spectra as case_spectra
from .study.in_process import identify_support as identify_support
from .study.in_process import run_study as run_study
from .study.in_process import simulate_case as simulate_case
from .study.simulation import simulate_cases as simulate_cases
from .study.statistics_table import statistics_rows as statistics_rows
from .study.support_estimates import SupportEstimates as SupportEstimates

__version__: str
PUBLIC: dict[str, str]

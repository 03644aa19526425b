"""Section of the page on one joint."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from frictioncli.report.data_points import MOST_ROWS, data_points
from frictioncli.report.diagnosis_section import DiagnosisSection, diagnosis_section
from frictioncli.report.drawing import JointFigures
from frictioncli.report.experiment import Experiment, experiment
from frictioncli.report.explorer import Explorer, explorer
from frictioncli.report.figures import runs_drawn_note
from frictioncli.report.first_screen import Answer, answers
from frictioncli.report.formula import formula_symbols
from frictioncli.report.missing_data import evaluation_missing
from frictioncli.report.model_section import (
    ModelCard,
    model_cards,
    parameters_table,
    undetermined_base,
)
from frictioncli.report.page_tables import TextTable, epsilon_tables, pairs_table
from frictioncli.report.parameters import (
    ParameterRow,
    correlation_table,
    is_published_joint,
    limitations,
    parameter_rows,
)
from frictioncli.report.quality_ratings import IngestCounts, QualityRating, quality_ratings
from frictioncli.report.results import JointResults
from frictioncli.report.summary import KeyNumber, key_numbers, measurement_text, summary_text


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSection:
    """Everything that the template shows of one joint.

    Attributes
    ----------
    number : int
        Joint number, from 1.
    prefix : str
        Prefix of the names of its figures.
    answers : list of Answer
        First screen: how much friction, how sure, what is wrong, what to do next.
    summary, measurement : str
        The result, and what was measured.
    models, symbols : list of ModelCard, str
        Base and extended model with numbers, and the meaning of their symbols.
    both : TextTable or None
        Parameters of both models side by side, if there are two.
    both_open : str
        Which of them the extended model leaves open; may be empty.
    experiment : Experiment or None
        The next experiment, if one was planned.
    key_numbers : list of KeyNumber
        Most important numbers.
    ratings : list of QualityRating
        Ratings of data quality.
    parameters : list of ParameterRow
        Rows of the table of parameters.
    published, remarks : bool
        Whether this table has the published values, and remarks.
    correlations : TextTable or None
        Correlations of the estimates.
    limitations : list of str
        What the data cannot determine.
    epsilon : list of TextTable
        Errors of the evaluated corrections.
    epsilon_missing : str
        Why there are none; empty if there are.
    explorer : Explorer
        Data of the interactive explorer.
    diagnosis : DiagnosisSection
        Text and tables of the diagnosis.
    figures : JointFigures
        Figures.
    runs_note : str
        Note on runs that the figures leave out.
    pairs : TextTable
        Number of pairs per speed and phase.
    points : dict
        Measured and simulated torque of every move, to be written as JSON.
    """

    number: int
    prefix: str
    answers: list[Answer]
    summary: str
    measurement: str
    models: list[ModelCard]
    symbols: str
    both: TextTable | None
    both_open: str
    experiment: Experiment | None
    key_numbers: list[KeyNumber]
    ratings: list[QualityRating]
    parameters: list[ParameterRow]
    published: bool
    remarks: bool
    correlations: TextTable | None
    limitations: list[str]
    epsilon: list[TextTable]
    epsilon_missing: str
    explorer: Explorer
    diagnosis: DiagnosisSection
    figures: JointFigures
    runs_note: str
    pairs: TextTable
    points: Mapping[str, Any]


def joint_section(
    results: JointResults,
    figures: JointFigures,
    counts: IngestCounts,
    log_files: str,
    joints: int = 1,
) -> JointSection:
    """Return the section of the page on one joint.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    figures : JointFigures
        Its figures.
    counts : IngestCounts
        Rows and files of the logs that were read and rejected.
    log_files : str
        Names of the logs.
    joints : int
        Number of joints on the page, which share its size.
    """
    parameters = parameter_rows(results)
    document = results.diagnosis.document if results.diagnosis else None
    return JointSection(
        number=results.joint,
        prefix=figures.overview.name.removesuffix("overview"),
        answers=answers(results),
        summary=summary_text(results, document),
        measurement=measurement_text(results),
        models=model_cards(results),
        both=parameters_table(results),
        both_open=undetermined_base(results),
        experiment=experiment(results),
        symbols=formula_symbols(results),
        key_numbers=key_numbers(results, document),
        ratings=quality_ratings(results, counts, document),
        parameters=parameters,
        published=is_published_joint(results, log_files),
        remarks=any(row.remark for row in parameters),
        correlations=correlation_table(results),
        limitations=limitations(results, document),
        epsilon=epsilon_tables(results),
        epsilon_missing=evaluation_missing(results),
        explorer=explorer(results),
        diagnosis=diagnosis_section(results),
        figures=figures,
        runs_note=runs_drawn_note(results),
        pairs=pairs_table(results),
        points=data_points(results, most_rows=MOST_ROWS // joints),
    )

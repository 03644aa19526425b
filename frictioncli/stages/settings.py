"""Settings of the whole chain."""

from dataclasses import dataclass, field

from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.logs.settings import IngestSettings
from frictioncli.model.settings import FitSettings
from frictioncli.options import NO_OPTION
from frictioncli.pairs.settings import PairingSettings, SeparationSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """Settings of every stage of a run.

    Attributes
    ----------
    ingest : IngestSettings
        Reading of the logs.
    pairing : PairingSettings
        Segments of constant speed and their pairs.
    separation : SeparationSettings
        Separation of friction and load.
    fit : FitSettings
        Identification of the model.
    diagnosis : DiagnosisSettings or None
        Search for causes; None: no diagnosis.
    schedule : ScheduleSettings
        Corrections that are simulated.
    grid : EvaluationGrid
        Schedules that are evaluated.
    correction : CorrectionSettings
        How corrections are computed.
    """

    ingest: IngestSettings = field(default_factory=IngestSettings)
    pairing: PairingSettings = field(default_factory=PairingSettings)
    separation: SeparationSettings = field(default_factory=SeparationSettings)
    fit: FitSettings = field(default_factory=FitSettings)
    diagnosis: DiagnosisSettings | None = field(
        default_factory=DiagnosisSettings, metadata=NO_OPTION
    )
    schedule: ScheduleSettings = field(default_factory=ScheduleSettings)
    grid: EvaluationGrid = field(default_factory=EvaluationGrid, metadata=NO_OPTION)
    correction: CorrectionSettings = field(default_factory=CorrectionSettings)

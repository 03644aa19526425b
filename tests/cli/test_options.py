"""Every option of every command, typed: its value reaches the function that does the work.

The commands and options come from the command line itself, so one without a case fails.
"""

import importlib
import inspect
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer.main  # noqa: TID251

from frictioncli.cli.commands import app
from frictioncli.comparison.settings import Threshold
from frictioncli.correction.settings import ScheduleSettings
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.stages.settings import RunSettings
from tests.command_line import invoke


@dataclass(frozen=True, kw_only=True)
class Command:
    """How a command is called, and what its options do.

    Attributes
    ----------
    functions : tuple of str
        Functions that the command calls, ``module:function``, and which are replaced.
    words : tuple of str
        Arguments, and options that must be given.
    options : dict of str to tuple
        Spelling -> words typed after it, place of the value, and the value. A place is a function,
        its parameter and attributes. A function alone is one that is called only with the option.
    """

    functions: tuple[str, ...]
    words: tuple[str, ...] = ()
    options: dict[str, tuple[str, str, object]] = field(default_factory=dict)


def work_folder(place):
    return {"-w": ("RUN", place, Path("RUN")), "--work": ("RUN", place, Path("RUN"))}


def reading(place):
    return {
        "--joint": ("3 --joint 5", f"{place}.joints", (3, 5)),
        "--map": ("a.toml", f"{place}.map_file", Path("a.toml")),
        "--gear-ratio": ("-90.5", f"{place}.gear_ratio", -90.5),
        "--rated-torque": ("0.5", f"{place}.rated_torque", 0.5),
        "--torque-constant": ("-5.5", f"{place}.torque_constant", -5.5),
        "--time-unit": ("ms", f"{place}.time_unit", "ms"),
        "--position-unit": ("rad", f"{place}.position_unit", "rad"),
        "--velocity-unit": ("rpm", f"{place}.velocity_unit", "rpm"),
        "--torque-unit": ("mNm", f"{place}.torque_unit", "mNm"),
        "--temperature-unit": ("degF", f"{place}.temperature_unit", "degF"),
    }


def pairing(place):
    return {
        "--bin-width": ("10", f"{place}.bin_width", 10.0),
        "--min-speed": ("0.5", f"{place}.steady.min_speed", 0.5),
        "--speed-tolerance": ("0.1", f"{place}.steady.speed_tolerance", 0.1),
        "--settling": ("0.4", f"{place}.steady.settling", 0.4),
        "--min-samples": ("7", f"{place}.steady.min_samples", 7),
        "--same-speed": ("0.2", f"{place}.same_speed", 0.2),
        "--same-temperature": ("1.5", f"{place}.same_temperature", 1.5),
        "--longest-pause": ("30", f"{place}.longest_pause", 30.0),
    }


def separation(place):
    return {
        "--by": ("regression", f"{place}.by", "regression"),
        "--urdf": ("arm.urdf", f"{place}.urdf", Path("arm.urdf")),
        "--sign": ("-1", f"{place}.sign", -1),
    }


def identification(place):
    return {
        "--method": ("paper", f"{place}.method", "paper"),
        "--temperature": ("housing", f"{place}.temperature", "housing"),
    }


def schedule(place, criterion="uncertainty"):
    return {
        "--criterion": (criterion, f"{place}.criterion", criterion),
        "--k": ("7", f"{place}.k", 7.0),
        "--tmax": ("20", f"{place}.tmax", 1200.0),
        "--bound": ("1.5", f"{place}.bound", 1.5),
    }


def correction(place):
    return {
        "--correction-speed": ("50", f"{place}.correction_speed", 50.0),
        "--smoothing-degree": ("5", f"{place}.smoothing_degree", 5),
    }


def without(options, *names):
    return {name: case for name, case in options.items() if name not in names}


def stage(name, *others, words="", options):
    """Return a command that calls functions of the stage of its name."""
    module = f"frictioncli.stages.{name}"
    functions = tuple(f"{module}:{function}" for function in (name, *others))
    return Command(functions=functions, words=tuple(words.split()), options=options)


COMMANDS = {
    "inspect": Command(
        functions=(
            "frictioncli.inspection.inspect:inspect",
            "frictioncli.inspection.text:text",
            "frictioncli.inspection.document:document",
            "frictioncli.inspection.map_suggestion.suggest_map:suggested_map",
        ),
        words=("LOGS",),
        options=reading("inspect.settings")
        | {
            "--json": ("", "document", None),
            "--suggest-map": ("", "suggested_map", None),
            "--verbose": ("", "text.verbose", True),
        },
    ),
    "ingest": stage(
        "ingest", words="LOGS", options=work_folder("ingest.work") | reading("ingest.settings")
    ),
    "pair": stage("pair", options=work_folder("pair.work") | pairing("pair.settings")),
    "separate": stage(
        "separate", options=work_folder("separate.work") | separation("separate.settings")
    ),
    "fit": stage("fit", options=work_folder("fit.work") | identification("fit.settings")),
    "simulate": stage(
        "simulate",
        options=work_folder("simulate.work")
        | schedule("simulate.schedule")
        | correction("simulate.settings")
        | {"--extended": ("", "simulate.extended", True)},
    ),
    "evaluate": stage(
        "evaluate",
        options=work_folder("evaluate.work")
        | correction("evaluate.settings")
        | {
            "--k": ("1,2 --k 5", "evaluate.grid.k", (1.0, 2.0, 5.0)),
            "--tmax": ("10,20.5", "evaluate.grid.tmax", (600.0, 1230.0)),
            "--bound": ("1 --bound 2.5", "evaluate.grid.bound", (1.0, 2.5)),
            "--extended": ("", "evaluate.extended", True),
        },
    ),
    "diagnose": stage(
        "diagnose",
        "has_finding",
        options=work_folder("diagnose.work")
        | {
            "--alpha": ("0.01", "diagnose.settings.alpha", 0.01),
            "--seed": ("9", "diagnose.settings.seed", 9),
            "--most": ("2", "diagnose.settings.most", 2),
            "--margin": ("0.3", "diagnose.settings.margin", 0.3),
            "--fail-on": ("named", "has_finding.named_only", True),
        },
    ),
    "report": stage(
        "report", options=work_folder("report.work") | {"--png": ("", "report.png", True)}
    ),
    "run": stage(
        "run",
        words="LOGS",
        options=work_folder("run.work")
        | reading("run.settings.ingest")
        | pairing("run.settings.pairing")
        | separation("run.settings.separation")
        | identification("run.settings.fit")
        | schedule("run.settings.schedule")
        | correction("run.settings.correction"),
    ),
    "plan": stage(
        "plan",
        "plan_new",
        options=work_folder("plan.work")
        | {
            "--minutes": ("90", "plan.settings.minutes", 90.0),
            "--joint": ("4", "plan.settings.joint", 4),
            "--axis": ("4", "plan.settings.joint", 4),
            "--new": ("", "plan_new", None),
            "--seed": ("9", "plan.settings.seed", 9),
            "--from": ("-100", "plan.settings.low", -100.0),
            "--to-angle": ("45.5", "plan.settings.high", 45.5),
            "--max-speed": ("150", "plan.settings.max_speed", 150.0),
            "--max-temperature": ("70", "plan.settings.max_temperature", 70.0),
            "--payload": ("5 --payload 0", "plan.settings.payload", (5.0, 0.0)),
            "--to": ("urscript", "plan.settings.to", "urscript"),
            "--rated-speed": ("225", "plan.settings.rated_speed", 225.0),
        },
    ),
    "export": stage(
        "export",
        words="--to json",
        options=work_folder("export.work")
        | without(schedule("export.settings", "latest_degree"), "--bound")
        | {
            "--to": ("csv", "export.settings.to", "csv"),
            "--joint": ("4", "export.settings.joint", 4),
            "--extended": ("", "export.settings.extended", True),
            "--temperature": ("40", "export.settings.temperature", 40.0),
            "--load": ("-20", "export.settings.load", -20.0),
            "--lowest": ("5", "export.settings.lowest", 5.0),
            "--highest": ("90", "export.settings.highest", 90.0),
            "--tolerance": ("0.1", "export.settings.tolerance", 0.1),
            "--torque-constant": ("1.5", "export.settings.torque_constant", 1.5),
        },
    ),
    "compare": stage(
        "compare",
        "above_threshold",
        words="RUN1 RUN2",
        options=work_folder("compare.work")
        | {
            "--joint": ("4", "compare.settings.joint", 4),
            "--day-to-day": ("2.5", "compare.settings.day_to_day", 2.5),
            "--fail-above": ("3%", "compare.settings.fail_above", Threshold(3.0, "%")),
        },
    ),
    "fleet": Command(
        functions=("frictioncli.fleet.fleet:run_fleet", "frictioncli.fleet.fleet:has_failed"),
        words=("FLEET",),
        options=work_folder("run_fleet.out")
        | without(reading("run_fleet.settings.ingest"), "--joint")
        | separation("run_fleet.settings.separation")
        | identification("run_fleet.settings.fit")
        | without(schedule("run_fleet.settings.schedule"), "--criterion", "--bound")
        | {
            "--workers": ("3", "run_fleet.options.workers", 3),
            "--scheduler": ("tcp://host:1", "run_fleet.options.scheduler", "tcp://host:1"),
            "--redo": ("", "run_fleet.options.redo", True),
            "--timeout": ("90", "run_fleet.options.timeout", 90.0),
            "--tls-ca": ("ca.pem", "run_fleet.options.tls_ca", Path("ca.pem")),
            "--tls-cert": ("own.pem", "run_fleet.options.tls_cert", Path("own.pem")),
            "--tls-key": ("own.key", "run_fleet.options.tls_key", Path("own.key")),
            "--fail-on": ("failed", "has_failed", ""),
            "--report": ("", "run_fleet.options.report", True),
            "--no-report": ("", "run_fleet.options.report", False),
            "--diagnosis": ("", "run_fleet.settings.diagnosis", DiagnosisSettings()),
            "--no-diagnosis": ("", "run_fleet.settings.diagnosis", None),
        },
    ),
    "challenge": Command(
        functions=("frictioncli.challenge.challenge:challenge",),
        words=("LOGS",),
        options=work_folder("challenge.work")
        | reading("challenge.settings.ingest")
        | pairing("challenge.settings.pairing")
        | separation("challenge.settings.separation")
        | identification("challenge.settings.fit")
        | {
            "--effect": (
                "drift --effect inertia:2",
                "challenge.options.effects",
                ("drift", "inertia:2"),
            ),
            "--share": ("5", "challenge.options.share", 5.0),
            "--draws": ("3", "challenge.options.draws", 3),
            "--seed": ("9", "challenge.options.seed", 9),
            "--search": ("", "challenge.options.search", True),
            "--no-search": ("", "challenge.options.search", False),
        },
    ),
    "synthesize": Command(
        functions=("frictioncli.simulator.synthesize:synthesize",),
        words=("FOLDER",),
        options={
            "--seed": ("9", "synthesize.settings.seed", 9),
            "--runs": ("5", "synthesize.settings.runs", 5),
            "--joint": ("4", "synthesize.settings.joint", 4),
            "--sign": ("-1", "synthesize.settings.sign", -1),
            "--payload": ("3.5", "synthesize.settings.payload", 3.5),
            "--lowest": ("30", "synthesize.settings.lowest", 30),
            "--highest": ("50", "synthesize.settings.highest", 50),
            "--ambient": ("18 --ambient -5", "synthesize.settings.ambient", (18.0, -5.0)),
            "--ambient-drift": ("0.25", "synthesize.settings.ambient_drift", (0.25,)),
            "--motor-heat-share": ("0.4", "synthesize.settings.motor_heat_share", (0.4,)),
            "--noise-scale": ("0", "synthesize.settings.noise_scale", 0.0),
            "--nuisance": (
                "all --nuisance backlash:0.02",
                "synthesize.settings.nuisances",
                ("all", "backlash:0.02"),
            ),
            "--effect": (
                "drift:0.5 --effect stribeck",
                "synthesize.settings.effects",
                ("drift:0.5", "stribeck"),
            ),
            "--blind": ("", "synthesize.settings.blind", True),
            "--joint-kind": ("plain", "synthesize.settings.joint_kind", "plain"),
            "--noise-kind": ("white", "synthesize.settings.noise_kind", "white"),
            "--protocol": ("enriched", "synthesize.settings.protocol", "enriched"),
            "--thin": ("8", "synthesize.settings.thin", 8),
        },
    ),
}

OPTIONS = [
    (name, option)
    for name, command in typer.main.get_command(app).commands.items()
    for option in command.params
    if option.param_type_name == "option" and option.name != "help"
]
SPELLINGS = [
    (name, spelling)
    for name, option in OPTIONS
    for spelling in (*option.opts, *option.secondary_opts)
]
ON_BY_DEFAULT = {
    (name, spelling) for name, one in OPTIONS if one.secondary_opts for spelling in one.opts
}


@pytest.fixture
def calls(monkeypatch):
    """Return a function that types a command and gives the arguments of what it calls."""

    def called(name, *words):
        arguments = {}
        for place in COMMANDS[name].functions:
            module_name, function = place.split(":")
            module = importlib.import_module(module_name)
            signature = inspect.signature(getattr(module, function))

            def stub(*args, function=function, signature=signature, **kwargs):
                arguments[function] = SimpleNamespace(**signature.bind(*args, **kwargs).arguments)
                return {} if function == "document" else False

            monkeypatch.setattr(module, function, stub)
        result = invoke(name, *COMMANDS[name].words, *words)
        monkeypatch.undo()
        assert result.exit_code == 0, result.output
        return SimpleNamespace(**arguments)

    return called


@pytest.mark.parametrize(("name", "spelling"), SPELLINGS, ids=[" ".join(one) for one in SPELLINGS])
def test_an_option_reaches_what_does_the_work(calls, name, spelling):
    typed, place, value = COMMANDS[name].options[spelling]
    given, bare = calls(name, spelling, *typed.split()), calls(name)
    function, _, parameter = place.partition(".")
    if not parameter:
        assert hasattr(given, function)
        assert not hasattr(bare, function)
        return
    assert attrgetter(place)(given) == value
    # a value that is the default would also arrive if the option did nothing
    if hasattr(bare, function) and (name, spelling) not in ON_BY_DEFAULT:
        assert attrgetter(place)(bare) != value


def test_every_case_is_of_an_option():
    cases = {(name, spelling) for name, one in COMMANDS.items() for spelling in one.options}
    assert cases == set(SPELLINGS)


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        ("inspect", "inspect.logs", [Path("LOGS")]),
        ("ingest", "ingest.logs", [Path("LOGS")]),
        ("run", "run.logs", [Path("LOGS")]),
        ("challenge", "challenge.logs", [Path("LOGS")]),
        ("compare", "compare.runs", [Path("RUN1"), Path("RUN2")]),
        ("fleet", "run_fleet.fleet", Path("FLEET")),
        ("synthesize", "synthesize.folder", Path("FOLDER")),
    ],
)
def test_arguments_reach_what_does_the_work(calls, name, place, value):
    assert attrgetter(place)(calls(name)) == value


def test_the_last_of_a_pair_of_flags_counts(calls):
    assert calls("fleet", "--no-report", "--report").run_fleet.options.report is True
    arguments = calls("fleet", "--no-diagnosis", "--diagnosis").run_fleet
    assert arguments.settings.diagnosis == DiagnosisSettings()


def test_what_a_command_has_no_options_for_keeps_its_default(calls):
    settings = calls("fleet", "--k", "3").run_fleet.settings
    assert settings == RunSettings(schedule=ScheduleSettings(k=3.0))

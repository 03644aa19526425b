"""Pages of the documentation that are made from the program: reference pages and effects.

MkDocs calls these functions while it builds the site (``make docs``).
"""

import importlib
import inspect
import re
from pathlib import Path
from typing import Any

import msgspec
import typer
from mkdocs.structure.files import File, Files

from frictioncli import schemas
from frictioncli.challenge_schema import CHALLENGE
from frictioncli.cli.commands import app
from frictioncli.effects import BY_NAME
from frictioncli.report.effect_explanations import explanation

ROOT = Path(__file__).parents[1]

_STAGES = """
run ingest pair separate fit simulate evaluate diagnose report plan export compare
"""

_SETTINGS = """
logs pairs model correction diagnosis design deployment comparison fleet stages
"""

MODULES = {
    "Commands as functions": [
        *(f"frictioncli.stages.{name}" for name in _STAGES.split()),
        "frictioncli.fleet.fleet",
        "frictioncli.inspection.inspect",
    ],
    "Settings": [f"frictioncli.{name}.settings" for name in _SETTINGS.split()],
    "Physics": [
        "frictioncli.model.friction",
        "frictioncli.model.document",
        "frictioncli.deployment.deployed_model",
        "frictioncli.deployment.extended_corrector",
        "frictioncli.correction.corrector",
        "frictioncli.correction.evaluation",
    ],
    "Files": ["frictioncli.tables", "frictioncli.errors"],
}

DOCUMENTS = {
    "model.json": "frictioncli.model.document.FrictionModel",
    "diagnosis.json": "frictioncli.diagnosis.documents.document.DiagnosisDocument",
    "extended-model.json": "frictioncli.diagnosis.documents.extended_document.ExtendedDocument",
    "plan.json": "frictioncli.design.document.PlanDocument",
    "comparison.json": "frictioncli.comparison.document.ComparisonDocument",
}

OUTSIDE = {
    "../sample_logs/README.md": "sample_logs.md",
    "../examples": "examples.md",
    "../README.md": "index.md",
}
"""Links of the repository that lead out of the folder of pages."""


def on_files(files: Files, config: Any) -> Files:
    """Add the generated pages."""
    for path, text in (
        ("reference/commands.md", commands()),
        ("reference/tables.md", tables()),
        ("reference/documents.md", documents()),
        ("reference/effects.md", effects()),
        ("reference/python.md", python()),
        ("examples.md", examples()),
        ("sample_logs.md", (ROOT / "sample_logs" / "README.md").read_text(encoding="utf-8")),
    ):
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Lead links out of the folder of pages to the page that stands for their target."""
    up = "../" * page.file.src_uri.count("/")
    for target, stand_in in OUTSIDE.items():
        markdown = markdown.replace(f"]({target})", f"]({up}{stand_in})")
    return markdown


def commands() -> str:
    """Return the page of commands from their help."""
    group = typer.main.get_command(app)
    parts = [
        "# Commands",
        "`-w` names the work folder. Exit status: 0 done, 2 the input or an option is at fault,"
        " 3 `--fail-above` or `--fail-on` has a finding, 1 a bug.",
    ]
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        usage = " ".join(
            f"{one.metavar}" for one in command.params if not one.opts[0].startswith("-")
        )
        parts += [
            f"## {name}",
            inspect.cleandoc(command.help or ""),
            f"```\nfrictioncli {name} {usage} [OPTIONS]\n```".replace("  ", " "),
            "| option | default | meaning |\n|---|---|---|\n"
            + "\n".join(_option(one) for one in command.params),
        ]
    return "\n\n".join(parts)


def _option(one: Any) -> str:
    names = (
        one.metavar
        if not one.opts[0].startswith("-")
        else ", ".join(f"`{name}`" for name in (*one.opts, *one.secondary_opts))
    )
    default = "required" if one.required else one.default
    shown = "" if default is None or default is False or default == () else f"`{default}`"
    return f"| {names} | {shown} | {_cell(one.help or '')} |"


def tables() -> str:
    """Return the page of Parquet tables from their schemas."""
    parts = [
        "# Tables",
        "Every file is Parquet. The metadata of a column hold its unit and description; those of"
        " the file hold version, settings and the SHA-256 of its inputs.",
    ]
    known = [one for one in vars(schemas).values() if isinstance(one, schemas.Table)]
    known.append(CHALLENGE)
    for table in known:
        rows = "\n".join(
            f"| `{one.name}` | {one.type} | {one.unit} | {'yes' if one.nullable else ''}"
            f" | {_cell(one.description)} |"
            for one in table.columns
        )
        parts += [
            f"## {table.name}",
            f"One row per {table.row}.",
            f"| column | type | unit | may be empty | meaning |\n|---|---|---|---|---|\n{rows}",
        ]
    return "\n\n".join(parts)


def documents() -> str:
    """Return the page of JSON documents from the docstrings of their records."""
    parts = [
        "# Documents",
        "JSON, UTF-8. Later versions may add keys; they rename and reinterpret none.",
    ]
    for file, path in DOCUMENTS.items():
        module, _, name = path.rpartition(".")
        record = getattr(importlib.import_module(module), name)
        parts += [f"## {file}", *_record(record, set())]
    return "\n\n".join(parts)


def _record(record: Any, told: set[str]) -> list[str]:
    """Return a record's attributes as a table, and after it the records that it holds."""
    told.add(record.__name__)
    text = inspect.cleandoc(record.__doc__ or "")
    about, _, attributes = text.partition("Attributes\n----------\n")
    entries = re.findall(r"^(\S.*?) : (.*)\n((?: {4}.*\n?)+)", attributes + "\n", re.MULTILINE)
    rows = "\n".join(
        f"| {', '.join(f'`{one.strip()}`' for one in names.split(','))} | {_cell(kind)}"
        f" | {_cell(' '.join(meaning.split()))} |"
        for names, kind, meaning in entries
    )
    parts = [about.strip()]
    if rows:
        parts.append(f"| key | type | meaning |\n|---|---|---|\n{rows}")
    for inner in _inner_records(record):
        if inner.__name__ not in told:
            first, *rest = _record(inner, told)
            parts += [f"**{inner.__name__}**: {first}", *rest]
    return parts


def _inner_records(record: Any) -> list[Any]:
    """Return the records that the fields of a record hold, in the order of the fields."""
    found: list[Any] = []

    def walk(kind: Any) -> None:
        if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
            found.append(kind)
        for part in getattr(kind, "__args__", ()):
            walk(part)

    hints = inspect.get_annotations(record, eval_str=True)
    for kind in hints.values():
        walk(kind)
    return found


def effects() -> str:
    """Return the page of effects from their catalogue."""
    parts = [
        "# Effects",
        "The catalogue of [the diagnosis](../diagnosis.md): what each effect adds to the friction"
        " `dtau` or the load torque `dL` of the base model, and how it is distinguished from"
        " others. All parameters have physical bounds. `v` is speed, `T` temperature,"
        " `L` load torque, `q` angle.",
    ]
    for one in map(explanation, BY_NAME):
        parts += [
            f"## {one.name}",
            one.summary,
            f"```\n{one.equation}\n```",
            "| symbol | meaning | unit |\n|---|---|---|\n"
            + "\n".join(
                f"| `{symbol}` | {_cell(meaning)} | {_cell(unit)} |"
                for symbol, meaning, unit in one.parameters
            ),
            f"Source: {one.source}.",
        ]
        if one.confounders:
            parts.append(f"Similar effects: {one.confounders}. {one.experiment}")
    return "\n\n".join(parts)


def python() -> str:
    """Return the page of the Python API, which mkdocstrings fills in."""
    parts = [
        "# Python API",
        "Units: deg, deg/s, s, N·m (or A), °C. [From Python](../python.md) shows the use.",
    ]
    for title, modules in MODULES.items():
        parts.append(f"## {title}")
        parts += [f"::: {module}\n    options:\n      heading_level: 3" for module in modules]
    return "\n\n".join(parts)


def examples() -> str:
    """Return the page of the example scripts."""
    parts = ["# Examples", "Scripts that answer one question each; they run from the repository."]
    for path in sorted((ROOT / "examples").glob("*.py")):
        text = path.read_text(encoding="utf-8")
        about, _, code = text.removeprefix('"""').partition('"""\n')
        title, _, rest = about.strip().partition("\n")
        parts += [f"## {title.rstrip('.')}", rest.strip(), f"```python\n{code.strip()}\n```"]
    return "\n\n".join(parts)


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;")

"""Documents: what is written is read back, and a damaged one is refused with file and place."""

import json
from dataclasses import dataclass, replace

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import inspect

from frictioncli import documents
from frictioncli.comparison.document import ComparisonDocument
from frictioncli.deployment.document import DeployedDocument
from frictioncli.design.document import PlanDocument
from frictioncli.diagnosis.data.gravity_document import GravityCoefficients
from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import TableError
from frictioncli.fleet.joint_record import JointRecord
from frictioncli.model.document import PARAMETERS, FrictionModel, ParameterEstimate
from frictioncli.provenance import Provenance

KINDS = (
    FrictionModel,
    ExtendedDocument,
    DiagnosisDocument,
    ComparisonDocument,
    DeployedDocument,
    JointRecord,
    PlanDocument,
)

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
WORDS = st.text(max_size=5)
PLAIN = {
    inspect.FloatType: NUMBERS,
    inspect.IntType: st.integers(-(2**40), 2**40),
    inspect.BoolType: st.booleans(),
    inspect.NoneType: st.none(),
    inspect.AnyType: st.none() | st.booleans() | NUMBERS | WORDS,
}


def gravities():
    """Three coefficients, or five."""
    three = dict.fromkeys(("cosine", "sine", "offset"), NUMBERS)
    five = three | dict.fromkeys(("cosine_per_kg", "sine_per_kg"), NUMBERS)
    return st.builds(GravityCoefficients, **three) | st.builds(GravityCoefficients, **five)


def records(kind):
    """Return a strategy for all records of a type."""
    return _values(inspect.type_info(kind))


def _values(info):
    if isinstance(info, inspect.StructType | inspect.DataclassType):
        return _fields(info)
    if isinstance(info, inspect.StrType):
        return st.from_regex(info.pattern, fullmatch=True) if info.pattern else WORDS
    if isinstance(info, inspect.UnionType):
        return st.one_of(*map(_values, info.types))
    if isinstance(info, inspect.DictType):
        keys, values = _values(info.key_type), _values(info.value_type)
        return st.dictionaries(keys, values, max_size=2)
    if isinstance(info, inspect.VarTupleType):
        least = info.min_length or 0
        return st.lists(_values(info.item_type), min_size=least, max_size=2).map(tuple)
    if isinstance(info, inspect.TupleType):
        return st.tuples(*map(_values, info.item_types))
    return PLAIN[type(info)]


def _fields(info):
    if info.cls is DiagnosisSettings:
        return st.builds(DiagnosisSettings, alpha=st.floats(0.01, 0.4), most=st.integers(1, 4))
    if info.cls is GravityCoefficients:
        return gravities()
    strategies = {field.name: _values(field.type) for field in info.fields}
    if issubclass(info.cls, FrictionModel):
        # what no fit gives is refused
        estimates = st.builds(replace, records(ParameterEstimate), estimate=st.floats(-1, 1))
        strategies["parameters"] = st.fixed_dictionaries(dict.fromkeys(PARAMETERS, estimates))
        strategies |= {"rmse": st.floats(0, 9), "delay": st.none() | estimates}
    return st.builds(info.cls, **strategies)


def places(value, way=()):
    """Yield the way to every value of a document, without the cells of a table's row."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, part in inner:
        yield (*way, key)
        if isinstance(part, dict | list) and key != "row":
            yield from places(part, (*way, key))


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=12)
@given(data=st.data())
def test_what_is_written_is_read_back(kind, data):
    document = data.draw(records(kind))
    assert documents.decode(documents.to_json(document).encode(), kind) == document


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=12)
@given(data=st.data())
def test_a_wrong_type_is_refused_with_its_place(kind, data):
    document = json.loads(documents.to_json(data.draw(records(kind))))
    way = data.draw(st.sampled_from(sorted(places(document), key=str)))
    parent = document
    for key in way[:-1]:
        parent = parent[key]
    parent[way[-1]] = [["wrong"]]
    # of the tag of a record in a union the type that was found is not said
    refusal = r"^\$\S*: expected .*, got array$|^\$\S*: .* length|^\$\S*\.kind: expected str$"
    with pytest.raises(TableError, match=refusal):
        documents.decode(json.dumps(document).encode(), kind)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=5)
@given(data=st.data())
def test_a_missing_key_is_named_and_an_unknown_one_is_accepted(kind, data):
    document = json.loads(documents.to_json(data.draw(records(kind))))
    written = document | {"key of a later version": [1, {"a": None}]}
    documents.decode(json.dumps(written).encode(), kind)
    for field in inspect.type_info(kind).fields:
        if field.required:
            rest = {key: value for key, value in document.items() if key != field.name}
            with pytest.raises(TableError, match=f"missing required field {field.name}$"):
                documents.decode(json.dumps(rest).encode(), kind)


@dataclass(frozen=True)
class Sized:
    """A small document."""

    name: str
    sizes: tuple[float, ...]


SMALL = Sized("a", (1.0, 2.5))


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (b"", "is not JSON"),
        (b"nonsense", "is not JSON"),
        (b'{"name": "a", "sizes": [1.0, 2.', "is not JSON"),
        (b"\xff\xfe", "is not JSON"),
        (b"[]", r"\$: expected object, got array"),
        (b'{"name": "a", "sizes": [1.0, "2"]}', r"\$\.sizes\[1\]: expected float, got str"),
        (b'{"name": "a"}', r"\$: object missing required field sizes"),
        (b'{"joints": {"2": {"name": 1, "sizes": []}}}', r"\$\.joints\.2\.name: expected str"),
    ],
)
def test_a_damaged_file_gives_one_message_with_file_and_place(tmp_path, text, fault):
    path = tmp_path / "small.json"
    path.write_bytes(text)
    message = rf"small\.json: {fault}.*; run 'frictioncli fit' again$"
    with pytest.raises(TableError, match=message):
        documents.read_joints(path, Sized, "fit")


def test_a_missing_file_names_the_command(tmp_path):
    with pytest.raises(TableError, match=r"none\.json is missing; run 'frictioncli fit' first$"):
        documents.read(tmp_path / "none.json", Sized, "fit")


def test_a_folder_in_place_of_a_file_is_refused(tmp_path):
    with pytest.raises(TableError, match="cannot be read"):
        documents.read(tmp_path, Sized, "fit")


def test_joints_and_provenance_stand_behind_the_main_joint(tmp_path):
    path, origin = tmp_path / "small.json", Provenance("fit", {"k": 5}, {"a.parquet": "0" * 64})
    other = Sized("b", ())
    documents.write_joints(path, {3: other, 2: SMALL}, 3, origin)
    written = json.loads(path.read_text(encoding="utf-8"))
    assert list(written) == ["name", "sizes", "joints", "provenance"]
    assert list(written["provenance"]) == ["program", "version", "stage", "settings", "inputs"]
    assert written["name"] == "b"
    assert list(written["joints"]) == ["2", "3"]
    assert documents.read_joints(path, Sized, "fit") == [SMALL, other]
    assert documents.read(path, Sized, "fit") == other
    assert documents.read_provenance(path) == origin


def test_one_joint_stands_alone(tmp_path):
    path = tmp_path / "small.json"
    documents.write_joints(path, {2: SMALL}, 2, Provenance("fit"))
    assert "joints" not in json.loads(path.read_text(encoding="utf-8"))
    assert documents.read_joints(path, Sized, "fit") == [SMALL]
    documents.write(path, SMALL, Provenance("fit"))
    assert documents.read_joints(path, Sized, "fit") == [SMALL]


@pytest.mark.parametrize("text", [b"", b"[]", b"{}", b'{"provenance": 1}', b"\xff"])
def test_a_file_of_another_program_has_no_provenance(tmp_path, text):
    (tmp_path / "other.json").write_bytes(text)
    assert documents.read_provenance(tmp_path / "other.json") is None


@pytest.mark.parametrize("number", [float("nan"), float("inf"), np.float64("nan")])
def test_what_is_no_number_is_not_written(number):
    with pytest.raises(ValueError, match="not JSON compliant"):
        documents.to_json(Sized("a", (number,)))


def test_numbers_are_written_as_python_does():
    values = [np.float64(0.1), 1e-9, 1e22, 5.0, -0.0]
    assert documents.to_json(values) == json.dumps([float(one) for one in values], indent=2) + "\n"
    assert documents.to_json({np.str_("µ"): "°C"}) == '{\n  "µ": "°C"\n}\n'
    with pytest.raises(TypeError, match="cannot be written"):
        documents.to_json([object()])


def test_absent_fields_are_left_out():
    assert list(msgspec.to_builtins(GravityCoefficients(cosine=1.0, sine=2.0, offset=3.0))) == [
        "cosine",
        "sine",
        "offset",
    ]

"""The parameters of a command from its settings: what cannot be an option is an error at once."""

import inspect
from dataclasses import dataclass, field

import pytest

from frictioncli.cli.signature import with_options
from frictioncli.options import NO_OPTION, numbers_option, option


@dataclass(frozen=True, kw_only=True)
class Inner:
    width: float = field(default=5.0, metadata=option("Width [deg]."))


@dataclass(frozen=True, kw_only=True)
class Outer:
    inner: Inner = field(default_factory=Inner)
    form: str = field(metadata=option("Form."))
    longest: float = field(default=120.0, metadata=option("Longest time [min].", factor=60.0))
    grid: tuple[float, ...] = field(default=(1.0,), metadata=numbers_option("Grid.", "--grid"))
    hidden: int = field(default=7, metadata=NO_OPTION)


def command(*, first: int = 1, settings: Outer):
    global received
    received = first, settings


def names(function):
    return list(inspect.signature(function).parameters)


def test_one_parameter_per_option_required_ones_first():
    flat = with_options(command)
    assert names(flat) == ["form", "first", "width", "longest", "grid"]
    parameters = inspect.signature(flat).parameters
    assert parameters["longest"].default == 2.0
    assert parameters["grid"].default is None
    assert parameters["form"].default is inspect.Parameter.empty


def test_values_are_grouped_into_the_settings():
    with_options(command)(first=3, form="c", width=2.0, longest=1.5, grid=["1,2", "5"])
    settings = Outer(form="c", inner=Inner(width=2.0), longest=90.0, grid=(1.0, 2.0, 5.0))
    assert received == (3, settings)


def test_options_that_are_not_given_keep_the_defaults_of_the_fields():
    with_options(command)(first=1, form="c", width=5.0, longest=2.0, grid=None)
    assert received == (1, Outer(form="c"))


def test_a_command_may_leave_options_out_and_order_them():
    flat = with_options(command, without=("inner", "grid"), before={"first": ["longest"]})
    assert names(flat) == ["form", "longest", "first"]
    flat(first=1, form="c", longest=3.0)
    assert received == (1, Outer(form="c", longest=180.0))


@pytest.mark.parametrize(
    ("layout", "words"),
    [
        ({"without": ("widht",)}, "no fields widht"),
        ({"before": {"first": ["widht"]}}, "no parameters widht"),
        ({"before": {"widht": ["first"]}}, "no parameters widht"),
        ({"without": ("inner",), "before": {"first": ["width"]}}, "no parameters width"),
    ],
)
def test_a_name_that_is_not_there_is_an_error(layout, words):
    with pytest.raises(TypeError, match=words):
        with_options(command, **layout)


def test_a_field_without_option_is_an_error():
    @dataclass(frozen=True)
    class Forgotten:
        width: float = 5.0

    def wide(settings: Forgotten):
        pass

    with pytest.raises(TypeError, match="field width has neither an option nor NO_OPTION"):
        with_options(wide)


def test_two_options_of_one_name_are_an_error():
    def twice(*, width: float = 1.0, settings: Inner):
        pass

    with pytest.raises(TypeError, match="two parameters of one name"):
        with_options(twice)

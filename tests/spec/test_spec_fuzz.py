"""Whatever a spec file holds: a swimmer, or one sentence that is a SpecError."""

import tomllib

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import microswim as ms
from microswim.cli._options import change
from microswim.spec import file as spec
from microswim.spec.toml import to_toml
from strategies import FIELDS, VALID, scalars, values


def is_a_swimmer_or_one_sentence(make):
    try:
        assert isinstance(make(), ms.Swimmer)
    except ms.SpecError as error:
        message = str(error)
        assert message
        assert "\n" not in message
        assert "Traceback" not in message


fuzz = settings(
    max_examples=150, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
pytestmark = pytest.mark.filterwarnings(
    "ignore::microswim.swimmer.drag.coefficients.ValidityWarning",
    "ignore::pint.errors.UnitStrippedWarning",
)


@fuzz
@given(
    tables=st.sampled_from(VALID),
    changes=st.dictionaries(st.sampled_from(FIELDS), values, min_size=1, max_size=3),
    removed=st.lists(st.sampled_from(FIELDS), max_size=2),
)
def test_a_valid_spec_with_anything_in_some_fields(tables, changes, removed):
    tables = {name: dict(table) for name, table in tables.items()}
    for path in removed:
        table, _, field = path.partition(".")
        tables.get(table, {}).pop(field, None)
    is_a_swimmer_or_one_sentence(lambda: spec.from_dict(tables, changes))


@fuzz
@given(st.dictionaries(st.sampled_from(["fluid", "body", "tail", "motion", "x"]), values))
def test_anything_for_the_tables(tables):
    is_a_swimmer_or_one_sentence(lambda: spec.from_dict(tables))


@fuzz
@given(st.sampled_from(FIELDS), st.text(max_size=30))
@example("tail.length", "1 um # comment")
@example("tail.length", "1e5000")
@example("tail.length", "9**9**9**9 m")
@example("tail.length", "()")
@example("tail.length", "1\nb = 2")
def test_any_text_behind_set(field, text):
    is_a_swimmer_or_one_sentence(
        lambda: ms.Swimmer.preset("tabak/helix", dict([change(f"{field}={text}")]))
    )


@fuzz
@given(st.text(max_size=20), st.text(max_size=10))
def test_any_field_of_set(field, text):
    def make():
        return ms.Swimmer.preset("tabak/helix", dict([change(f"{field}={text}")]))

    is_a_swimmer_or_one_sentence(make)


@fuzz
@given(content=st.binary(max_size=60) | st.text(max_size=60).map(str.encode))
def test_any_file(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_bytes(content)
    is_a_swimmer_or_one_sentence(lambda: ms.Swimmer.from_toml(path))


@fuzz
@given(st.dictionaries(st.sampled_from(["radius", "shape"]), scalars | st.lists(scalars)))
def test_the_written_spec_is_toml(table):
    text = to_toml({"body": table}, "any\ncomment")
    back = tomllib.loads(text)["body"]
    assert repr(back) == repr(table)

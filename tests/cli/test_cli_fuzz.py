"""Ten thousand inputs: a finite answer, or one sentence and exit status 2; never a traceback."""

import json
import math
import os
import tomllib

import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from microswim.cli import main
from microswim.errors import SpecError
from microswim.spec import presets
from microswim.spec.toml import to_toml
from microswim.studies.optimisation import expressions
from strategies import FIELDS, quantities, values, words

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore"),  # what is said in passing is not what is tested
]
#: Of the inputs that are tried; less to look around quickly.
SHARE = float(os.environ.get("MICROSWIM_FUZZ_SHARE", "1"))
NAMES = ["tabak/helix", "tabak/plane_wave", "goto/C", "tabak/helix-constant"]
NUMBERS = st.sampled_from(
    ["1e308", "1e-308", "-1", "0", "nan", "inf", "1e400", "9**9**9", "²", "x", "", "1 um", "1 rps"]
    + [
        "5 px",
        "0.1",
        "2",
        "3",
        "1e10",
        "999999999999",
        "true",
        "1,5",
        "0x10",
        "1_0",
        "1 light_year",
    ]
)


def fuzz(count):
    """Settings of a test of `count` inputs, the same ones each time."""
    return settings(
        max_examples=int(count * SHARE),
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )


def finite(value):
    """Whether all numbers in a JSON object are finite."""
    if isinstance(value, dict):
        return all(map(finite, value.values()))
    if isinstance(value, list):
        return all(map(finite, value))
    return not isinstance(value, float) or math.isfinite(value)


def answers_or_refuses(*arguments, statuses=(0, 2)):
    """Run a command: an answer on stdout, or nothing there and one sentence on stderr."""
    run = CliRunner().invoke(main, [str(a) for a in arguments])
    said = f"{arguments}: {run.stdout[:200]} {run.stderr[:500]} {run.exception!r}"
    assert run.exit_code in statuses, said
    assert run.exception is None or isinstance(run.exception, SystemExit), said
    assert "Traceback" not in run.output, said
    if run.exit_code:
        errors = [line for line in run.stderr.splitlines() if line.startswith("Error: ")]
        assert len(errors) == 1, said
    elif run.stdout.startswith("{"):
        assert finite(json.loads(run.stdout)), said
    return run


@fuzz(2500)
@given(
    name=st.sampled_from(NAMES),
    command=st.sampled_from(["run", "run", "show"]),
    changes=st.dictionaries(st.sampled_from(FIELDS), NUMBERS | words | quantities, max_size=2),
)
def test_anything_behind_set(name, command, changes):
    pairs = [x for field, text in changes.items() for x in ("--set", f"{field}={text}")]
    more = ["--json"] if command == "run" else []
    answers_or_refuses(command, "--preset", name, *pairs, *more)


@fuzz(2500)
@given(
    name=st.sampled_from(NAMES),
    field=st.sampled_from(FIELDS),
    value=values,
)
def test_anything_in_a_file(tmp_path_factory, name, field, value):
    tables = tomllib.loads(presets.read(name))
    table, _, key = field.partition(".")
    tables.setdefault(table, {})[key] = value
    path = tmp_path_factory.getbasetemp() / "field.toml"
    path.write_text(to_toml(tables, "any"), encoding="utf-8")
    answers_or_refuses("run", path, "--json")


@fuzz(1500)
@given(
    name=st.sampled_from(NAMES),
    cuts=st.lists(st.tuples(st.floats(0, 1), st.binary(max_size=4)), min_size=1, max_size=4),
    how=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"]),
)
def test_a_damaged_spec(tmp_path_factory, name, cuts, how):
    data = bytearray(presets.read(name).encode(how, errors="replace"))
    for where, piece in cuts:
        at = int(where * len(data))
        data[at : at + len(piece)] = piece
    path = tmp_path_factory.getbasetemp() / "damaged.toml"
    path.write_bytes(bytes(data))
    answers_or_refuses("run", path, "--json")


pieces = st.sampled_from(
    [
        "swimming_speed",
        "mean_torque",
        "efficiency",
        "body_rate",
        "nothing",
        "1/0",
        "9**9**9",
        "2**100000",
    ]
    + [
        "10**400",
        "(",
        ")",
        "swimming_speed +",
        "abs(swimming_speed)",
        "log(0)",
        "min(swimming_speed, mean_torque)",
        "2<=1",
    ]
    + [
        "__import__('os')",
        "swimming_speed.x",
        "[1]",
        "'a'",
        "swimming_speed" * 200,
        "((((((1))))))",
        "é",
        "1e308*1e308",
    ]
)


@fuzz(1200)
@given(
    wish=st.lists(pieces, min_size=1, max_size=2).map(" ".join) | st.text(max_size=20),
    limit=st.just("") | st.builds("{}<={}".format, pieces, NUMBERS),
)
def test_any_expression(wish, limit):
    known = {"swimming_speed": 1.0, "mean_torque": 2.0, "efficiency": 0.01, "body_rate": 0.3}
    for parse, text in ((expressions.parse, wish), (expressions.constraints, limit)):
        try:
            parse(text, known)
        except SpecError as refused:
            said = str(refused)
        else:
            said = ""
        assert "\n" not in said


@fuzz(1200)
@given(
    rows=st.lists(st.lists(NUMBERS | st.text(max_size=8), min_size=1, max_size=3), max_size=4),
    header=st.lists(st.sampled_from([*FIELDS, "speed", "time", "x", "y", "us", ""]), max_size=3),
    between=st.sampled_from([",", ";", "\t"]),
    how=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"]),
    command=st.sampled_from(["designs", "table", "series"]),
)
def test_any_table(tmp_path_factory, rows, header, between, how, command):
    base = tmp_path_factory.getbasetemp()
    path = base / "table.csv"
    text = "\n".join(between.join(row) for row in [header, *rows])
    path.write_bytes(text.encode(how, errors="replace"))
    given_ = ("--preset", "tabak/helix")
    if command == "designs":
        store = base / f"fuzz-{os.getpid()}.zarr"
        answers_or_refuses(
            "sweep", *given_, "--designs", path, "--out", store, "--json", statuses=(0, 1, 2)
        )
    else:
        answers_or_refuses("calibrate", *given_, f"--{command}", path, "--json", statuses=(0, 1, 2))


options = {
    "run": ["--model", "--level", "--periods"],
    "sweep": ["--over", "--option", "--workers", "--scheduler", "--level"],
    "design": ["--over", "--maximize", "--subject-to", "--tolerance", "--seed", "--uncertain"],
    "calibrate": ["--measured", "--unknown", "--bound", "--region", "--solves", "--option"],
    "validate": ["--over", "--quantity", "--workers", "--option"],
    "export": ["--format", "--name", "--moment", "--resolution"],
    "identify": ["--sigma", "--starts", "--unknown"],
}


@fuzz(1200)
@given(data=st.data())
def test_any_option(data):
    """Values that cannot be meant, or mean little work."""
    command = data.draw(st.sampled_from(sorted(options)))
    option = data.draw(st.sampled_from(options[command]))
    value = data.draw(
        st.sampled_from(["x", "", "1:0", "tail.waves=", "=1", "a=b", "-1", "nan", "²"])
    )
    rest = ["absent.csv"] if command == "identify" else []
    answers_or_refuses(command, *rest, "--preset", "tabak/helix", option, value)

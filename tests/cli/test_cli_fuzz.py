"""Ten thousand distinct inputs: a finite answer, or one sentence and status 2; never a traceback.

``pytest -m slow tests/cli/test_cli_fuzz.py`` prints how many of each kind were tried and
mishandled; ``MICROSWIM_FUZZ_SHARE=0.05`` looks around quickly, ``MICROSWIM_FUZZ_SEED=7`` elsewhere.
"""

import json
import math
import os
import shutil
import tomllib

import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, Phase, given, seed, settings
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
SEED = int(os.environ.get("MICROSWIM_FUZZ_SEED", "0"))
KINDS = {
    "values behind --set": 2400, "fields of a file": 2500, "damaged files": 1500,
    "expressions": 1500, "tables": 1200, "options": 900, "tracks": 200,
}  # fmt: skip
ROUNDS = 100  #: in which what was drawn twice is drawn anew
NAMES = ["tabak/helix", "tabak/plane_wave", "goto/C", "tabak/helix-constant"]
ODD = st.sampled_from(
    ["1e308", "1e-308", "-1", "nan", "inf", "1e400", "9**9**9", "²", "x", "", "1 um", "1 rps",
     "5 px", "1e10", "999999999999", "true", "1,5", "0x10", "1_0", "1 light_year", "1:0", "a:b",
     "1/0", "--", "=", "[]", "None"]
)  # fmt: skip
NUMBERS = ODD | st.sampled_from(["0", "0.1", "2", "3"]) | st.floats().map(repr)
LINE = st.text(st.characters(codec="utf-8", exclude_characters="\x00"), max_size=12)


def test_it_is_ten_thousand():
    assert sum(KINDS.values()) > 10_000


@pytest.fixture
def try_each(capsys, tmp_path, monkeypatch):
    """Check as many distinct inputs as a kind asks for; say how many failed, whatever pytest hides.

    What a command writes, it writes into a folder of the test.
    """
    monkeypatch.chdir(tmp_path)

    def tried(kind, inputs, check):
        mishandled = all_mishandled(kind, inputs, check)
        with capsys.disabled():
            count = math.ceil(SHARE * KINDS[kind])
            print(f"\n{kind}: {count} inputs tried, {len(mishandled)} mishandled")
        assert not mishandled, "\n".join(mishandled[:20])

    return tried


def all_mishandled(kind, inputs, check):
    """Each input that failed its check, with how, of as many distinct ones as the kind asks for."""
    wanted, seen, mishandled = math.ceil(SHARE * KINDS[kind]), set(), []

    def one(value):
        if repr(value) in seen or len(seen) == wanted:
            return
        seen.add(repr(value))
        try:
            check(value)
        except Exception as error:
            mishandled.append(f"{value!r}: {type(error).__name__}: {error}")

    for turn in range(ROUNDS):
        lacking = wanted - len(seen)
        if lacking:
            quiet = settings(
                max_examples=max(lacking, 20), deadline=None, database=None,
                phases=[Phase.generate], suppress_health_check=list(HealthCheck),
            )  # fmt: skip
            seed(ROUNDS * SEED + turn)(quiet(given(inputs)(one)))()
    assert len(seen) == wanted, "there are not as many inputs of this kind"
    return mishandled


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


def test_anything_behind_set(try_each):
    def check(one):
        name, command, changes = one
        pairs = [x for field, text in changes.items() for x in ("--set", f"{field}={text}")]
        answers_or_refuses(
            command, "--preset", name, *pairs, *(["--json"] if command == "run" else [])
        )

    changes = st.dictionaries(
        st.sampled_from(FIELDS), NUMBERS | words | quantities, min_size=1, max_size=2
    )
    asked = st.tuples(st.sampled_from(NAMES), st.sampled_from(["run", "run", "show"]), changes)
    try_each("values behind --set", asked, check)


def test_anything_in_a_file(try_each, tmp_path):
    path = tmp_path / "field.toml"

    def check(one):
        name, field, value = one
        tables = tomllib.loads(presets.read(name))
        table, _, key = field.partition(".")
        tables.setdefault(table, {})[key] = value
        path.write_text(to_toml(tables, "any"), encoding="utf-8")
        answers_or_refuses("run", path, "--json")

    asked = st.tuples(st.sampled_from(NAMES), st.sampled_from(FIELDS), values)
    try_each("fields of a file", asked, check)


ENCODINGS = st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"])


def test_a_damaged_spec(try_each, tmp_path):
    path = tmp_path / "damaged.toml"

    def check(one):
        name, cuts, how = one
        data = bytearray(presets.read(name).encode(how, errors="replace"))
        for where, piece in cuts:
            at = int(where * len(data))
            data[at : at + len(piece)] = piece
        path.write_bytes(bytes(data))
        answers_or_refuses("run", path, "--json")

    cut = st.tuples(st.floats(0, 1), st.binary(min_size=1, max_size=4))
    cuts = st.lists(cut, min_size=1, max_size=4)
    try_each("damaged files", st.tuples(st.sampled_from(NAMES), cuts, ENCODINGS), check)


PIECES = st.sampled_from(
    ["swimming_speed", "mean_torque", "efficiency", "body_rate", "nothing", "1/0", "9**9**9",
     "2**100000", "10**400", "(", ")", "swimming_speed +", "abs(swimming_speed)", "log(0)",
     "min(swimming_speed, mean_torque)", "2<=1", "__import__('os')", "swimming_speed.x", "[1]",
     "'a'", "swimming_speed" * 200, "((((((1))))))", "é", "1e308*1e308", "*", "/", "**", "-", "<="]
)  # fmt: skip


def test_any_expression(try_each):
    known = {"swimming_speed": 1.0, "mean_torque": 2.0, "efficiency": 0.01, "body_rate": 0.3}

    def check(one):
        for parse, text in zip((expressions.parse, expressions.constraints), one):
            said = ""
            try:
                parse(text, known)
            except SpecError as refused:
                said = str(refused)
            assert "\n" not in said

    wish = st.lists(PIECES | NUMBERS, min_size=1, max_size=4).map(" ".join) | st.text(max_size=20)
    limit = st.just("") | st.builds("{}<={}".format, PIECES, NUMBERS | quantities)
    try_each("expressions", st.tuples(wish, limit), check)


def test_any_table(try_each, tmp_path):
    path, store = tmp_path / "table.csv", tmp_path / "fuzz.zarr"
    base = ("--preset", "tabak/helix")

    def check(one):
        rows, header, between, how, command = one
        text = "\n".join(between.join(row) for row in [header, *rows])
        path.write_bytes(text.encode(how, errors="replace"))
        ask = ("calibrate", *base, f"--{command}", path)
        if command == "designs":
            shutil.rmtree(store, ignore_errors=True)
            ask = ("sweep", *base, "--designs", path, "--out", store)
        answers_or_refuses(*ask, "--json", statuses=(0, 1, 2))

    rows = st.lists(st.lists(NUMBERS | st.text(max_size=8), min_size=1, max_size=3), max_size=4)
    others = ["swimming_speed", "time", "mean.us", "us", "us (um/s)", "mean.os_sigma", ""]
    header = st.lists(st.sampled_from(FIELDS + others) | LINE, max_size=3)
    between = st.sampled_from([",", ";", "\t"])
    kinds = st.sampled_from(["designs", "table", "series"])
    try_each("tables", st.tuples(rows, header, between, ENCODINGS, kinds), check)


OPTIONS = {
    "run": ["--model", "--level", "--periods", "--accuracy", "--trust"],
    "sweep": ["--over", "--option", "--workers", "--scheduler", "--level", "--designs"],
    "design": ["--over", "--maximize", "--subject-to", "--tolerance", "--seed", "--uncertain"],
    "calibrate": ["--measured", "--unknown", "--bound", "--region", "--solves", "--option"],
    "validate": ["--over", "--quantity", "--workers", "--option"],
    "export": ["--format", "--moment", "--resolution", "--steps"],
    "identify": ["--sigma", "--sigma-attitude", "--starts", "--unknown", "--fps", "--pixel"],
    "regimes": ["--frequency", "--strength", "--over", "--level"],
    "follow": ["--path", "--strength", "--frequency", "--step", "--time"],
    "swim": ["--level"],
}


def test_any_option(try_each):
    """Values that cannot be meant, or mean little work."""

    def check(one):
        command, option, value = one
        rest = ["absent.csv"] if command == "identify" else []
        answers_or_refuses(command, *rest, "--preset", "tabak/helix", option, value)

    named = st.builds("{}={}".format, st.sampled_from([*FIELDS, "a", ""]), ODD)
    value = ODD | named | LINE.filter(lambda text: not text.strip().isdigit())
    asked = st.sampled_from([(c, o) for c, all_ in OPTIONS.items() for o in all_])
    try_each("options", st.tuples(asked, value).map(lambda x: (*x[0], x[1])), check)


def test_any_track(try_each, tmp_path):
    path = tmp_path / "track.csv"

    def check(one):
        header, rows, between, how, more = one
        text = "\n".join(between.join(row) for row in [header, *rows])
        path.write_bytes(text.encode(how, errors="replace"))
        answers_or_refuses("identify", path, *more, "--json", statuses=(0, 1, 2))

    usual = ["time", "time (s)", "frame", "x", "x (um)", "y", "y (px)", "z", "s", "angle", "qw"]
    names = st.sampled_from([*usual, "particle", "TRACK_ID", "POSITION_X", "t"]) | LINE
    header = st.lists(names, min_size=1, max_size=5)
    few = st.lists(st.lists(NUMBERS, min_size=1, max_size=5), max_size=16)
    many = st.integers(12, 20).flatmap(
        lambda n: st.lists(st.lists(st.floats(-9, 9).map(repr), min_size=3, max_size=3),
                           min_size=n, max_size=n))  # fmt: skip
    straight = many.map(lambda rows: [[str(i), *row[1:]] for i, row in enumerate(rows)])
    common = st.sampled_from([["time (s)", "x (um)", "y (um)"], ["frame", "x (px)", "y (px)"]])
    more = st.sampled_from([(), ("--fps", "25"), ("--pixel", "0.1um"), ("--fps", "x")])
    table = st.tuples(header, few) | st.tuples(common, straight | many)
    asked = st.tuples(table, st.sampled_from([",", ";", "\t"]), ENCODINGS, more)
    try_each("tracks", asked.map(lambda x: (*x[0], *x[1:])), check)

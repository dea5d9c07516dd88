"""The paper, reproduced: every claim's verdict against the numbers of today, figures, report."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.studies.paper import ITEMS, item
from microswim.studies.paper.claims import KINDS, Judgement, judge, load
from microswim.studies.paper.context import AMPLITUDE, WAVES, Context, lines, observed, swimmer
from microswim.studies.paper.fig4 import peaks
from microswim.studies.paper.report import reproduce

pytestmark = pytest.mark.filterwarnings("ignore::microswim.ValidityWarning")

CLAIMS = load()
MODEL = [c for c in CLAIMS if not c.reference]
REFERENCE = [c for c in CLAIMS if c.reference and not c.slow]
SLOW = [c for c in CLAIMS if c.slow]


def by_id(claims):
    return pytest.mark.parametrize("claim", claims, ids=[c.id for c in claims])


@pytest.fixture(scope="module")
def lines_only():
    return Context(circles=False)


@pytest.fixture(scope="module")
def coarse(tmp_path_factory):
    return Context(quick=True, store=tmp_path_factory.mktemp("solutions"))


@pytest.fixture(scope="module")
def thorough(tmp_path_factory):
    return Context(store=tmp_path_factory.mktemp("solutions"))


@by_id(MODEL)
def test_verdict_matches_the_model(claim, lines_only):
    found = judge(claim, lines_only)
    assert found.holds, (found.ours, claim.value, claim.tolerance, found.evidence)


@by_id(REFERENCE)
def test_verdict_matches_the_reference(claim, coarse):
    found = judge(claim, coarse)
    assert found.holds, (found.ours, claim.value, claim.tolerance, found.evidence)


@pytest.mark.slow
@by_id(REFERENCE + SLOW)
def test_verdict_matches_the_reference_at_its_standard_level(claim, thorough):
    found = judge(claim, thorough)
    assert found.holds, (found.ours, claim.value, claim.tolerance, found.evidence)


def test_claims_say_all_that_they_must():
    assert len({c.id for c in CLAIMS}) == len(CLAIMS)
    for claim in CLAIMS:
        assert claim.where, claim.id
        assert claim.says, claim.id
        assert claim.unit, claim.id
        assert claim.reason, claim.id
        assert claim.kind in KINDS
        assert claim.ours or claim.kind.startswith("cannot"), claim.id
        assert np.all(np.asarray(claim.tolerance) >= 0), claim.id
        assert (claim.kind == "sign agrees") == bool(claim.side), claim.id
        assert (
            claim.kind in ("agrees", "sign agrees") or len(claim.verdict) > len(claim.kind) + 10
        ), claim.id
        if claim.shows:
            assert claim.evidence, claim.id


def test_every_table_and_figure_is_claimed_or_drawn():
    text = " ".join(c.where for c in CLAIMS)
    for name in (
        "Table 1",
        "Table 2",
        "Table 3",
        "Table 4",
        "Fig. 2",
        "Fig. 4",
        "Fig. 6",
        "Fig. 7",
    ):
        assert name in text


def test_a_verdict_breaks_when_the_numbers_move():
    agrees = next(c for c in CLAIMS if c.id == "drag-factor")
    differs = next(c for c in CLAIMS if c.id == "wavenumber")
    assert Judgement(claim=agrees, ours=2.28).holds
    assert not Judgement(claim=agrees, ours=2.4).holds
    assert not Judgement(claim=agrees, ours=float("nan")).holds
    assert not Judgement(claim=agrees, ours=[2.28, 2.28]).holds
    assert Judgement(claim=differs, ours=9.42, evidence=3.0).holds
    assert not Judgement(claim=differs, ours=3.0, evidence=3.0).holds
    assert not Judgement(claim=differs, ours=9.42, evidence=4.0).holds
    sign = replace(agrees, value=1.0, tolerance=0.0, side="below", verdict="sign agrees")
    assert Judgement(claim=sign, ours=0.99).holds
    assert not Judgement(claim=sign, ours=1.01).holds
    assert not Judgement(claim=sign, ours=float("nan")).holds
    brackets = replace(differs, shows="brackets")
    assert Judgement(claim=brackets, ours=9.42, evidence=[2.0, 4.0]).holds
    assert not Judgement(claim=brackets, ours=9.42, evidence=[4.0, 5.0]).holds


def test_what_the_level_cannot_decide_is_said():
    fine = next(c for c in CLAIMS if c.fine)
    open_ = Judgement(claim=fine, ours=fine.value + 2 * fine.tolerance, too_coarse=True)
    assert open_.holds
    assert open_.kind == "not judged"
    assert "coarse level" in open_.sentence
    assert not replace(open_, too_coarse=False).holds


@pytest.mark.parametrize("name", [n for n in ITEMS if n not in ("fig6", "table4")])
def test_tables_and_figures_are_drawn(name, lines_only):
    module = item(name)
    figure = module.plot(module.compute(lines_only))
    drawn = [ax for ax in figure.axes if ax.has_data() or ax.patches]
    assert drawn
    assert all(ax.get_xlabel() or ax.get_ylabel() for ax in drawn)


def test_the_lines_are_the_gait_s_own():
    """Batched lines and single gaits are two ways to one number."""
    for tail in ("helix", "plane_wave"):
        who = swimmer(tail, "constant")
        line = lines(who, {AMPLITUDE: np.array([0.05, 0.12])})
        for row, b in zip(line, (0.05, 0.12)):
            single = observed(who.with_({AMPLITUDE: b}).gait())
            assert row == pytest.approx(single, rel=2e-6)


def test_peaks_of_a_known_curve():
    x = np.linspace(0.0, 5.0, 101)
    assert peaks(x, np.cos(2 * np.pi * (x - 0.31)), 1.0, 4.0) == pytest.approx(
        [1.31, 2.31, 3.31], abs=1e-3
    )


def test_a_reference_solution_is_solved_once(tmp_path, monkeypatch):
    who = swimmer("helix", "constant")
    first = Context(quick=True, store=tmp_path).reference(who)
    monkeypatch.setattr(ms.Swimmer, "gait", lambda *a, **k: pytest.fail("solved again"))
    again = Context(quick=True, store=tmp_path)
    # The interaction coefficients are the surrogate's; the reference does not see them.
    second = again.reference(swimmer("helix", "sbt"))
    assert np.array_equal(first.mean_velocity, second.mean_velocity)
    assert len(list(tmp_path.iterdir())) == 1


def test_other_designs_are_other_solutions(tmp_path):
    context = Context(quick=True, store=tmp_path)
    who = swimmer("helix", "constant")
    a, b = (context.reference(x).mean_velocity[0] for x in (who, who.with_({WAVES: 2})))
    assert a != b


def test_the_report_stands_alone(tmp_path):
    result = reproduce(tmp_path, only=("fig7", "table2", "fig3"), quick=True)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert result["broken"] == []
    assert page.count("<svg") == 3
    links = re.findall(r'(?:src|href)="([^"#][^"]*)"', page)
    assert links == []
    assert "<script" not in page
    claims = json.loads((tmp_path / "claims.json").read_text(encoding="utf-8"))
    assert {c["id"] for c in claims} >= {"appendix-limit", "table2-frequency"}
    ids = re.findall(r' id="([^"]+)"', page)
    assert len(ids) == len(set(ids))


@pytest.mark.slow
def test_the_quick_reproduction_holds_as_a_whole(tmp_path):
    """`microswim reproduce --quick` from the command line: exit 0, every table and figure there."""
    out = tmp_path / "paper"
    run = CliRunner().invoke(main, ["reproduce", "--quick", "--out", str(out), "--json"])
    assert run.exit_code == 0, run.output[-500:]
    result = json.loads(run.stdout)
    assert result["broken"] == []
    assert len(result["claims"]) == len(CLAIMS)
    assert result["verdicts"]["not judged"] == sum(c.fine for c in CLAIMS)
    assert {f.stem for f in out.glob("*.svg")} == set(ITEMS)


def test_an_unknown_item_is_named(tmp_path):
    with pytest.raises(ms.SpecError, match="fig4"):
        reproduce(tmp_path, only=("fig99",))

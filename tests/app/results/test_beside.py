"""The answer beside another walk or the last visit: thin curves, changes with their verdict, and nothing forbidden."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from app.results.beside_choice import Beside
from app.results.beside_words import answer_beside, beside_columns, key_figures_beside
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.results.result_page import STRIDES, ResultPage
from app.summary.beside import beside_last_visit, beside_walk, changes_on_curves, walks_alone
from app.summary.comparison import Comparison
from app.summary.request import AnalysedVisit
from app.summary.visits import WalkedVisit, conditions_in_words, visits_by_condition
from app.theme.notifier import ThemeNotifier, load_fonts
from core.analysis import analyse
from core.body import Joint, Side
from core.results import Analysis, ZeroKind
from core.session import Session
from core.verdicts.measurement_error import Judgement
from core.verdicts.sigmas import ComparisonKind
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from devices.simulation.walker_body import Tissue
from tests.app.changed_analysis import recalibrated
from tests.app.room import settle

MINUS = "\N{MINUS SIGN}"


@pytest.fixture(scope="module")
def session() -> Session:
    """Two walks of one strapping, the second slower and with an orthosis."""
    walks = (Walk(strides=13), Walk("walk 2", strides=13, speed_m_s=0.8))
    played: tuple[Standing | FreeMotion | Walk, ...] = (Standing(), FreeMotion(), *walks)
    found = simulate(replace(DEMONSTRATION, tissue=Tissue.RIGID, recordings=played)).session
    return with_conditions(found, walk_1="shoes", walk_2="AFO")


def with_conditions(session: Session, **conditions: str) -> Session:
    named = {name.replace("_", " "): condition for name, condition in conditions.items()}
    recordings = tuple(replace(one, condition=named.get(one.name, "")) for one in session.recordings)
    return replace(session, recordings=recordings)


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analyse(session)


@pytest.fixture
def page(qtbot: QtBot, qapp: QApplication, analysis: Analysis, session: Session) -> ResultPage:
    load_fonts()
    look = ThemeNotifier()
    look.set_dark(False)
    page = ResultPage(look)
    qtbot.addWidget(page)
    page.resize(1064, 672)
    page.set_room(1064, 672)
    page.set_has_visits(True)
    page.show_visit(AnalysedVisit(session, analysis))
    show(page, "walk 1")
    page.show()
    return page


def show(page: ResultPage, recording: str) -> None:
    page.recordings.setCurrentIndex(page.recordings.findData(recording))


def choose(page: ResultPage, beside: Beside | str) -> None:
    page.beside.setCurrentIndex(page.beside.findData(beside))


def give_visits(page: ResultPage, visits: Sequence[WalkedVisit]) -> None:
    page.show_visits(visits_by_condition(visits), conditions_in_words(visits))


def words_beside(page: ResultPage) -> list[str]:
    return [frame.beside.text() if frame.beside.isVisible() else "" for frame in page.cycles.charts.frames]


def test_another_walk_is_offered_with_its_condition_and_the_shown_one_is_not(page: ResultPage) -> None:
    offered = [page.beside.itemText(row) for row in range(page.beside.count())]
    assert offered == ["Versus reference", "Left and right only", "Versus B AFO", "Versus last visit"]
    show(page, "walk 2")
    assert page.beside.itemText(2) == "Versus A shoes"


def test_the_other_walk_is_drawn_thin_and_named(page: ResultPage, analysis: Analysis, session: Session) -> None:
    chart = page.cycles.charts.knee.chart
    assert (chart.described.beside, words_beside(page)) == ((), ["", ""])
    choose(page, "walk 2")
    other = walks_alone(analysis, session.recordings)["walk 2"]
    assert [curve.side for curve in chart.described.beside] == list(Side)
    for curve in chart.described.beside:
        assert np.allclose(curve.angle_deg, other.cycle(Joint(f"{curve.side}_knee")).mean)
    assert words_beside(page) == ["Thin line: B AFO.", "Thin line: B AFO."]
    assert "Thin line: B AFO." in chart.accessibleDescription()
    assert (chart.described.band, page.band_words) == (None, "")
    choose(page, Beside.BAND)
    assert (chart.described.beside, words_beside(page)) == ((), ["", ""])
    assert page.band_words


def test_single_strides_are_chosen_without_another_walk(page: ResultPage) -> None:
    choose(page, "walk 2")
    page.view.choose(STRIDES)
    assert page.cycles.charts.knee.chart.described.beside == ()
    assert words_beside(page) == ["", ""]


def test_the_table_and_the_key_figures_show_the_change_with_its_verdict(
    page: ResultPage, analysis: Analysis, session: Session
) -> None:
    choose(page, "walk 2")
    alone = walks_alone(analysis, session.recordings)
    found = beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True)
    speed = next(row for row in found.rows if row.measure.column == "speed_m_s")
    assert speed.exceeds  # 0.8 m/s is far off
    assert {found.error_kind(part) for part in found.others} == {ComparisonKind.ATTACHED}
    (reported,) = (figure for figure in page.key_figures.figures if figure.name == "Walking speed")
    assert reported.note == f"+{speed.difference.difference:.2f} ○\u00a0beyond error"
    assert reported.words.endswith("versus B AFO.")
    (first,) = (row for row in page.differs.table.cells.rows if row.cells[1].words == "Walking speed, m/s")
    assert first.cells[4].words == f"+{speed.difference.difference:.2f}"
    assert first.cells[-1].words == "○\N{NO-BREAK SPACE}beyond error"
    choose(page, Beside.BAND)
    (reported,) = (figure for figure in page.key_figures.figures if figure.name == "Walking speed")
    assert "error" not in reported.note


def test_a_key_figure_is_reported_from_the_others_in_every_language(page: ResultPage, analysis: Analysis) -> None:
    alone = walks_alone(analysis, ())
    found = beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True)
    reported = key_figures_beside(page.key_figures.figures, found)
    same_name = key_figures_beside([replace(one, name="?") for one in page.key_figures.figures], found)
    assert [one.note for one in same_name] == [one.note for one in reported]
    assert len({one.note for one in reported}) == len(reported) == 3


def test_the_marks_are_those_of_the_change(page: ResultPage, analysis: Analysis, session: Session) -> None:
    choose(page, "walk 2")
    alone = walks_alone(analysis, session.recordings)
    marked = changes_on_curves(beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True))
    shown = [*page.cycles.charts.knee.chart.deviations, *page.cycles.charts.ankle.chart.deviations]
    assert [one.words for one in shown] == [one.words for one in marked]
    assert all(one.more.endswith("than B AFO") for one in marked)
    same = beside_walk(alone["walk 1"], replace(alone["walk 1"], name="again"), is_simulated=True)
    assert changes_on_curves(same) == []


@pytest.mark.parametrize(
    ("typed", "title", "head"),
    [
        ("AFO", "Versus B AFO", "B AFO"),
        ("AFO with a carbon spring and a wedge", "Versus B AFO with a carbon spring…", "B AFO with a carbon…"),
    ],
)
def test_a_long_name_is_cut_in_the_table_and_whole_where_it_is_read_aloud(
    page: ResultPage, analysis: Analysis, session: Session, typed: str, title: str, head: str
) -> None:
    page.show_visit(AnalysedVisit(with_conditions(session, walk_1="shoes", walk_2=typed), analysis))
    choose(page, "walk 2")
    alone = walks_alone(analysis, with_conditions(session, walk_1="shoes", walk_2=typed).recordings)
    heads = [column.head for column in beside_columns(beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True))]
    assert (heads[1].words, heads[3].words) == (title, head)
    assert (heads[1].stated, heads[3].stated) == (f"Versus B {typed}", f"B {typed}")
    settle()
    assert page.minimumSizeHint().width() <= page.width()


def test_a_not_reported_joint_has_no_thin_curve_and_no_difference(
    page: ResultPage, analysis: Analysis, session: Session
) -> None:
    gated = recalibrated(analysis, [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(11.0))
    page.show_visit(AnalysedVisit(session, gated))
    choose(page, "walk 2")
    knee, ankle = page.cycles.charts.frames
    assert [curve.side for curve in knee.chart.described.beside] == [Side.RIGHT]
    assert words_beside(page) == ["Thin line: B AFO. L: not reported in B AFO.", "Thin line: B AFO."]
    assert [curve.side for curve in ankle.chart.described.beside] == list(Side)
    alone = walks_alone(gated, session.recordings)
    found = beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True)
    assert not any(row.is_reported for row in found.rows if row.measure.kind == "knee" and row.side is Side.LEFT)


def test_without_a_common_zero_shapes_are_laid_over_one_another_and_that_is_stated(
    page: ResultPage, analysis: Analysis, session: Session
) -> None:
    choose(page, Beside.LAST_VISIT)
    other = recalibrated(analysis, [Joint.LEFT_KNEE], zero=ZeroKind.GONIOMETER)
    give_visits(
        page,
        [WalkedVisit("2026-06-20", other, session.recordings), WalkedVisit("2026-11-14", analysis, session.recordings)],
    )
    knee, ankle = words_beside(page)
    assert knee == (
        "Thin line: 2026-06-20. No common standing reference: compare range of motion and curve "
        "shape, not absolute angles."
    )
    assert ankle == "Thin line: 2026-06-20."
    assert page.cycles.charts.knee.chart.is_about_mean
    for curve in page.cycles.charts.knee.chart.described.beside:
        assert np.mean(curve.angle_deg) == pytest.approx(0.0, abs=1e-9)


def test_the_last_visit_is_asked_for_once_and_judged_as_between_visits(
    qtbot: QtBot, page: ResultPage, analysis: Analysis, session: Session
) -> None:
    with qtbot.waitSignal(page.compare.visits_requested):
        choose(page, Beside.LAST_VISIT)
    assert words_beside(page) == ["Reading earlier visits."] * 2
    with qtbot.assertNotEmitted(page.compare.visits_requested):
        choose(page, Beside.BAND)
        choose(page, Beside.LAST_VISIT)
    older = with_conditions(session, walk_1="AFO", walk_2="shoes")
    visits = [
        WalkedVisit("2026-05-01", analysis, session.recordings),
        WalkedVisit("2026-06-20", analysis, older.recordings),
        WalkedVisit("2026-11-14", analysis, session.recordings),
    ]
    give_visits(page, visits)
    assert words_beside(page) == ["Thin line: 2026-06-20."] * 2
    shown = walks_alone(analysis, session.recordings)["walk 1"]
    found = beside_last_visit(shown, "shoes", visits_by_condition(visits), is_simulated=True)
    assert found is not None
    assert [walk.name for walk in found.against.walks] == ["walk 2"]  # what was walked in shoes then
    assert {found.error_kind(part) for part in found.others} == {ComparisonKind.VISITS}


def test_a_condition_that_no_earlier_visit_has_is_beside_nothing(
    page: ResultPage, analysis: Analysis, session: Session
) -> None:
    choose(page, Beside.LAST_VISIT)
    older = with_conditions(session, walk_1="stick", walk_2="AFO")
    give_visits(
        page, [WalkedVisit("June", analysis, older.recordings), WalkedVisit("July", analysis, session.recordings)]
    )
    assert words_beside(page) == ["No earlier visit has a walk in this condition."] * 2
    assert page.cycles.charts.knee.chart.described.beside == ()
    show(page, "walk 2")
    assert words_beside(page) == ["Thin line: June."] * 2


def test_the_sentence_is_of_what_is_beside_and_never_of_the_legs(page: ResultPage) -> None:
    of_legs = page.answer.text
    choose(page, "walk 2")
    assert page.answer.text.startswith(
        "Right: stride length is 1.28\N{NO-BREAK SPACE}m in this walk, 0.26\N{NO-BREAK SPACE}m more than in B AFO ("
    )
    likely = "Likely between 0.19 and 0.32\N{NO-BREAK SPACE}m."  # 0.26 -+ 1.96 sqrt(2) 0.022, and chance
    assert f"{likely} Of this, about 0.23\N{NO-BREAK SPACE}m goes with walking 0.39 m/s faster." in page.answer.text
    assert of_legs not in page.answer.text
    show(page, "walk 2")
    choose(page, "walk 1")
    assert page.answer.text.startswith(
        "Right: stride length is 1.02\N{NO-BREAK SPACE}m in this walk, 0.26\N{NO-BREAK SPACE}m less than in"
    )
    show(page, "walk 1")
    choose(page, Beside.BAND)
    assert page.answer.text == of_legs


def reported(found: Comparison, **changed: float | bool | Judgement) -> str:
    """The answer when every difference that is reported is changed so."""
    rows = [
        replace(row, difference=replace(row.difference, **changed)) if row.is_reported else row  # type: ignore[arg-type] # of any field
        for row in found.rows
    ]
    vars(found)["rows"] = tuple(rows)
    answer = answer_beside(found)
    return " ".join(filter(None, [answer.first, answer.then]))


def test_where_no_change_can_be_reported_as_one_that_is_stated(analysis: Analysis, session: Session) -> None:
    alone = walks_alone(analysis, session.recordings)

    def found() -> Comparison:
        return beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True)

    inside, beyond = Judgement.INSIDE_ERROR, Judgement.EXCEEDS_ERROR
    none = (
        "All judged changes from B AFO are within measurement error. Largest: right "
        "stride length +0.26\N{NO-BREAK SPACE}m, likely +0.19 to +0.32."
    )
    assert reported(found(), judgement=inside, is_worth_a_sentence=False) == none
    near = (
        "Some changes from B AFO are beyond measurement error, but none clearly so. The table "
        "marks these changes. Largest: right stride length +0.26\N{NO-BREAK SPACE}m, likely +0.19 to +0.32."
    )
    assert reported(found(), judgement=beyond, is_worth_a_sentence=False) == near
    nothing = "Nothing can be compared with B AFO."
    assert reported(found(), judgement=Judgement.TOO_FEW_STRIDES, is_worth_a_sentence=False) == nothing


def test_a_figure_is_subtracted_before_it_is_rounded(analysis: Analysis, session: Session) -> None:
    """Where 1.18 less 0.80 would be reported as 0.39, all three have a decimal more."""
    alone = walks_alone(analysis, session.recordings)
    found = beside_walk(alone["walk 1"], alone["walk 2"], is_simulated=True)
    (speed,) = (row for row in found.rows if row.measure.column == "speed_m_s")

    def first(value: float, other: float) -> str:
        row = replace(
            speed,
            value=replace(speed.value, mean=value),
            other=replace(speed.other, mean=other),
            difference=replace(speed.difference, difference=value - other),
        )
        vars(found)["rows"] = (row,)
        return answer_beside(found).first.replace("\N{NO-BREAK SPACE}", " ")

    assert first(1.184, 0.796) == "Walking speed is 1.184 m/s in this walk, 0.388 m/s more than in B AFO (0.796 m/s)."
    assert first(1.19, 0.80) == "Walking speed is 1.19 m/s in this walk, 0.39 m/s more than in B AFO (0.80 m/s)."


def test_a_leg_that_the_other_walk_has_not_measured_is_named(
    page: ResultPage, analysis: Analysis, session: Session
) -> None:
    walk = next(one for one in analysis.recordings if one.name == "walk 2")
    gait = walk.gait[Side.LEFT]
    cycles = dict(gait.cycles)
    del cycles[Joint.LEFT_KNEE]
    bare = replace(walk, gait={**walk.gait, Side.LEFT: replace(gait, cycles=cycles)})
    recordings = tuple(bare if one is walk else one for one in analysis.recordings)
    page.show_visit(AnalysedVisit(session, replace(analysis, recordings=recordings)))
    choose(page, "walk 2")
    assert words_beside(page) == ["Thin line: B AFO. L: not measured in B AFO.", "Thin line: B AFO."]

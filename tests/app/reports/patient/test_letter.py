"""The patient letter: one number, plain, short, true, and in the language that was asked for."""

import datetime
import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import product
from uuid import UUID

import numpy as np
import pypdf
import pytest
from syrupy.assertion import SnapshotAssertion

from app.reports.patient import letter as module
from app.reports.patient.document import report_data
from app.reports.patient.letter import letter_data, make_letter
from app.summary.course import course_of
from app.summary.course_lanes import CourseVisit
from app.summary.request import AnalysedVisit, ReportRequest
from app.wording.translation import spoken_in
from core.alignment import AlignmentChange
from core.body import Joint
from core.goals import Goal, GoalOf
from core.parameters import KNEE, SPEED
from core.results import Analysis
from tests.app.changed_analysis import recalibrated, with_few_strides
from tests.app.course_material import course, unsure, walked

MOST_WORDS = 15  # a sentence is shorter
NO_WORDS_OF = ("better", "worse", "normal", "improve", "besser", "schlechter", "verbesser")
TODAY, FIRST, AGREED = datetime.date(2026, 11, 23), datetime.date(2026, 9, 2), datetime.date(2026, 9, 30)
KNEE_DEG = 61  # of the demonstration's left leg


def of(
    request: ReportRequest,
    *goals: Goal,
    first_deg: float | None = None,
    first_speed: float = 0.8,
    day: datetime.date = FIRST,
    knee_sd_deg: float | None = None,
) -> ReportRequest:
    """Of today, with an earlier visit whose left knee bent so far."""
    session = replace(request.visit.session, started=f"{TODAY}T09:00:00+01:00")
    session = replace(session, patient=replace(session.patient, goals=goals, prosthetic_side="none"))
    analysis = request.visit.analysis
    if knee_sd_deg is not None:
        analysis = recalibrated(analysis, [Joint.LEFT_KNEE], axis_sd_rad=float(np.deg2rad(knee_sd_deg)))
    seen = _visits(session.recordings, analysis, first_deg, first_speed, day) if first_deg is not None else ()
    return replace(request, visit=AnalysedVisit(session, analysis), course=seen)


def _visits(
    recordings: object, analysis: Analysis, knee_deg: float, speed_m_s: float, day: datetime.date
) -> tuple[CourseVisit, ...]:
    before = course((walked(knee_deg=knee_deg, speed_m_s=speed_m_s), ""))
    now = course_of(analysis, recordings)  # type: ignore[arg-type]  # the recordings of a session
    days = (day, before), (TODAY, now)
    return tuple(CourseVisit(UUID(int=k), at, one) for k, (at, one) in enumerate(days))


def words(data: Mapping[str, object]) -> str:
    beside, texts = data["beside"], data["texts"]
    assert isinstance(beside, list)
    assert isinstance(texts, list)
    every = [data["number"], *beside, f"{data['bar_title']}.", *(text for _, text in texts)]
    return " ".join(map(str, every)).replace("\N{NO-BREAK SPACE}", " ")


def knee_goal(value: float) -> Goal:
    return Goal(KNEE, GoalOf.LEFT, value, AGREED)


def test_a_change_and_a_goal_are_stated_by_their_error(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    """The goal is reached or missed only by more than the error."""

    def stated(*goals: Goal, first_deg: float | None = None, day: datetime.date = FIRST) -> str:
        return words(letter_data(of(demo, *goals, first_deg=first_deg, day=day), "en"))

    found = {
        "a change beyond the error": stated(first_deg=31.0),
        "a change within the error": stated(first_deg=57.0),
        "a first visit": stated(),
        "an earlier visit of the same month, by its day": stated(first_deg=31.0, day=datetime.date(2026, 11, 3)),
        "an earlier visit of another year, by its year": stated(first_deg=31.0, day=datetime.date(2025, 11, 3)),
        "a goal reached": stated(knee_goal(45.0)),
        "a goal just reached": stated(knee_goal(60.0)),
        "a goal just missed": stated(knee_goal(63.0)),
        "a goal missed": stated(knee_goal(80.0)),
    }
    assert found == snapshot
    assert "larger than" not in found["a change within the error"]
    assert not re.search(r"\bnow\b|\bchange\b|\bthan\b", found["a first visit"])
    assert not any("goal" in one for name, one in found.items() if "a goal" not in name)


def test_what_returns_to_an_alignment_is_compared_with_that_alignment(demo: ReportRequest) -> None:
    request = of(demo, first_deg=31.0)
    again = AlignmentChange("Alignment B", (), returns_to="Alignment A")
    recordings = tuple(
        replace(one, condition="Alignment A again", alignment=again) if one.name == demo.shown else one
        for one in request.visit.session.recordings
    )
    session, analysis = replace(request.visit.session, recordings=recordings), request.visit.analysis
    before = course((walked(knee_deg=31.0), "Alignment A"))
    days = (FIRST, before), (TODAY, course_of(analysis, recordings))
    seen = tuple(CourseVisit(UUID(int=k), at, one) for k, (at, one) in enumerate(days))
    stated = words(letter_data(replace(request, visit=AnalysedVisit(session, analysis), course=seen), "en"))
    assert f"Your left knee now bends {KNEE_DEG} degrees. In September it was 31 degrees." in stated


def test_only_with_a_goal_the_bar_has_its_tick(demo: ReportRequest) -> None:
    without, with_goal = (str(letter_data(of(demo, *one), "en")["bar"]) for one in ((), (knee_goal(80.0),)))
    assert "Goal" not in without
    assert "Goal 80" in with_goal


@pytest.mark.parametrize("sd_deg", [8.0, 11.0])
def test_a_knee_that_is_not_read_without_care_leaves_the_speed_as_the_number(
    demo: ReportRequest, sd_deg: float
) -> None:
    stated = words(letter_data(of(demo, knee_goal(80.0), first_deg=31.0, knee_sd_deg=sd_deg), "en"))
    assert "You now walk 1.2 metres in a second. In September it was 0.8 metres in a second." in stated
    assert "degrees" not in stated


def test_a_first_visit_whose_knee_was_not_reported_is_not_compared_with(demo: ReportRequest) -> None:
    request = of(demo, first_deg=31.0)
    reported = unsure(Joint.LEFT_KNEE)
    before = course((walked(knee_deg=31.0, speed_m_s=0.8, reported=reported), ""), reported=reported)
    stated = words(
        letter_data(replace(request, course=(replace(request.course[0], course=before), request.course[1])), "en")
    )
    assert f"Your left knee bends {KNEE_DEG} degrees." in stated
    assert "it was" not in stated
    assert "first measurement" not in stated


def test_where_nothing_is_read_without_care_the_letter_has_no_number(demo: ReportRequest) -> None:
    request = of(demo, knee_goal(80.0), knee_sd_deg=11.0)
    few = with_few_strides(request.visit.analysis, left=2, right=2)
    data = letter_data(replace(request, visit=replace(request.visit, analysis=few)), "en")
    assert data["picture"] is None
    assert words(data).startswith("Today's measurement gave no number. The measurement was not good enough.")
    assert not re.search(r"\d", words(data))


def test_the_speed_beside_the_knee_has_no_number_of_its_own(demo: ReportRequest) -> None:
    goal = Goal(SPEED, GoalOf.WALK, 0.9, AGREED)
    texts = letter_data(of(demo, goal, first_deg=31.0), "en")["texts"]
    assert texts[1] == [  # type: ignore[index]  # it is a list of pairs
        "Your walking speed",
        "You also walk faster than in September. You have reached your goal for walking speed.",
    ]


def _every(request: ReportRequest) -> Iterator[ReportRequest]:
    goals = (
        (),
        (knee_goal(45.0), Goal(SPEED, GoalOf.WALK, 0.9, AGREED)),
        (knee_goal(80.0), Goal(SPEED, GoalOf.WALK, 1.9, AGREED)),
    )
    earlier = ((None, FIRST), *product((31.0, 57.0), (FIRST, TODAY)))
    for agreed, (first, day), sd in product(goals, earlier, (None, 11.0)):
        yield of(request, *agreed, first_deg=first, first_speed=1.2, day=day, knee_sd_deg=sd)


def test_every_sentence_is_short_and_judges_nobody(demo: ReportRequest) -> None:
    for request, language in product(_every(demo), ("en", "de")):
        stated = words(letter_data(request, language))
        for sentence in re.split(r"(?<=[.?!])\s(?!\w+ \d{4})", stated):
            assert len(sentence.split()) < MOST_WORDS, sentence
        assert not any(word in stated.lower() for word in NO_WORDS_OF)


def test_every_message_is_short_in_every_language() -> None:
    found = [value for name, value in vars(module).items() if name.isupper()]
    messages = [one for value in found for one in (value.values() if isinstance(value, dict) else [value])]
    messages = [one for one in messages if isinstance(one, str)]
    assert len(messages) > 25
    for message, language in product(messages, ("en", "de")):
        for sentence in re.split(r"(?<=[.?!])\s", spoken_in(language)(message)):
            assert len(sentence.split()) < MOST_WORDS, sentence


def test_german_is_stated_in_german_and_with_its_comma(demo: ReportRequest) -> None:
    data = letter_data(of(demo, first_deg=31.0, knee_sd_deg=11.0), "de")
    assert "Sie gehen jetzt 1,2 Meter in einer Sekunde. Im September waren es 0,8 Meter in einer Sekunde." in words(
        data
    )
    knee = words(letter_data(of(demo, knee_goal(80.0), first_deg=31.0), "de"))
    assert f"Ihr linkes Knie beugt sich jetzt um {KNEE_DEG} Grad. Im September waren es 31 Grad." in knee
    assert "19 Grad fehlen bis zum vereinbarten Ziel." in knee
    assert not re.search(r"\b(the|your|bends|degrees)\b", knee)


def test_the_letter_is_one_page_and_the_report_has_none_of_it(demo: ReportRequest) -> None:
    request = of(demo, knee_goal(80.0), first_deg=31.0)
    for paper in ("a4", "letter"):
        (page,) = pypdf.PdfReader(io.BytesIO(make_letter(replace(request, paper=paper), "en"))).pages
        text = " ".join(page.extract_text().split())
        for part in ("Your left knee now bends", "SIMULATED DATA, not a person", "Questions?", "What we agreed"):
            assert part in text
    assert "Your left knee now bends" not in str(report_data(request))

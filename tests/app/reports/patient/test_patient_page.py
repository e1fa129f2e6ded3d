"""The page for the patient: plain, short, true, and in the language that was asked for."""

import datetime
import re
from dataclasses import replace
from uuid import UUID

import numpy as np
import pytest

from app.reports.patient import patient_page as module
from app.reports.patient.document import facts_of, report_data
from app.reports.patient.patient_page import patient_page
from app.summary.course import course_of
from app.summary.course_lanes import CourseVisit
from app.summary.request import AnalysedVisit, ReportRequest
from app.wording.translation import spoken_in
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from core.parameters import KNEE
from core.results import Analysis
from tests.app.changed_analysis import recalibrated
from tests.app.course_material import course, unsure, walked
from tests.app.reports.patient.test_what_stands_out import with_more

LONGEST_SENTENCE = 20  # words
NO_WORDS_OF = ("better", "worse", "normal", "improve", "besser", "schlechter", "normal", "verbesser")


def with_course(
    request: ReportRequest, knee_deg: float, analysis: Analysis | None = None, *, is_not_reported: bool = False
) -> ReportRequest:
    """With an earlier visit whose left knee bent so far, and this one."""
    found = analysis or request.visit.analysis
    reported = unsure(Joint.LEFT_KNEE) if is_not_reported else None
    before = course((walked(knee_deg=knee_deg, speed_m_s=0.8, reported=reported), ""), reported=reported)
    now = course_of(found, request.visit.session.recordings)
    days = datetime.date(2026, 9, 2), datetime.date(2026, 11, 23)
    seen = tuple(
        CourseVisit(UUID(int=k), day, one) for k, (day, one) in enumerate(zip(days, (before, now), strict=True))
    )
    visit = AnalysedVisit(request.visit.session, found)
    return replace(request, visit=visit, course=seen, patient_language=request.patient_language or "en")


def stated(request: ReportRequest) -> str:
    page = patient_page(request, facts_of(request))
    texts, figures = page["texts"], page["figures"]
    assert isinstance(texts, list)
    assert isinstance(figures, list)
    words = [page[name] for name in ("title", "question", "answer")]
    words += [one for text in texts for one in text] + [figure["label"] for figure in figures]
    return " ".join(map(str, words))


def english(request: ReportRequest) -> ReportRequest:
    return replace(request, patient_language="en")


def test_a_real_change_is_called_one_and_the_numbers_subtract(request_of_demonstration: ReportRequest) -> None:
    found = stated(with_course(request_of_demonstration, 31.0))
    match = re.search(r"Your left knee now bends (\d+) degrees\. At your first visit it was 31\.", found)
    assert match
    assert f"Your knee now bends {int(match[1]) - 31}° more than at the first visit." in found
    assert "this is a real change" in found
    assert "First visit, 2 September" in found
    assert "At the first visit it was 0.8." in found
    assert "their knees bend a little more by themselves" in found


def test_a_change_inside_the_error_is_not(request_of_demonstration: ReportRequest) -> None:
    found = stated(with_course(request_of_demonstration, 57.0))
    assert "So we cannot say that it has changed." in found
    assert "real change" not in found


def test_without_an_earlier_visit_nothing_is_stated_of_one(request_of_demonstration: ReportRequest) -> None:
    for request in (
        english(request_of_demonstration),
        with_course(request_of_demonstration, 31.0, is_not_reported=True),
    ):
        found = stated(request)
        assert "first visit" not in found.lower()
        assert re.search(r"Your left knee bends \d+ degrees\.", found)
        assert "You walk 1.2 metres in a second." in found


def test_the_knees_differ_only_beyond_the_error(request_of_demonstration: ReportRequest) -> None:
    assert "So we cannot say that your knees differ." in stated(english(request_of_demonstration))
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_stance_to_swing_rad", -25.0)
    visit = AnalysedVisit(request_of_demonstration.visit.session, analysis)
    assert "So your knees clearly differ." in stated(english(replace(request_of_demonstration, visit=visit)))


@pytest.mark.parametrize("sd_deg", [8.0, 11.0])
def test_what_is_not_read_without_care_is_no_number(request_of_demonstration: ReportRequest, sd_deg: float) -> None:
    analysis = recalibrated(
        request_of_demonstration.visit.analysis, [Joint.LEFT_KNEE], axis_sd_rad=float(np.deg2rad(sd_deg))
    )
    visit = AnalysedVisit(request_of_demonstration.visit.session, analysis)
    found = stated(english(replace(request_of_demonstration, visit=visit)))
    assert "Today's measurement was not good enough to give a number. This does not reflect how you walk." in found
    assert not re.search(r"\d+ degrees", found)


def test_german_is_stated_in_german_and_with_its_comma(request_of_demonstration: ReportRequest) -> None:
    request = with_course(replace(request_of_demonstration, patient_language="de"), 31.0)
    found = stated(request)
    assert re.search(r"Ihr linkes Knie beugt sich jetzt um \d+ Grad\. Beim ersten Besuch waren es 31\.", found)
    assert "Sie gehen jetzt 1,2 Meter in einer Sekunde. Beim ersten Besuch waren es 0,8." in found
    assert "Erster Besuch, 2. September" in found
    assert not re.search(r"\b(the|your|bends|degrees)\b", found)


@pytest.mark.parametrize("language", ["en", "de"])
def test_sentences_are_short_and_judge_nobody(request_of_demonstration: ReportRequest, language: str) -> None:
    messages = [value for name, value in vars(module).items() if name.isupper() and isinstance(value, str)]
    assert len(messages) > 15
    for message in map(spoken_in(language), messages):
        for sentence in re.split(r"(?<=[.?!])\s", message):
            assert len(sentence.split()) < LONGEST_SENTENCE, sentence
        assert not any(word in message.lower() for word in NO_WORDS_OF)


def test_the_page_is_added_where_a_language_was_chosen(request_of_demonstration: ReportRequest) -> None:
    kinds = [page[0]["kind"] for page in report_data(english(request_of_demonstration))["pages"]]
    assert kinds[-1] == "patient"
    assert "patient" not in [page[0]["kind"] for page in report_data(request_of_demonstration)["pages"]]


def goals_on_page(request: ReportRequest, *goals: Goal, is_not_reported: bool = False) -> list[str]:
    session = replace(request.visit.session, started="2026-11-23T09:00:00+01:00")
    reported = replace(session, patient=replace(session.patient, goals=goals))
    found = request.visit.analysis
    if is_not_reported:
        found = recalibrated(found, (Joint.LEFT_KNEE,), axis_sd_rad=None)
    asked = replace(request, visit=AnalysedVisit(reported, found))
    page = patient_page(asked, facts_of(asked))["goals"]
    assert isinstance(page, list)
    return [str(one) for one in page]


def test_what_was_agreed_is_stated_plainly_and_reached_only_where_it_is_by_more_than_the_error(
    request_of_demonstration: ReportRequest,
) -> None:
    """The demonstration's left knee bends by 61 degrees."""
    day = datetime.date(2026, 9, 30)
    low, near = (Goal(KNEE, GoalOf.LEFT, value, day) for value in (50.0, 60.0))
    words = "Bend of your left knee: at least 50 degrees. We agreed this on 30 September."
    request = english(request_of_demonstration)
    assert goals_on_page(request, low) == [f"{words} You have reached this goal."]
    assert goals_on_page(request, low, is_not_reported=True) == [words]
    assert goals_on_page(request, replace(low, agreed=datetime.date(2026, 11, 23))) == [
        words.replace("30 September", "23 November")
    ]
    assert goals_on_page(request, near) == [words.replace("50", "60")]
    stance = Goal("stance_percent", GoalOf.LEFT, 60.0, day)
    assert goals_on_page(request, stance) == []  # the page gives nothing of it
    german = replace(request_of_demonstration, patient_language="de")
    speed = Goal("speed_m_s", GoalOf.WALK, 1.5, day)
    assert goals_on_page(german, speed) == [
        "Gehgeschwindigkeit: mindestens 1,5 Meter in einer Sekunde. Das haben wir am 30. September vereinbart."
    ]

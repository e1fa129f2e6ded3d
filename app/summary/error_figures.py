"""Words that name the figures in use: which the measurement error rests on."""

from typing import Any

from app.summary.report_dates import day
from app.wording.translation import tr
from core.verdicts.sigmas import OwnStudy, in_use


def error_figures_in_words() -> str:
    """As "Error figures: own study, 20 people, 12 Nov 2026.", or that they are published."""
    study = in_use().study
    return tr("Error figures: published.") if study is None else study_in_words(study)


def study_in_words(study: OwnStudy) -> str:
    if not study.day:
        return tr("Error figures: own study, {count} people.").format(count=study.people)
    reported = tr("Error figures: own study, {count} people, {day}.")
    return reported.format(count=study.people, day=day(study.day))


def error_figures_in_json() -> dict[str, Any]:
    """The same for `summary.json`."""
    study = in_use().study
    if study is None:
        return {"source": "published"}
    return {"source": "own_study", "people": study.people, "day": study.day}

"""Averages in a form that a hospital's system reads. A FHIR R4 Bundle of Observations, one per figure of summary.json.

A figure that is to be read with care, or that fewer than ten strides made, is preliminary and states why. One that is
not reported has no value and its reason in place of it; nothing is ever called high, low or normal. Goals are Goals.
Our figures have no codes of their own in LOINC or SNOMED CT that say how they were measured, so each is coded by its
column's name; sides are coded. Simulated figures carry the label that HL7 gives to test data.
"""

import datetime
import json
import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from app.exports.figures import SIMULATED, WalkFigure, reason_of, software, unit_of, walk_figures
from app.storage.pseudonyms import AGE
from app.summary.agreed import agreed_with
from app.summary.comparison import compare_legs, first_and_second
from app.summary.conditions import conditions_of
from app.summary.differences import likely_figures
from app.wording.measures import goal_in_words
from app.wording.prostheses import prosthesis_words
from app.wording.translation import PURPOSE, capitalised
from app.wording.verdicts import gate_sentence
from core.body import Side
from core.goals import Goal
from core.parameters import BETWEEN_LEGS
from core.results import Analysis
from core.session import Session
from core.verdicts.model import Verdict

PARAMETERS = "urn:x-gaitwright:parameter"
CODES = "urn:x-gaitwright:patient"
UCUM = "http://unitsofmeasure.org"
UCUM_OF = {"°": "deg", "%": "%", "s": "s", "m": "m", "m/s": "m/s", "steps/min": "/min"}
SNOMED = "http://snomed.info/sct"
LEG = {"system": SNOMED, "code": "61685007", "display": "Lower limb structure"}
SIDES = {
    Side.LEFT: {"system": SNOMED, "code": "7771000", "display": "Left"},
    Side.RIGHT: {"system": SNOMED, "code": "24028007", "display": "Right"},
}
CATEGORY = "http://terminology.hl7.org/CodeSystem/observation-category"
ACTIVITY = [{"coding": [{"system": CATEGORY, "code": "activity", "display": "Activity"}]}]
TEST_DATA = {
    "system": "http://terminology.hl7.org/CodeSystem/v3-ActReason",
    "code": "HTEST",
    "display": "test health data",
}
ABSENT = "http://terminology.hl7.org/CodeSystem/data-absent-reason"
NOT_REPORTED = {"system": ABSENT, "code": "error", "display": "Error"}
NOT_PERFORMED = {"system": ABSENT, "code": "not-performed", "display": "Not Performed"}
SPREAD = "standard deviation between strides"
ERROR = "half of what the difference of two walks with the sensors left on has to exceed (95 %)"
YEARS_OLD = {"system": "http://loinc.org", "code": "30525-0", "display": "Age"}
AGE_REPORTED = re.compile(r"(\d{1,3})(\+?)")
GENDERS = ("male", "female", "other")


def write_bundle(session: Session, analysis: Analysis, path: Path) -> None:
    """Write one FHIR Bundle as JSON; raises OSError."""
    text = json.dumps(bundle(session, analysis), indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8", errors="backslashreplace", newline="\n")


def bundle(session: Session, analysis: Analysis) -> dict[str, Any]:
    """Give a collection Bundle: the patient as reported, prostheses, goals agreed, and an Observation per figure."""
    patient_url = _url(session, "patient")
    resources = [(patient_url, _patient(session)), *_age(session, patient_url), *_prostheses(session, patient_url)]
    resources += [(_url(session, "goal", *goal.key), _goal(goal, patient_url)) for goal in agreed_with(session).held]
    conditions = {recording.name: recording.condition for recording in session.recordings}
    started = {recording.name: recording.started or session.started for recording in session.recordings}
    for one in walk_figures(analysis):
        when = _when(started.get(one.walk, ""))
        url = _url(session, one.walk, str(one.side), one.name)
        notes = [*_notes(one.walk, conditions.get(one.walk, "")), *([SIMULATED] if analysis.is_simulated else [])]
        resources.append((url, dict(_observation(one, patient_url, when, notes))))
    resources += _between_legs(session, analysis, patient_url)
    if analysis.is_simulated:
        resources = [(url, {**resource, "meta": {"security": [TEST_DATA]}}) for url, resource in resources]
    return {
        "resourceType": "Bundle",
        "type": "collection",
        "entry": [{"fullUrl": url, "resource": resource} for url, resource in resources],
    }


def _patient(session: Session) -> dict[str, Any]:
    patient = session.patient
    reported: dict[str, Any] = {"resourceType": "Patient"}
    if patient.code.strip():
        reported["identifier"] = [{"system": CODES, "value": patient.code.strip()}]
    if patient.sex in GENDERS:
        reported["gender"] = patient.sex
    if patient.birth_year is not None:
        reported["birthDate"] = f"{patient.birth_year:04d}"
    return reported


def _age(session: Session, patient_url: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """The age at the visit, where it is given in place of the year of birth."""
    reported = str(session.patient.unknown.get(AGE, ""))
    if (found := AGE_REPORTED.fullmatch(reported)) is None:
        return
    value: dict[str, Any] = {"value": int(found[1]), "unit": "years", "system": UCUM, "code": "a"}
    if found[2]:
        value = {"value": value.pop("value"), "comparator": ">=", **value}
    observation = {"resourceType": "Observation", "status": "final", "code": {"coding": [YEARS_OLD], "text": "age"}}
    yield _url(session, "age"), {**observation, "subject": {"reference": patient_url}, "valueQuantity": value}


def _prostheses(session: Session, patient_url: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Each prosthesis as it was stated, a device of the patient."""
    for side, one in session.patient.worn.items():
        text = capitalised(prosthesis_words(side, one))
        device = {"resourceType": "Device", "type": {"text": text}, "patient": {"reference": patient_url}}
        yield _url(session, "prosthesis", str(side)), device


def _goal(goal: Goal, patient_url: str) -> dict[str, Any]:
    """What had been agreed by the session's day. Whether it is reached is left to who reads the figures."""
    unit = unit_of(goal.column)
    code = _code(goal.column, f"{goal.column}, {goal.of}".replace("_", " "))
    limit = {**_quantity(goal.value, unit), "comparator": "<=" if goal.is_at_most else ">="}
    target: dict[str, Any] = {"measure": code, "detailQuantity": limit}
    if goal.until is not None:
        target["dueDate"] = goal.until.isoformat()
    reported: dict[str, Any] = {
        "resourceType": "Goal",
        "lifecycleStatus": "active",
        "description": {"text": goal_in_words(goal)},
        "subject": {"reference": patient_url},
        "startDate": goal.agreed.isoformat(),
        "target": [target],
    }
    if goal.by:
        reported["expressedBy"] = {"display": goal.by}
    if goal.note:
        reported["note"] = [{"text": goal.note}]
    return reported


def _observation(one: WalkFigure, patient_url: str, when: str, notes: list[str]) -> Iterator[tuple[str, Any]]:
    yield "resourceType", "Observation"
    yield "status", _status(one)
    yield "category", ACTIVITY
    yield "code", _code(one.name)
    yield "subject", {"reference": patient_url}
    if when:
        yield "effectiveDateTime", when
    if one.mean is None:
        is_worn = one.assessment.verdict is Verdict.NOT_REPORTED
        why_not = {"coding": [NOT_REPORTED if is_worn else NOT_PERFORMED], "text": reason_of(one.assessment)}
        yield "dataAbsentReason", why_not
    else:
        yield "valueQuantity", _quantity(one.mean, unit_of(one.name))
    doubts = [gate_sentence(reason) for reason in one.assessment.reasons]
    yield "note", [{"text": text} for text in dict.fromkeys([*notes, *doubts])]
    if one.side is not None:
        yield "bodySite", {"coding": [LEG], "text": f"{one.side} leg"}
    yield "device", {"display": software()}
    components: list[dict[str, Any]] = []
    if one.side is not None:
        components.append({"code": _code("side"), "valueCodeableConcept": {"coding": [SIDES[one.side]]}})
    for name, words, value in (("stride_sd", SPREAD, one.average.sd), ("error", ERROR, one.average.error)):
        if math.isfinite(value):
            quantity = _quantity(float(value), unit_of(one.name))
            components.append({"code": _code(name, words), "valueQuantity": quantity})
    if one.strides is not None:
        components.append({"code": _code("strides_used"), "valueInteger": one.strides})
    if components:
        yield "component", components


def _between_legs(session: Session, analysis: Analysis, patient_url: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """One Observation for each measure that the legs of a condition are compared in, with its likely interval."""
    sides = first_and_second(analysis.affected_side)
    for part in conditions_of(analysis, session.recordings, agreed=agreed_with(session)):
        for column in BETWEEN_LEGS if len(part.sides) == len(Side) else ():
            found, unit = compare_legs(part, column, sides), unit_of(column)
            if not found.is_reported:
                continue
            ends = {key: value for key, value in likely_figures(found).items() if math.isfinite(value)}
            components: list[dict[str, Any]] = [
                {"code": _code(key), "valueQuantity": _quantity(value, unit)} for key, value in ends.items()
            ]
            if found.mark:
                components.append({"code": _code("mark"), "valueString": str(found.mark)})
            is_final = all(part.assessment(side, column).verdict is Verdict.READ for side in sides)
            yield (
                _url(session, part.letter, part.name, "legs", column),
                {
                    "resourceType": "Observation",
                    "status": "final" if is_final and found.is_judged else "preliminary",
                    "category": ACTIVITY,
                    "code": _code(f"{column}_difference", f"{column}, {sides[0]} less {sides[1]}".replace("_", " ")),
                    "subject": {"reference": patient_url},
                    **({"effectiveDateTime": when} if (when := _when(session.started)) else {}),
                    "valueQuantity": _quantity(found.difference, unit),
                    "note": [{"text": text} for text in (part.name or part.letter, PURPOSE)]
                    + ([{"text": SIMULATED}] if analysis.is_simulated else []),
                    "device": {"display": software()},
                    **({"component": components} if components else {}),
                },
            )


def _status(one: WalkFigure) -> str:
    """Final only where nothing is in doubt, too few strides included; what was not worn came to nothing."""
    if one.assessment.verdict is Verdict.NOT_MEASURED:
        return "cancelled"
    return "final" if one.assessment.verdict is Verdict.READ else "preliminary"


def _notes(walk: str, condition: str) -> Iterator[str]:
    yield f"{walk}, {condition}" if condition.strip() else walk
    yield PURPOSE


def _code(name: str, words: str = "") -> Mapping[str, Any]:
    return {"coding": [{"system": PARAMETERS, "code": name}], "text": words or name.replace("_", " ")}


def _quantity(value: float, unit: str) -> Mapping[str, Any]:
    return {"value": value, "unit": unit, "system": UCUM, "code": UCUM_OF[unit]}


def _when(started: str) -> str:
    """An instant as FHIR takes it: with a time only where its zone is given."""
    try:
        instant = datetime.datetime.fromisoformat(started)
    except ValueError:
        return ""
    return instant.isoformat(timespec="seconds") if instant.tzinfo else instant.date().isoformat()


def _url(session: Session, *parts: str) -> str:
    """The same name for the same figure at every writing."""
    whole = json.dumps([session.patient.code, session.started, *parts])
    return f"urn:uuid:{uuid5(NAMESPACE_URL, whole)}"

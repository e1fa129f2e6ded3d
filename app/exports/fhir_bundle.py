"""Averages in a form that a hospital's system takes. A FHIR R4 transaction of one Observation per figure.

A figure that is to be read with care, or that fewer than ten strides made, is preliminary and states why. One that is
not reported has no value and its reason in place of it; nothing is ever called high, low or normal. Goals are Goals,
what made the figures is a Device, and a DiagnosticReport holds them together. Simulated figures carry the label that
HL7 gives to test data.

Posted again, figures and prostheses replace what they were: each is looked for by its identifier. A patient whom
the server knows by the code is left as it is.
"""

import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from app.exports.fhir_codes import (
    ACTIVITY,
    LEGS,
    NOT_PERFORMED,
    NOT_REPORTED,
    PATIENTS,
    PHYSICAL_THERAPY,
    SIDES,
    TEST_DATA,
    UCUM,
    URIS,
    YEARS_OLD,
    Resource,
    code_of,
    instant,
    quantity,
    search_of,
    urn,
)
from app.exports.fhir_timed import test_observation
from app.exports.figures import SIMULATED, WalkFigure, reason_of, software, unit_of, walk_figures
from app.exports.folder_pseudonyms import identity_of
from app.exports.timed_csv import timed_walks
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

SPREAD = "standard deviation between strides"
ERROR = "half of what the difference of two walks with the sensors left on has to exceed (95 %)"
AGE_REPORTED = re.compile(r"(\d{1,3})(\+?)")
GENDERS = ("male", "female", "other")
PATIENT, DEVICE = "Patient", "Device"


def write_bundle(session: Session, analysis: Analysis, path: Path) -> None:
    """Write one FHIR Bundle as JSON; raises OSError."""
    text = json.dumps(bundle(session, analysis), indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8", errors="backslashreplace", newline="\n")


def bundle(session: Session, analysis: Analysis) -> Resource:
    """Give a transaction: the patient as reported, device, goals, an Observation per figure, and their report."""
    return _Bundle(session, analysis).transaction()


class _Bundle:
    """The resources of one session, each under a name that is the same at every writing."""

    def __init__(self, session: Session, analysis: Analysis) -> None:
        self._session, self._analysis = session, analysis
        code, started = session.patient.code.strip(), session.started
        # without code or time of day two sessions would have the same names, and the one replace the other
        is_named = code and "T" in started
        self._visit = (code, started) if is_named else (code, started, identity_of(session).hex)
        self._patient_url, self._device_url = self._url("patient"), urn("device", software())
        self._subject = {"subject": {"reference": self._patient_url}}
        self._device = {"device": {"reference": self._device_url, "display": software()}}

    def transaction(self) -> Resource:
        measured = [*self._figures(), *self._between_legs(), *self._tests()]
        observations = [*self._age(), *measured]
        goals = [(self._url("goal", *one.key), self._goal(one)) for one in agreed_with(self._session).held]
        resources = [(self._patient_url, self._patient()), (self._device_url, self._software())]
        resources += [*self._prostheses(), *goals, *observations]
        if measured:
            resources.append((self._url("report"), self._report(observations)))
        return {
            "resourceType": "Bundle",
            "type": "transaction",
            "entry": [self._entry(url, resource) for url, resource in resources],
        }

    def _url(self, *parts: str) -> str:
        return urn(*self._visit, *parts)

    def _entry(self, url: str, resource: Resource) -> Resource:
        kind = resource["resourceType"]
        resource.setdefault("identifier", [{"system": URIS, "value": url}])
        if self._analysis.is_simulated:
            resource["meta"] = {"security": [TEST_DATA]}
        known = search_of(resource["identifier"][0])
        request = {"method": "PUT", "url": f"{kind}?{known}"}
        if url in (self._patient_url, self._device_url):
            request = {"method": "POST", "url": kind, "ifNoneExist": known}
        return {"fullUrl": url, "resource": resource, "request": request}

    def _patient(self) -> Resource:
        patient = self._session.patient
        reported: Resource = {"resourceType": PATIENT}
        if patient.code.strip():
            reported["identifier"] = [{"system": PATIENTS, "value": patient.code.strip()}]
        if patient.sex in GENDERS:
            reported["gender"] = patient.sex
        if patient.birth_year is not None:
            reported["birthDate"] = f"{patient.birth_year:04d}"
        return reported

    def _software(self) -> Resource:
        name, _, number = software().partition(" ")
        return {
            "resourceType": DEVICE,
            "status": "active",
            "deviceName": [{"name": name, "type": "user-friendly-name"}],
            "type": {"text": "Software for gait analysis with inertial sensors"},
            **({"version": [{"value": number}]} if number else {}),
            "note": [{"text": PURPOSE}],
        }

    def _report(self, observations: list[tuple[str, Resource]]) -> Resource:
        """All that was measured in the visit; final where every part of it is."""
        measured = [resource["status"] for _, resource in observations if resource["status"] != "cancelled"]
        return {
            "resourceType": "DiagnosticReport",
            "status": "final" if set(measured) <= {"final"} else "preliminary",
            "category": PHYSICAL_THERAPY,
            "code": code_of("gait_analysis", "Gait analysis with inertial sensors"),
            **self._subject,
            **_when(self._session.started),
            "result": [{"reference": url} for url, _ in observations],
        }

    def _age(self) -> Iterator[tuple[str, Resource]]:
        """The age at the visit, where it is given in place of the year of birth."""
        if (found := AGE_REPORTED.fullmatch(str(self._session.patient.unknown.get(AGE, "")))) is None:
            return
        value: Resource = {"value": int(found[1]), "unit": "years", "system": UCUM, "code": "a"}
        if found[2]:
            value = {"value": value.pop("value"), "comparator": ">=", **value}
        code = {"code": {"coding": [YEARS_OLD], "text": "age"}}
        head: Resource = {"resourceType": "Observation", "status": "final", **code, **self._subject}
        yield self._url("age"), {**head, **_when(self._session.started), "valueQuantity": value}

    def _prostheses(self) -> Iterator[tuple[str, Resource]]:
        """Each prosthesis as it was stated, a device of the patient."""
        for side, one in self._session.patient.worn.items():
            text = capitalised(prosthesis_words(side, one))
            device = {"resourceType": DEVICE, "type": {"text": text}, "patient": {"reference": self._patient_url}}
            yield self._url("prosthesis", str(side)), device

    def _goal(self, goal: Goal) -> Resource:
        """What had been agreed by the session's day. Whether it is reached is left to who reads the figures."""
        code = code_of(goal.column, f"{goal.column}, {goal.of}".replace("_", " "))
        limit = {**quantity(goal.value, unit_of(goal.column)), "comparator": "<=" if goal.is_at_most else ">="}
        target: Resource = {"measure": code, "detailQuantity": limit}
        if goal.until is not None:
            target["dueDate"] = goal.until.isoformat()
        reported: Resource = {
            "resourceType": "Goal",
            "lifecycleStatus": "active",
            "description": {"text": goal_in_words(goal)},
            **self._subject,
            "startDate": goal.agreed.isoformat(),
            "target": [target],
        }
        if goal.by:
            reported["expressedBy"] = {"display": goal.by}
        if goal.note:
            reported["note"] = [{"text": goal.note}]
        return reported

    def _figures(self) -> Iterator[tuple[str, Resource]]:
        for one in walk_figures(self._analysis):
            yield self._url(one.walk, str(one.side), one.name), dict(self._figure(one))

    def _figure(self, one: WalkFigure) -> Iterator[tuple[str, Any]]:
        yield "resourceType", "Observation"
        yield "status", _status(one)
        yield "category", ACTIVITY
        yield "code", code_of(one.name, side=one.side)
        yield from self._of_walk(one.walk)
        if one.mean is None:
            is_worn = one.assessment.verdict is Verdict.NOT_REPORTED
            why_not = {"coding": [NOT_REPORTED if is_worn else NOT_PERFORMED], "text": reason_of(one.assessment)}
            yield "dataAbsentReason", why_not
        else:
            yield "valueQuantity", quantity(one.mean, unit_of(one.name))
        doubts = [gate_sentence(reason) for reason in one.assessment.reasons]
        yield "note", self._notes(self._walk_words(one.walk), *doubts)
        if one.side is not None:
            yield "bodySite", {"coding": [LEGS[one.side]], "text": f"{one.side} leg"}
        components: list[Resource] = []
        if one.side is not None:
            components.append({"code": code_of("side"), "valueCodeableConcept": {"coding": [SIDES[one.side]]}})
        for name, words, value in (("stride_sd", SPREAD, one.average.sd), ("error", ERROR, one.average.error)):
            if math.isfinite(value):
                components.append({"code": code_of(name, words), "valueQuantity": quantity(value, unit_of(one.name))})
        if one.strides is not None:
            components.append({"code": code_of("strides_used"), "valueInteger": one.strides})
        if components:
            yield "component", components

    def _of_walk(self, name: str) -> Iterator[tuple[str, Any]]:
        """Of whom, when and by what an Observation of a walk is."""
        started = next((one.started for one in self._session.recordings if one.name == name), "")
        yield from {**self._subject, **_when(started or self._session.started), **self._device}.items()

    def _walk_words(self, name: str) -> str:
        condition = next((one.condition for one in self._session.recordings if one.name == name), "")
        return f"{name}, {condition}" if condition.strip() else name

    def _notes(self, first: str, *more: str) -> list[Resource]:
        simulated = [SIMULATED] if self._analysis.is_simulated else []
        return [{"text": text} for text in dict.fromkeys([first, PURPOSE, *simulated, *more])]

    def _between_legs(self) -> Iterator[tuple[str, Resource]]:
        """One Observation for each measure that the legs of a condition are compared in, with its likely interval."""
        session, sides = self._session, first_and_second(self._analysis.affected_side)
        for part in conditions_of(self._analysis, session.recordings, agreed=agreed_with(session)):
            for column in BETWEEN_LEGS if len(part.sides) == len(Side) else ():
                found, unit = compare_legs(part, column, sides), unit_of(column)
                if not found.is_reported:
                    continue
                ends = {key: value for key, value in likely_figures(found).items() if math.isfinite(value)}
                components: list[Resource] = [
                    {"code": code_of(key), "valueQuantity": quantity(value, unit)} for key, value in ends.items()
                ]
                if found.mark:
                    components.append({"code": code_of("mark"), "valueString": str(found.mark)})
                is_final = all(part.assessment(side, column).verdict is Verdict.READ for side in sides)
                words = f"{column}, {sides[0]} less {sides[1]}".replace("_", " ")
                yield (
                    self._url(part.letter, part.name, "legs", column),
                    {
                        "resourceType": "Observation",
                        "status": "final" if is_final and found.is_judged else "preliminary",
                        "category": ACTIVITY,
                        "code": code_of(f"{column}_difference", words),
                        **self._subject,
                        **_when(session.started),
                        "valueQuantity": quantity(found.difference, unit),
                        "note": self._notes(part.name or part.letter),
                        **self._device,
                        **({"component": components} if components else {}),
                    },
                )

    def _tests(self) -> Iterator[tuple[str, Resource]]:
        """One Observation for each timed test."""
        for walk in timed_walks(self._analysis):
            assert walk.timed is not None
            observation, reasons = test_observation(walk, walk.timed)
            head = {"resourceType": "Observation", "category": ACTIVITY, **dict(self._of_walk(walk.name))}
            notes = {"note": self._notes(self._walk_words(walk.name), *reasons)}
            yield self._url(walk.name, "test"), {**head, **observation, **notes}


def _status(one: WalkFigure) -> str:
    """Final only where nothing is in doubt, too few strides included; what was not worn came to nothing."""
    if one.assessment.verdict is Verdict.NOT_MEASURED:
        return "cancelled"
    return "final" if one.assessment.verdict is Verdict.READ else "preliminary"


def _when(started: str) -> Resource:
    return {"effectiveDateTime": when} if (when := instant(started)) else {}

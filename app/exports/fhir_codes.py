"""Codes, quantities and names that the resources of a FHIR bundle share.

Our figures have no codes of their own in LOINC or SNOMED CT that say how they were measured, so each is coded by its
column's name, of a side with the side before it: who looks for a code alone never mixes left and right. A test has the
code of LOINC where two public sources confirm it.
"""

import datetime
import json
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote
from uuid import NAMESPACE_URL, uuid5

from app.exports.figures import DECIMALS_OF
from core.body import Side
from core.timed.protocols import TimedProtocol

PARAMETERS = "urn:x-gaitwright:parameter"
PATIENTS = "urn:x-gaitwright:patient"
URIS = "urn:ietf:rfc:3986"  # the system of identifiers that are URIs themselves
UCUM = "http://unitsofmeasure.org"
UCUM_OF = {"°": "deg", "%": "%", "s": "s", "m": "m", "m/s": "m/s", "steps/min": "/min"}
SNOMED = "http://snomed.info/sct"
LOINC = "http://loinc.org"
LEGS = {
    Side.LEFT: {"system": SNOMED, "code": "32153003", "display": "Structure of left lower limb"},
    Side.RIGHT: {"system": SNOMED, "code": "62175007", "display": "Structure of right lower limb"},
}
SIDES = {
    Side.LEFT: {"system": SNOMED, "code": "7771000", "display": "Left"},
    Side.RIGHT: {"system": SNOMED, "code": "24028007", "display": "Right"},
}
CATEGORY = "http://terminology.hl7.org/CodeSystem/observation-category"
ACTIVITY = [{"coding": [{"system": CATEGORY, "code": "activity", "display": "Activity"}]}]
SECTION = "http://terminology.hl7.org/CodeSystem/v2-0074"
PHYSICAL_THERAPY = [{"coding": [{"system": SECTION, "code": "PT", "display": "Physical Therapy"}]}]
TEST_DATA = {
    "system": "http://terminology.hl7.org/CodeSystem/v3-ActReason",
    "code": "HTEST",
    "display": "test health data",
}
ABSENT = "http://terminology.hl7.org/CodeSystem/data-absent-reason"
NOT_REPORTED = {"system": ABSENT, "code": "error", "display": "Error"}
NOT_PERFORMED = {"system": ABSENT, "code": "not-performed", "display": "Not Performed"}
YEARS_OLD = {"system": LOINC, "code": "30525-0", "display": "Age"}
# of the others none was found that two sources give; these are in the panel loinc.org/89422-0 and at findacode.com,
# and in the care models of Danish municipalities (KL) and Stanford's My Heart Counts
TESTS = {
    TimedProtocol.UP_AND_GO: {
        "system": LOINC,
        "code": "89423-8",
        "display": "Time to rise from chair, walk 10 feet and back, and return to sitting [TUG]",
    },
    TimedProtocol.SIX_MINUTES: {"system": LOINC, "code": "64098-7", "display": "Six minute walk test"},
}

Resource = dict[str, Any]


def code_of(name: str, words: str = "", side: Side | None = None) -> Mapping[str, Any]:
    """One of our codes; of a side that of the side first, then that of both."""
    names = [name] if side is None else [f"{side}_{name}", name]
    coding = [{"system": PARAMETERS, "code": one} for one in names]
    return {"coding": coding, "text": words or names[0].replace("_", " ")}


def quantity(value: float, unit: str) -> Mapping[str, Any]:
    """A figure with the digits that it can have."""
    return {"value": round(value, DECIMALS_OF[unit]) + 0.0, "unit": unit, "system": UCUM, "code": UCUM_OF[unit]}


def instant(started: str) -> str:
    """An instant as FHIR takes it: with a time only where its zone is given."""
    try:
        moment = datetime.datetime.fromisoformat(started)
    except ValueError:
        return ""
    return moment.isoformat(timespec="seconds") if moment.tzinfo else moment.date().isoformat()


def urn(*parts: str) -> str:
    """The same name for the same figure at every writing."""
    return f"urn:uuid:{uuid5(NAMESPACE_URL, json.dumps(parts))}"


def search_of(identifier: Mapping[str, str]) -> str:
    """What a server is asked for to see whether it has a resource of this identifier."""
    return f"identifier={quote(identifier['system'], safe=':/')}|{quote(identifier['value'], safe=':')}"

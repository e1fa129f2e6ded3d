"""Tests that a FHIR bundle can be posted as it is, again too, and that other programs find it valid."""

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
from fhir.resources.R4B.bundle import Bundle
from syrupy.assertion import SnapshotAssertion

from app.exports.exports import Format, export_from_folder
from app.exports.fhir_bundle import bundle, write_bundle
from core.body import Side
from core.prosthesis import AmputationLevel, Prosthesis
from core.results import RecordingAnalysis
from core.session import Patient, RecordingKind
from core.timed.found import NotMeasured, TimedTest
from core.timed.protocols import TimedProtocol
from core.verdicts.model import GateReason, Verdict, assess
from tests.app.exports.conftest import Visit
from tests.app.exports.test_timed_csv import TWO
from tests.other_programs import ask_node

LOINC = "http://loinc.org"
OURS = "urn:x-gaitwright:parameter"


@pytest.fixture(scope="module")
def coded(visit: Visit) -> Visit:
    session, analysis = visit
    return replace(session, patient=Patient(code="P 17|x&y", sex="female", birth_year=1950)), analysis


def with_tests(visit: Visit, *tests: TimedTest) -> Visit:
    """The walk again and again, each a timed test."""
    session, analysis = visit
    (walk,) = (one for one in analysis.recordings if one.kind is RecordingKind.WALKING)
    walks = tuple(replace(walk, name=f"test {number}", timed=test) for number, test in enumerate(tests))
    return session, replace(analysis, recordings=(*analysis.recordings, *walks))


def resources(found: dict[str, Any], kind: str) -> list[dict[str, Any]]:
    return [one["resource"] for one in found["entry"] if one["resource"]["resourceType"] == kind]


class Server:
    """A server's memory: what the specification has it do with the entries of a transaction, and no more."""

    def __init__(self) -> None:
        self.held: dict[str, dict[str, Any]] = {}

    def post(self, transaction: dict[str, Any]) -> None:
        assert transaction["type"] == "transaction"
        entries = transaction["entry"]
        urls = [one["fullUrl"] for one in entries]
        assert len(set(urls)) == len(urls)
        places = {one["fullUrl"]: self._place(one) for one in entries}
        assert len(set(places.values())) == len(places)  # no two entries are of one resource
        for one in entries:
            place = places[one["fullUrl"]]
            if one["request"]["method"] == "POST" and place in self.held:
                continue  # it exists
            self.held[place] = json.loads(json.dumps(one["resource"]), object_hook=lambda part: _resolved(part, places))

    def _place(self, entry: dict[str, Any]) -> str:
        request, kind = entry["request"], entry["resource"]["resourceType"]
        if request["method"] == "POST":
            url, search = request["url"], request["ifNoneExist"]
        else:
            assert request["method"] == "PUT"
            url, _, search = request["url"].partition("?")
        assert url == kind
        system, value = map(unquote, search.removeprefix("identifier=").split("|"))
        asked = {"system": system, "value": value}
        assert asked in entry["resource"]["identifier"]
        known = [place for place, one in self.held.items() if place.startswith(kind) and asked in one["identifier"]]
        assert len(known) <= 1
        return known[0] if known else f"{kind}/{len(self.held)}-{entry['fullUrl'][-12:]}"


def _resolved(part: dict[str, Any], places: dict[str, str]) -> dict[str, Any]:
    if part.keys() >= {"reference"}:
        assert part["reference"] in places  # it refers to nothing that is elsewhere
        return {**part, "reference": places[part["reference"]]}
    return part


def test_a_bundle_that_is_posted_twice_is_there_once(coded: Visit) -> None:
    server, found = Server(), bundle(*coded)
    server.post(found)
    held = dict(server.held)
    assert len(held) == len(found["entry"]) > 40
    server.post(bundle(*coded))
    assert server.held == held
    (patient,) = (place for place in held if place.startswith("Patient"))
    (device,) = (place for place in held if place.startswith("Device"))
    (report,) = (one for place, one in held.items() if place.startswith("DiagnosticReport"))
    observations = {place for place in held if place.startswith("Observation")}
    assert {one["reference"] for one in report["result"]} == observations
    for place in observations:
        assert held[place]["subject"] == {"reference": patient}
        assert held[place]["device"]["reference"] == device


def test_a_corrected_figure_replaces_what_was_posted_and_a_known_patient_stays(coded: Visit) -> None:
    server = Server()
    session, analysis = coded
    server.held["Patient/7"] = {
        "resourceType": "Patient",
        "identifier": [{"system": "urn:x-gaitwright:patient", "value": "P 17|x&y"}],
        "name": "as the hospital has it",
    }
    server.post(bundle(session, analysis))
    count = len(server.held)
    unsure = assess([GateReason("axis", Verdict.NOT_REPORTED, 12.0, 9.0, "deg")])
    corrected = tuple(
        replace(
            one,
            verdicts=replace(
                one.verdicts, joints={joint: replace(v, shape=unsure) for joint, v in one.verdicts.joints.items()}
            ),
        )
        for one in analysis.recordings
    )
    server.post(bundle(session, replace(analysis, recordings=corrected)))
    assert len(server.held) == count
    assert server.held["Patient/7"]["name"] == "as the hospital has it"
    assert not any("valueQuantity" in one for one in server.held.values() if _is_of(one, "left_knee_range_deg"))


def _is_of(resource: dict[str, Any], code: str) -> bool:
    return any(one.get("code") == code for one in resource.get("code", {}).get("coding", ()))


def test_visits_and_people_never_replace_each_other(visit: Visit) -> None:
    """Also those of whom neither code nor day is known."""
    session, analysis = visit
    nobody = replace(session, patient=Patient(), started="")
    other = replace(nobody, recordings=session.recordings[1:])  # other samples: somebody else
    server = Server()
    for one in (
        replace(session, patient=Patient(code="P-1"), started="2026-11-21T10:00:00+01:00"),
        replace(session, patient=Patient(code="P-1"), started="2026-11-28T10:00:00+01:00"),
        replace(session, patient=Patient(code="P-2"), started="2026-11-28T10:00:00+01:00"),
        nobody,
        other,
    ):
        before = len([place for place in server.held if place.startswith("Observation")])
        found = bundle(one, analysis)
        server.post(found)
        after = len([place for place in server.held if place.startswith("Observation")])
        assert after - before == len(resources(found, "Observation"))
    kinds = [place.split("/")[0] for place in server.held]
    assert (kinds.count("Patient"), kinds.count("DiagnosticReport"), kinds.count("Device")) == (4, 5, 1)


def test_two_visits_of_one_day_without_a_time_never_replace_each_other(coded: Visit) -> None:
    """Imported sessions have a date at most."""
    session, analysis = coded
    server = Server()
    first = replace(session, started="2026-03-09")
    for one in (first, replace(first, recordings=session.recordings[1:])):
        server.post(bundle(one, analysis))
    count = len(server.held)
    assert [place.split("/")[0] for place in server.held].count("DiagnosticReport") == 2
    server.post(bundle(first, analysis))
    assert len(server.held) == count  # again, it is known


def test_a_corrected_prosthesis_replaces_what_was_posted(coded: Visit) -> None:
    session, analysis = coded
    server = Server()
    for level in (AmputationLevel.TRANSTIBIAL, AmputationLevel.TRANSFEMORAL):
        worn = replace(session.patient, prosthetic_side="left", prostheses={Side.LEFT: Prosthesis(level)})
        server.post(bundle(replace(session, patient=worn), analysis))
    (prosthesis,) = (one for one in server.held.values() if one["resourceType"] == "Device" and "patient" in one)
    assert "transfemoral" in prosthesis["type"]["text"].lower()


@pytest.mark.parametrize("unknown", [{}, {"age_years": "71"}])
def test_a_session_without_a_walk_has_no_report(coded: Visit, unknown: dict[str, object]) -> None:
    session, analysis = coded
    standing = [one for one in analysis.recordings if one.kind is not RecordingKind.WALKING]
    found = bundle(
        replace(session, patient=replace(session.patient, unknown=unknown)),
        replace(analysis, recordings=tuple(standing)),
    )
    assert len(resources(found, "Observation")) == len(unknown)
    assert resources(found, "DiagnosticReport") == []
    assert all(one for one in _lists(found))  # FHIR has no empty list


def _lists(part: Any) -> Iterator[list[Any]]:
    if isinstance(part, list):
        yield part
    for inner in part.values() if isinstance(part, dict) else part if isinstance(part, list) else ():
        yield from _lists(inner)


def test_left_and_right_have_no_code_alone_in_common(coded: Visit) -> None:
    first = {"left leg": set[str](), "right leg": set[str]()}
    for one in resources(bundle(*coded), "Observation"):
        if "bodySite" in one:
            of_side, of_both = one["code"]["coding"]
            side = one["bodySite"]["text"].removesuffix(" leg")
            assert of_side == {"system": OURS, "code": f"{side}_{of_both['code']}"}
            first[one["bodySite"]["text"]].add(of_side["code"])
    assert first["left leg"].isdisjoint(first["right leg"])
    assert len(first["left leg"]) == len(first["right leg"]) > 10


def test_figures_have_the_digits_that_they_can_have(coded: Visit) -> None:
    decimals = {"deg": 1, "%": 1, "s": 3, "m": 3, "m/s": 3, "/min": 1}
    quantities = list(_quantities(bundle(*coded)))
    assert len(quantities) > 100
    for one in quantities:
        assert len(repr(one["value"]).partition(".")[2]) <= decimals[one["code"]], one
        assert one["value"] != 0 or math.copysign(1.0, one["value"]) > 0


def _quantities(part: Any) -> Iterator[dict[str, Any]]:
    if isinstance(part, dict):
        if part.get("system") == "http://unitsofmeasure.org":
            yield part
        part = list(part.values())
    for inner in part if isinstance(part, list) else ():
        yield from _quantities(inner)


@pytest.mark.parametrize(("doubt", "status"), [(None, "final"), (Verdict.CARE, "preliminary")])
def test_a_report_is_final_where_every_part_is(coded: Visit, doubt: Verdict | None, status: str) -> None:
    session, analysis = coded
    recordings = []
    for one in analysis.recordings:
        legs = one.verdicts.legs
        if doubt is not None and one.kind is RecordingKind.WALKING:
            found = assess([GateReason("events", doubt)])
            legs = {**legs, Side.LEFT: replace(legs[Side.LEFT], timing=found)}
        recordings.append(replace(one, verdicts=replace(one.verdicts, legs=legs)))
    found_bundle = bundle(session, replace(analysis, recordings=tuple(recordings)))
    (report,) = resources(found_bundle, "DiagnosticReport")
    states = {one["status"] for one in resources(found_bundle, "Observation")}
    assert report["status"] == status
    assert ("preliminary" in states) == (status == "preliminary")
    assert report["effectiveDateTime"] == "2026-11-21T10:00:00+01:00"
    assert not {"conclusion", "conclusionCode"} & set(report)  # what it means is for who reads it


def test_what_made_the_figures_is_a_device(coded: Visit) -> None:
    (device,) = resources(bundle(*coded), "Device")
    assert device["deviceName"] == [{"name": "gaitwright", "type": "user-friendly-name"}]
    assert "Not a medical device" in device["note"][0]["text"]


def test_dates_are_moved_and_not_left_out(visit: Visit, tmp_path: Path) -> None:
    session, analysis = visit
    export_from_folder(session, analysis, [Format.FHIR], tmp_path)
    found = json.loads((tmp_path / "fhir_bundle.json").read_text(encoding="utf-8"))
    observations = [*resources(found, "Observation"), *resources(found, "DiagnosticReport")]
    (when,) = {one.get("effectiveDateTime", "") for one in observations}
    assert len(when) == len("2026-11-21T10:00:00+01:00")
    assert not when.startswith("2026-11-21")


def _is_test(one: dict[str, Any]) -> bool:
    return any(part["code"].startswith("timed_") for part in one["code"]["coding"])


def of_test(coded: Visit, test: TimedTest) -> dict[str, Any]:
    """What a bundle shows of a timed test, without what it shows of whose and when it was."""
    (one,) = (one for one in resources(bundle(*with_tests(coded, test)), "Observation") if _is_test(one))
    parts = {
        part["code"]["coding"][0]["code"]: next(value for name, value in part.items() if name.startswith("value"))
        for part in one["component"]
    }
    return {
        "code": [f"{part['system']} {part['code']}" for part in one["code"]["coding"]],
        "value": one.get("valueQuantity"),
        "absent": [part["code"] for part in one.get("dataAbsentReason", {}).get("coding", ())],
        "components": {name: value["value"] if isinstance(value, dict) else value for name, value in parts.items()},
        "status": one["status"],
        "notes": [note["text"] for note in one["note"]],
        "is_interpreted": "interpretation" in one,
    }


def test_a_timed_test_has_its_result_and_a_code_of_loinc_where_there_is_one(
    coded: Visit, snapshot: SnapshotAssertion
) -> None:
    found = {str(one): of_test(coded, replace(TWO, protocol=one, missing=())) for one in TimedProtocol}
    assert found == snapshot
    assert {one["value"]["system"] for one in found.values()} == {"http://unitsofmeasure.org"}


def test_what_a_test_did_not_measure_has_its_reason(coded: Visit, snapshot: SnapshotAssertion) -> None:
    nan = math.nan
    tests = {
        "a silent sensor": replace(TWO, missing=(NotMeasured.SILENT,)),
        "not finished": replace(TWO, end_s=nan, distance_m=nan, missing=(NotMeasured.NOT_FINISHED,)),
        "no feet": replace(TWO, distance_m=nan, missing=(NotMeasured.NO_FEET,)),
    }
    assert {name: of_test(coded, test) for name, test in tests.items()} == snapshot


def test_a_distance_whose_feet_are_in_doubt_is_preliminary_and_a_time_is_not(coded: Visit) -> None:
    session, analysis = coded
    doubted = assess([GateReason("distance", Verdict.CARE)])
    (walk,) = (one for one in analysis.recordings if one.kind is RecordingKind.WALKING)
    legs = {side: replace(leg, distance=doubted) for side, leg in walk.verdicts.legs.items()}
    walk = replace(walk, verdicts=replace(walk.verdicts, legs=legs))

    def status(protocol: TimedProtocol) -> str:
        changed: RecordingAnalysis = replace(walk, timed=replace(TWO, protocol=protocol, missing=()))
        found = resources(bundle(session, replace(analysis, recordings=(changed,))), "Observation")
        return next(str(one["status"]) for one in found if _is_test(one))

    assert status(TimedProtocol.SIX_MINUTES) == "preliminary"
    assert status(TimedProtocol.UP_AND_GO) == "final"


EVERY_TEST = tuple(replace(TWO, protocol=protocol) for protocol in TimedProtocol)


def test_fhir_resources_takes_the_transaction(coded: Visit, tmp_path: Path) -> None:
    write_bundle(*with_tests(coded, *EVERY_TEST), tmp_path / "bundle.json")
    read = Bundle.model_validate_json((tmp_path / "bundle.json").read_bytes())
    entries: list[Any] = list(read.entry or ())
    assert read.type == "transaction"
    assert {one.resource.get_resource_type() for one in entries} == {
        *("Patient", "Device", "Observation", "DiagnosticReport")
    }
    assert all(one.request.method in ("POST", "PUT") for one in entries)
    sides = {one.resource.bodySite.coding[0].code for one in entries if getattr(one.resource, "bodySite", None)}
    assert sides == {"32153003", "62175007"}


NPM_FHIR = """
const {Fhir} = require('fhir');
const bundle = JSON.parse(require('fs').readFileSync(process.argv[1]));
const found = new Fhir().validate(bundle, {errorOnUnexpected: true});
console.log(JSON.stringify({
    valid: found.valid,
    errors: found.messages.filter(one => ['error', 'fatal'].includes(one.severity)),
    count: found.messages.length,
}));
"""


@pytest.mark.endurance
def test_fhir_of_npm_finds_no_error(coded: Visit, tmp_path: Path) -> None:
    write_bundle(*with_tests(coded, *EVERY_TEST), tmp_path / "bundle.json")
    assert ask_node("fhir", NPM_FHIR, tmp_path / "bundle.json") | {"count": 0} == {
        "valid": True,
        "errors": [],
        "count": 0,
    }
    broken = json.loads((tmp_path / "bundle.json").read_text(encoding="utf-8"))
    broken["entry"][-1]["resource"]["status"] = "finished"  # which it does find
    (tmp_path / "broken.json").write_text(json.dumps(broken), encoding="utf-8")
    assert ask_node("fhir", NPM_FHIR, tmp_path / "broken.json")["errors"]

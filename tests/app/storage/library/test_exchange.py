"""A session folder goes into the library and comes out again with every bit, key and column, or without any name."""

import datetime
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from uuid import UUID, uuid4

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from app.storage.exchange import import_session, session_with_samples
from app.storage.journal.disk import Room
from app.storage.journal.header import JournalRefusedError
from app.storage.opened import OpenedLibrary
from app.storage.pseudonyms import AGE, Pseudonyms, Typed, age_in_words
from app.storage.stored import LibraryError, RecordingState
from app.system.progress import nobody
from core.body import LEG_JOINTS, LEG_SITES, Joint, Site
from core.findings import Finding, Severity
from core.goals import Goal, GoalOf
from core.samples import ImuBlock, RateKind, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.files.session_folder import read_session, write_session
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.app.storage.library.folder_export import write_folder
from tests.simulated import SHORT_VISIT, session_of

ANY_ROOM = Room(start_bytes=0, kept_bytes=0)
NAMES = [f"Kowalczyk-{number:03d}" for number in range(200)]
ODD = {"note_of_clinic": "kept", "table": {"deep": [1, 2, {"deeper": True}]}, "figure": 1.25}


def same_bits(one: NDArray[Any] | None, other: NDArray[Any] | None) -> bool:
    if one is None or other is None:
        return one is other
    if np.issubdtype(one.dtype, np.floating):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    return [str(value) for value in one] == [str(value) for value in other]


def assert_same(one: Session, other: Session) -> None:
    """Everything but the findings, which reading makes again."""
    bare = [replace(session, recordings=(), findings=()) for session in (one, other)]
    assert bare[0] == bare[1]
    assert len(one.recordings) == len(other.recordings)
    for before, after in zip(one.recordings, other.recordings, strict=True):
        assert replace(before, imu={}) == replace(after, imu={})
        assert set(before.imu) == set(after.imu)
        for site in before.imu:
            a, b = before.imu[site], after.imu[site]
            assert (a.sensor, a.is_rate_derived) == (b.sensor, b.is_rate_derived)
            for name in ("time_s", "gyr_rad_s", "acc_m_s2", "q_earth_from_sensor", "mag"):
                assert same_bits(getattr(a, name), getattr(b, name)), (before.name, site, name)
            assert set(a.unknown) == set(b.unknown)
            assert all(same_bits(a.unknown[name], b.unknown[name]) for name in a.unknown)


def in_and_out(opened: OpenedLibrary, session: Session) -> Session:
    imported = import_session(opened, session, nobody, room=ANY_ROOM)
    return session_with_samples(opened, opened.library.sessions.get(imported.session_id), {}, nobody)


@pytest.fixture(scope="module")
def walked() -> Session:
    """The simulated patient: two of six sensors with orientation and magnetic field, gaps, odd keys and columns."""
    session = session_of(SHORT_VISIT)
    rng = np.random.default_rng(5)
    changed = []
    for recording in session.recordings:
        imu = dict(recording.imu)
        for site in (Site.LEFT_SHANK, Site.RIGHT_FOOT):
            block = imu[site]
            kept = rng.random(len(block)) > 0.1
            gyr_rad_s = block.gyr_rad_s.copy()
            gyr_rad_s[rng.random(len(block)) > 0.9] = np.nan
            count = int(kept.sum())
            imu[site] = ImuBlock(
                block.sensor,
                block.time_s[kept],
                gyr_rad_s[kept],
                block.acc_m_s2[kept],
                q_earth_from_sensor=rng.normal(size=(count, 4)),
                mag=rng.normal(size=(count, 3)),
                is_rate_derived=site is Site.RIGHT_FOOT,
                unknown={"counter": np.array([str(k) for k in range(count)], dtype=np.dtypes.StringDType())},
            )
        changed.append(replace(recording, imu=imu, unknown=ODD, note="slow", condition="alignment A"))
    return replace(
        session,
        recordings=tuple(changed),
        patient=replace(session.patient, height_m=1.8, birth_year=1950, unknown=ODD),
        sensors={**session.sensors, Site.LEFT_THIGH: SensorInfo("LT", "walker", "2", 100.0, unknown=ODD)},
        zero_rad={Joint.LEFT_KNEE: math.radians(5.0)},
        turned_sign={Joint.RIGHT_KNEE: -1},
        started="2026-11-20T09:00:00+01:00",
        operator="H. Keller",
        surface="corridor",
        notes="slow",
        software="walker",
        unknown={"session": ODD, "clinic": {"ward": "B"}},
    )


def test_the_simulated_patient_comes_back_bit_for_bit_by_way_of_folders(
    opened: OpenedLibrary, walked: Session, tmp_path: Path
) -> None:
    write_session(walked, tmp_path / "first")
    session = read_session(tmp_path / "first")
    imported = import_session(opened, session, nobody, room=ANY_ROOM)
    write_folder(opened, imported.session_id, tmp_path / "second", {}, is_identified=True)
    assert_same(session, read_session(tmp_path / "second"))
    first, second = (sorted((tmp_path / name).rglob("*.csv")) for name in ("first", "second"))
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
    assert opened.library.patients.get(imported.patient.id).details == session.patient


NUMBERS = st.floats(allow_nan=True, allow_infinity=False, width=64)
WORDS = st.text(st.characters(codec="utf-8", exclude_characters="\x00"), max_size=6)


@st.composite
def blocks(draw: st.DrawFn) -> ImuBlock:
    """Any samples that a reader lets through: rising stamps, everything else any number or none."""
    time_s = np.array(sorted(draw(st.sets(st.floats(-1e6, 1e6), max_size=12))), dtype=float)
    n = len(time_s)

    def matrix(columns: int) -> NDArray[np.float64]:
        flat = draw(st.lists(NUMBERS, min_size=n * columns, max_size=n * columns))
        return np.array(flat, dtype=float).reshape(n, columns)

    unknown: dict[str, NDArray[np.generic]] = {}
    if draw(st.booleans()):
        unknown["temperature"] = matrix(1)[:, 0]
    if draw(st.booleans()):
        unknown["event"] = np.array(draw(st.lists(WORDS, min_size=n, max_size=n)), dtype=np.dtypes.StringDType())
    return ImuBlock(
        draw(st.sampled_from(["A", "B", "same"])),
        time_s,
        matrix(3),
        matrix(3),
        matrix(4) if draw(st.booleans()) else None,
        matrix(3) if draw(st.booleans()) else None,
        draw(st.booleans()),
        unknown,
    )


TABLES: st.SearchStrategy[Mapping[str, object]] = st.dictionaries(
    WORDS, st.one_of(WORDS, st.booleans(), st.integers(-(2**63), 2**63 - 1), st.lists(WORDS, max_size=2)), max_size=2
)


@st.composite
def sessions(draw: st.DrawFn) -> Session:
    recordings = tuple(
        Recording(
            name=f"walk {number}",
            kind=draw(st.sampled_from(RecordingKind)),
            folder=f"walk_{number}",
            imu=draw(st.dictionaries(st.sampled_from(Site), blocks(), min_size=1, max_size=3)),
            condition=draw(WORDS),
            started=draw(WORDS),
            is_kept=draw(st.booleans()),
            note=draw(WORDS),
            is_restrapped_before=draw(st.booleans()),
            unknown=draw(TABLES),
        )
        for number in range(draw(st.integers(1, 3)))
    )
    infos = st.builds(
        SensorInfo,
        serial=st.sampled_from(["A", "B", "same"]),
        model=WORDS,
        rate_hz=st.none() | st.floats(1, 2000),
        rate_kind=st.none() | st.sampled_from(RateKind),
        unknown=TABLES,
    )
    return Session(
        recordings=recordings,
        patient=Patient(code=f"P-{uuid4()}", sex=draw(WORDS), unknown=draw(TABLES)),
        sensors=draw(st.dictionaries(st.sampled_from(Site), infos, max_size=6)),
        zero_rad=draw(st.dictionaries(st.sampled_from(LEG_JOINTS), st.floats(-3, 3), max_size=4)),
        turned_sign=draw(st.dictionaries(st.sampled_from(LEG_JOINTS), st.sampled_from([1, -1]), max_size=4)),
        started=draw(WORDS),
        operator=draw(WORDS),
        notes=draw(WORDS),
        unknown=draw(TABLES),
    )


@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(session=sessions())
@pytest.mark.endurance
def test_whatever_a_session_holds_the_library_gives_back(opened: OpenedLibrary, session: Session) -> None:
    assert_same(session, in_and_out(opened, session))


@pytest.mark.endurance
@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(session=sessions())
def test_whatever_hundreds_of_sessions_hold_the_library_gives_back(opened: OpenedLibrary, session: Session) -> None:
    assert_same(session, in_and_out(opened, session))


def named(session: Session, name: str) -> Session:
    """`session` with a name wherever somebody may type one that has no part in the analysis."""
    odd = {name: name, "key": {"deep": name}}
    recordings = []
    for number, recording in enumerate(session.recordings):
        imu = {
            site: replace(
                block,
                sensor=f"{name} {site}",
                unknown={name: np.array([name] * len(block), dtype=np.dtypes.StringDType())},
            )
            for site, block in recording.imu.items()
        }
        stated = replace(recording, name=f"{name} {number}", folder=f"{name}_{number}", note=name, started="2026-11-20")
        recordings.append(replace(stated, imu=imu, unknown=odd))
    return replace(
        session,
        recordings=tuple(recordings),
        patient=Patient(code=f"DEMO {name}", unknown=odd),
        sensors={site: replace(info, serial=f"{name} {site}", unknown=odd) for site, info in session.sensors.items()},
        operator=name,
        notes=name,
        started="2026-11-20T09:00:00",
        unknown={"session": odd, name: odd},
    )


def everything_in(folder: Path) -> str:
    return "\n".join(
        f"{path.relative_to(folder)}\n{path.read_text(encoding='utf-8')}"
        for path in folder.rglob("*")
        if path.is_file()
    )


def small(session: Session) -> Session:
    """The first second of one sensor of each recording."""
    recordings = []
    for recording in session.recordings:
        block = recording.imu[Site.LEFT_THIGH]
        first = replace(
            block, time_s=block.time_s[:20], gyr_rad_s=block.gyr_rad_s[:20], acc_m_s2=block.acc_m_s2[:20], unknown={}
        )
        recordings.append(replace(recording, imu={Site.LEFT_THIGH: first}))
    return replace(session, recordings=tuple(recordings))


@pytest.mark.endurance
def test_an_export_states_no_name_unless_it_is_asked_to(opened: OpenedLibrary, walked: Session, tmp_path: Path) -> None:
    pseudonyms = set()
    for number, name in enumerate(NAMES[:8]):
        imported = import_session(opened, named(small(walked), name), nobody, room=ANY_ROOM)
        folder = tmp_path / f"out{number}"
        write_folder(opened, imported.session_id, folder, {})
        assert not [one for one in [*NAMES, "2026-11-20", "Keller"] if one in everything_in(folder)]
        exported = read_session(folder)
        assert [one.name for one in exported.recordings] == ["standing", "free motion", "walk 1"]
        pseudonyms.add(exported.patient.code)
        folder = tmp_path / f"identified{number}"
        write_folder(opened, imported.session_id, folder, {}, is_identified=True)
        assert name in everything_in(folder)
    assert len(pseudonyms) == 8


@pytest.mark.endurance
def test_of_200_names_none_passes_the_pseudonyms(walked: Session) -> None:
    pseudonyms, patient_id = Pseudonyms(bytes(32)), UUID(int=1)
    for name in NAMES:
        stated = repr(pseudonyms.session(patient_id, named(small(walked), name)))
        assert name not in stated
        assert "2026-11-20" not in stated


def test_a_pseudonym_and_a_shift_are_a_patients_own_and_stay() -> None:
    key, other = Pseudonyms(bytes(32)), Pseudonyms(bytes(31) + b"\1")
    codes = [key.code(UUID(int=number)) for number in range(500)]
    assert len(set(codes)) == 500
    assert codes[3] == key.code(UUID(int=3)) != other.code(UUID(int=3))
    patient = UUID(int=3)
    first, second = (np.datetime64(key.shifted(patient, f"2026-11-{day}T09:00:00")) for day in (20, 27))
    assert second - first == np.timedelta64(7, "D")
    assert key.shifted(patient, "2026-11-20") < "2026-10-22"
    assert key.shifted(patient, "on Friday, with Anna") == ""


def test_samples_and_clinical_facts_pass_the_pseudonyms(walked: Session) -> None:
    reported = Pseudonyms(bytes(32)).session(UUID(int=1), walked, [Typed.CONDITIONS])
    age = {AGE: age_in_words(walked)} if age_in_words(walked) else {}
    without = replace(walked.patient, code=reported.patient.code, birth_year=None, device="", aids="", unknown=age)
    assert reported.patient == without
    assert (reported.zero_rad, reported.turned_sign, reported.is_simulated) == (
        walked.zero_rad,
        walked.turned_sign,
        True,
    )
    assert reported.patient.code.startswith("DEMO-")
    for before, after in zip(walked.recordings, reported.recordings, strict=True):
        assert (before.kind, before.condition, before.is_kept) == (after.kind, after.condition, after.is_kept)
        assert all(same_bits(before.imu[site].gyr_rad_s, after.imu[site].gyr_rad_s) for site in before.imu)
    worn = [{site: block.sensor for site, block in recording.imu.items()} for recording in reported.recordings]
    assert len(set(worn[0].values())) == 6
    assert worn[0] == worn[1] == worn[2]  # the same sensor is still known as the same


def test_an_import_that_is_stopped_is_out_of_sight(opened: OpenedLibrary, walked: Session) -> None:
    def stop(share: float, _what: str) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        import_session(opened, walked, stop, room=ANY_ROOM)
    assert opened.library.sessions.list() == ()
    assert len(opened.library.sessions.list(is_deleted=True)) == 1


def test_a_session_without_a_code_needs_one_and_a_simulated_one_needs_a_simulated_patient(
    opened: OpenedLibrary, walked: Session
) -> None:
    with pytest.raises(LibraryError, match="needs a code"):
        import_session(opened, replace(small(walked), patient=Patient()), nobody, room=ANY_ROOM)
    with pytest.raises(LibraryError, match="starts with DEMO"):
        import_session(opened, small(walked), nobody, code="P-001", room=ANY_ROOM)
    assert opened.library.sessions.list() == ()
    imported = import_session(opened, small(walked), nobody, code="demo 7".upper(), room=ANY_ROOM)
    assert imported.patient.details.code == "DEMO 7"


def test_a_known_patient_stays_as_the_library_knows_it(opened: OpenedLibrary, walked: Session) -> None:
    first = import_session(opened, small(walked), nobody, room=ANY_ROOM)
    taller = replace(small(walked), patient=replace(walked.patient, height_m=1.9, sex="f"))
    second = import_session(opened, taller, nobody, room=ANY_ROOM)
    assert second.patient.id == first.patient.id
    assert second.differing == ("sex", "height_m")
    assert second.patient.details == first.patient.details


@pytest.mark.endurance
def test_goals_come_with_a_new_patient_and_go_out_again_and_others_are_reported_of(
    opened: OpenedLibrary, walked: Session, tmp_path: Path
) -> None:
    goal = Goal("speed_m_s", GoalOf.WALK, 1.2, datetime.date(2026, 1, 5), "H. Keller", note="bus")
    reported = replace(small(walked), patient=replace(walked.patient, goals=(goal,)))
    first = import_session(opened, reported, nobody, room=ANY_ROOM)
    assert first.patient.details.goals == (goal,)
    assert import_session(opened, reported, nobody, room=ANY_ROOM).differing == ()
    other = replace(goal, value=1.4)
    second = import_session(
        opened, replace(reported, patient=replace(reported.patient, goals=(other,))), nobody, room=ANY_ROOM
    )
    assert second.differing == ("goals",)
    assert second.patient.details.goals == (goal,)
    for name, is_identified in (("whole", True), ("nameless", False)):
        write_folder(opened, first.session_id, tmp_path / name, {}, is_identified=is_identified)
    assert read_session(tmp_path / "whole").patient.goals == (goal,)
    (nameless,) = read_session(tmp_path / "nameless").patient.goals
    assert (nameless.key, nameless.value, nameless.by, nameless.note) == (goal.key, 1.2, "", "")


def test_a_destroyed_recording_is_not_exported_and_a_missing_file_is_stated(
    opened: OpenedLibrary, walked: Session, tmp_path: Path
) -> None:
    imported = import_session(opened, small(walked), nobody, room=ANY_ROOM)
    first, second, _ = opened.library.sessions.get(imported.session_id).recordings
    opened.library.recordings.discard(first.id)
    (opened.recordings / second.journals[0].file).rename(tmp_path / "away")
    with pytest.raises(JournalRefusedError, match="missing"):
        write_folder(opened, imported.session_id, tmp_path / "out", {})
    (tmp_path / "away").rename(opened.recordings / second.journals[0].file)
    write_folder(opened, imported.session_id, tmp_path / "out", {})
    assert len(read_session(tmp_path / "out").recordings) == 2
    states = [one.state for one in opened.library.sessions.get(imported.session_id).recordings]
    assert states == [RecordingState.DISCARDED, RecordingState.CLOSED, RecordingState.CLOSED]


def test_what_happened_to_a_recordings_file_is_reported(opened: OpenedLibrary, walked: Session) -> None:
    imported = import_session(opened, small(walked), nobody, room=ANY_ROOM)
    visit = opened.library.sessions.get(imported.session_id)
    assert session_with_samples(opened, visit, {}, nobody).findings == ()
    with (opened.recordings / visit.recordings[0].journals[0].file).open("ab") as file:
        file.write(b"more")
    changed = Finding("recording_changed", Severity.WARNING, "standing")
    assert session_with_samples(opened, visit, {}, nobody).findings == (changed,)
    journal = visit.recordings[1].journals[0]
    opened.library.recordings.close(visit.recordings[1].id, RecordingState.RECOVERED, {1: journal.sha256})
    visit = opened.library.sessions.get(imported.session_id)
    recovered = Finding("recording_recovered", Severity.INFO, "free motion")
    assert session_with_samples(opened, visit, {}, nobody).findings == (changed, recovered)


def test_a_session_with_a_pelvis_goes_in_and_out(opened: OpenedLibrary) -> None:
    settings = WalkerSettings(sites=(*LEG_SITES, Site.PELVIS), recordings=(Standing(), Walk(strides=2)))
    session = session_of(settings)
    again = in_and_out(opened, session)
    assert set(again.sensors) == {*LEG_SITES, Site.PELVIS}
    for one, other in zip(again.recordings, session.recordings, strict=True):
        assert set(one.imu) == {*LEG_SITES, Site.PELVIS}
        assert same_bits(one.imu[Site.PELVIS].acc_m_s2, other.imu[Site.PELVIS].acc_m_s2)


def test_what_an_import_found_is_in_the_library_and_in_every_export_without_names(
    opened: OpenedLibrary, walked: Session, tmp_path: Path
) -> None:
    name = walked.recordings[-1].name
    mended = {"count": 2, "left_out": 0, "first": 11, "off_s": 3.5}
    found = (
        Finding("stamps_mended", Severity.WARNING, f"{name}, left_shank", mended),
        Finding("clock_not_measured", Severity.WARNING, f"{name}, left_thigh", {"host": "Kowalczyks laptop"}),
        Finding("columns_left_out", Severity.INFO, f"{name}, left_thigh", {"names": "Kowalczyk"}),
        Finding("Kowalczyk", Severity.GRAVE, f"{name}, left_thigh", {"Kowalczyk": 1}),
        Finding("stamps_mended", Severity.WARNING, "Kowalczyk", {"Kowalczyk": 1}),
    )
    write_session(replace(small(walked), findings=found), tmp_path / "in")
    imported = import_session(opened, read_session(tmp_path / "in"), nobody, room=ANY_ROOM)
    stored = session_with_samples(opened, opened.library.sessions.get(imported.session_id), {}, nobody)
    assert all(one in stored.findings for one in found)
    write_folder(opened, imported.session_id, tmp_path / "whole", {}, is_identified=True)
    assert all(one in read_session(tmp_path / "whole").findings for one in found)
    write_folder(opened, imported.session_id, tmp_path / "out", {})
    assert "Kowalczyk" not in (tmp_path / "out" / "session.toml").read_text()
    exported = read_session(tmp_path / "out")
    walk = exported.recordings[-1].name
    kept = {(one.key, one.where): one.numbers for one in exported.findings if one.severity is not Severity.INFO}
    assert kept["stamps_mended", f"{walk}, left_shank"] == mended
    assert kept["clock_not_measured", f"{walk}, left_thigh"] == {"host": "?"}
    assert {key for key, _ in kept} <= {"stamps_mended", "clock_not_measured", "sensor_changed"}

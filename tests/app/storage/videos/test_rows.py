"""Videos belong to walks of patients who agreed; every step is noted; what is deleted is out of sight at once."""

import math
from collections.abc import Callable
from dataclasses import replace
from uuid import UUID, uuid4

import pytest

from app.storage.opened import OpenedLibrary
from app.storage.stored import (
    Action,
    ChangedMeanwhileError,
    ClipRefusedError,
    ClipState,
    LibraryError,
    NotAllowedError,
    Operator,
    Role,
    StoredClip,
)
from app.storage.videos.destroying import destroy_clip, withdraw_consent
from core.session import Patient, Session
from core.video.clip import Sync, SyncBy
from tests.videos import walk

MakeVideo = Callable[..., StoredClip]


def start(opened: OpenedLibrary, recording_id: UUID, camera: int = 1) -> StoredClip:
    return opened.library.clips.start(
        uuid4(), recording_id, camera, "", (1280, 720), 30.0, b"key", is_imported=camera == 2
    )


def test_a_video_is_found_by_its_walk_with_what_was_stored_of_it(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID
) -> None:
    clips = opened.library.clips
    second, first = start(opened, recording_id, 2), start(opened, recording_id, 1)
    assert clips.of_session(session_id) == {}  # they are being recorded
    assert first.sync == Sync(0.0, first.sync.sd_s, SyncBy.CLOCK) if first.sync else False
    assert second.sync is None
    second = clips.close(second.id, ClipState.CLOSED, 90, 3.0, "hash") or second
    first = clips.close(first.id, ClipState.RECOVERED, 60, 2.0, "hash") or first
    measured = clips.synchronise(second, Sync(-0.12, 0.004, SyncBy.MOTION))
    unsure = clips.synchronise(first, Sync(0.5, math.nan, SyncBy.HAND))
    seen = clips.set_view(measured, "from behind")
    assert clips.of_session(session_id)[recording_id][1] == seen
    assert (seen.view, seen.sync, seen.frames) == ("from behind", Sync(-0.12, 0.004, SyncBy.MOTION), 90)
    found = clips.of_session(session_id)[recording_id][0]
    assert found.id == unsure.id
    assert found.sync is not None
    assert math.isnan(found.sync.sd_s)
    with pytest.raises(ChangedMeanwhileError):
        clips.set_view(second, "from the front")


def test_no_video_without_a_walk_without_consent_or_twice_by_one_camera(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID
) -> None:
    library = opened.library
    with pytest.raises(ClipRefusedError, match="not in the library, so no video"):
        start(opened, uuid4())
    other = library.patients.create(Patient(code="P-2"))
    visit = library.sessions.create(other.id, Session(()))
    with pytest.raises(ClipRefusedError, match="has not agreed"):
        start(opened, walk(opened, visit.id).id)
    first = start(opened, recording_id)
    with pytest.raises(ClipRefusedError, match="already has a video"):
        start(opened, recording_id)
    destroy_clip(opened, first.id)
    start(opened, recording_id)


def test_consent_is_given_and_withdrawn_and_given_again(opened: OpenedLibrary) -> None:
    library = opened.library
    patient = library.patients.create(Patient(code="P-2"))
    assert not library.clips.consent(patient.id).is_given
    assert withdraw_consent(opened, patient.id) == 0  # nothing was given, nothing is noted
    assert library.clips.consent(patient.id).withdrawn_at is None
    given = library.clips.give_consent(patient.id)
    assert (given.is_given, given.given_by) == (True, "hk")
    assert library.clips.consent(patient.id) == given
    withdraw_consent(opened, patient.id)
    withdrawn = library.clips.consent(patient.id)
    assert (withdrawn.is_given, withdrawn.given_at, withdrawn.withdrawn_by) == (False, given.given_at, "hk")
    library.clips.give_consent(patient.id)
    assert library.clips.consent(patient.id).is_given
    with pytest.raises(LibraryError, match="no longer in the library"):
        library.clips.give_consent(uuid4())


@pytest.mark.parametrize("is_withdrawn", [False, True])
def test_of_two_patients_who_are_one_the_latest_word_counts_and_merging_can_be_undone(
    opened: OpenedLibrary, patient_id: UUID, is_withdrawn: bool
) -> None:
    library = opened.library
    other = library.patients.create(Patient(code="P-2"))
    if is_withdrawn:
        withdraw_consent(opened, patient_id)
    kept = library.patients.merge(other, library.patients.get(patient_id))
    assert library.clips.consent(kept.id).is_given is not is_withdrawn
    (merging,) = library.corrections.of_patient(kept.id)
    library.corrections.undo(merging.id)
    assert not library.clips.consent(kept.id).is_given
    assert library.clips.consent(patient_id).is_given is not is_withdrawn


def test_every_step_is_in_the_audit_and_names_nobody(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, patient_id: UUID, make_video: MakeVideo
) -> None:
    clip = make_video(recording_id)
    opened.library.clips.set_view(clip, "Kowalczyk's left")
    withdraw_consent(opened, patient_id)
    entries = opened.library.audit.entries(f"clip:{clip.id}")
    assert [entry.action for entry in entries] == [Action.CREATE, Action.EDIT, Action.EDIT, Action.DELETE]
    assert not [entry for entry in opened.library.audit.entries() if "Kowalczyk" in entry.details]
    consents = [entry.details for entry in opened.library.audit.entries(f"patient:{patient_id}")]
    assert '{"is_video_consent":true}' in consents
    assert consents[-1] == '{"is_video_consent":false}'
    assert opened.library.audit.verify().faults == ()


def test_who_only_looks_sees_videos_and_changes_nothing(
    opened: OpenedLibrary, session_id: UUID, recording_id: UUID, patient_id: UUID, make_video: MakeVideo
) -> None:
    clip = make_video(recording_id)
    library = opened.library
    library.operators.add(Operator("vw", "V. Wolf", Role.VIEWER))
    library.log_in("vw")
    assert library.clips.of_session(session_id) == {recording_id: (clip,)}
    assert library.clips.consent(patient_id).is_given
    for change in (
        lambda: library.clips.set_view(clip, "x"),
        lambda: library.clips.delete(clip.id),
        lambda: library.clips.give_consent(patient_id),
        lambda: library.clips.withdraw_consent(patient_id),
        lambda: start(opened, recording_id, 2),
    ):
        with pytest.raises(NotAllowedError):
            change()
    assert library.clips.of_session(session_id) == {recording_id: (clip,)}


def test_a_walk_that_was_taken_back_takes_its_video_along(opened: OpenedLibrary, session_id: UUID) -> None:
    recording = walk(opened, session_id)
    begun = opened.library.recordings.start(session_id, replace(recording.details, name="walk 2"), False)
    clip = start(opened, begun.id)
    opened.library.recordings.withdraw(begun.id)
    assert clip.id not in opened.library.clips.known()

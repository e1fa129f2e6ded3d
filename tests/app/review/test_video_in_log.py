"""Clips in the Rerun log: every frame as it is stored, at its time among the samples, and only where asked for."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from app.review import rerun_log
from app.review.rerun_log import write_log
from app.review.viewer import Viewer
from core.video.clip import Clip, Sync, SyncBy
from tests.app.drawn_clips import Jpegs, plain_clip
from tests.app.review.test_rerun_log import visit
from tests.app.review.test_viewer import stand_in, wait_for

WALK = "walk Miller 1"


def clip(**change: object) -> Clip:
    sync = Sync(5.25, 0.01, SyncBy.MOTION)
    fields: dict[str, object] = {"recording": WALK, "sync": sync, **change}
    return replace(plain_clip(), **fields)  # type: ignore[arg-type]  # of any field


def frames(path: Path, camera: int = 1) -> dict[float, bytes]:
    """The frames of a camera by their time."""
    found: dict[float, bytes] = {}
    for chunk in RrdReader(path).stream():
        if chunk.entity_path == f"/video/camera_{camera}" and not chunk.is_static:
            batch = chunk.to_record_batch()
            times_s = batch.column("walking_1").cast("int64").to_numpy() / 1e9
            blobs = batch.column("EncodedImage:blob").to_pylist()
            kinds = batch.column("EncodedImage:media_type").to_pylist()
            assert all(kind == ["image/jpeg"] for kind in kinds)
            found |= {float(time_s): bytes(blob[0]) for time_s, blob in zip(times_s, blobs, strict=True)}
    return found


def views(path: Path) -> set[str]:
    reader = RrdReader(path)
    (layout,) = reader.blueprints()
    return {
        str(names[0])
        for chunk in reader.stream(store=layout)
        for name, column in zip(chunk.to_record_batch().schema.names, chunk.to_record_batch().columns, strict=True)
        if name == "ViewBlueprint:space_origin"
        for names in column.to_pylist()
    }


def test_every_frame_is_there_as_it_is_stored_at_its_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rerun_log, "FRAMES_PER_CHUNK", 10)
    write_log(*visit(), tmp_path / "session.rrd", [clip()])
    found = frames(tmp_path / "session.rrd")
    assert len(found) == 25
    np.testing.assert_allclose(sorted(found), np.arange(25) / 30 + 5.25, atol=1e-8)
    assert [found[time_s] for time_s in sorted(found)] == [clip().pictures.jpeg(k) for k in range(25)]
    assert "/video/camera_1" in views(tmp_path / "session.rrd")


def test_each_camera_has_a_view_of_its_own(tmp_path: Path) -> None:
    write_log(*visit(), tmp_path / "session.rrd", [clip(), clip(camera=2)])
    assert {"/video/camera_1", "/video/camera_2"} <= views(tmp_path / "session.rrd")
    assert len(frames(tmp_path / "session.rrd", 2)) == 25


def test_without_clips_no_byte_is_another(tmp_path: Path) -> None:
    """Of none, of one that has no time of the samples, and of one of a walk that was discarded."""
    write_log(*visit(), tmp_path / "plain")
    for number, clips in enumerate(
        ([], [clip(sync=None)], [clip(sync=Sync(0.0, math.nan, SyncBy.CLOCK))], [clip(recording="walk Miller 2")])
    ):
        write_log(*visit(), tmp_path / str(number), clips)
        assert (tmp_path / str(number)).read_bytes() == (tmp_path / "plain").read_bytes()
    assert "/video/camera_1" not in views(tmp_path / "plain")


def test_with_clips_two_writings_are_the_same_bytes(tmp_path: Path) -> None:
    for name in ("first", "second"):
        write_log(*visit(), tmp_path / name, [clip()])
    assert (tmp_path / "first").read_bytes() == (tmp_path / "second").read_bytes()


def test_a_damaged_frame_is_left_out_and_the_others_are_there(tmp_path: Path) -> None:
    pictures = Jpegs([clip().pictures.jpeg(k) for k in range(25)], damaged=[4])
    write_log(*visit(), tmp_path / "session.rrd", [clip(pictures=pictures)])
    found = frames(tmp_path / "session.rrd")
    assert len(found) == 24
    assert not any(abs(time_s - 5.25 - 4 / 30) < 1e-6 for time_s in found)


def test_the_viewer_shows_a_clip_where_it_is_given_and_else_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    program, seen = stand_in(tmp_path)
    for name, clips, expected in (("with", [clip()], 25), ("without", [], 0)):
        viewer = Viewer(tmp_path / name, program)
        viewer.open(*visit(), clips)
        wait_for(seen)
        (log,) = (tmp_path / name).rglob("*.rrd")
        assert len(frames(log)) == expected
        viewer.close()

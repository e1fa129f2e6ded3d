"""Tests that what is in a reference file is read, by the process that reads files of others.

No recording of a laboratory is at hand for these formats: the fixtures are built from their published descriptions, the
C3D by the library that reads them elsewhere, too.
"""

import re
import struct
from collections.abc import Callable
from pathlib import Path

import ezc3d
import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from core.body import Joint, Side
from devices.files.answers import Array, BrokenAnswerError, details_of
from devices.files.limited_reader import LimitedReading
from devices.files.references.answers import reference_from
from devices.files.references.markers import angles_of_markers, landmark_of
from devices.files.references.reading import read_reference
from devices.files.references.trial import ReferenceFile, joint_of_name
from devices.files.refusal import FileRefusedError
from tests.trials_of_files import refused

Read = Callable[[str | bytes], ReferenceFile]
TIME_S = np.arange(0, 60) / 100.0
KNEE_DEG, ANKLE_DEG = 20 + 15 * np.sin(9 * TIME_S), 5 * np.cos(7 * TIME_S)


@pytest.fixture
def read(tmp_path: Path, shared_reading: LimitedReading) -> Read:
    """Read a content under a name that gives nothing: here, and by the process, which states the same."""

    def of(content: str | bytes) -> ReferenceFile:
        path = tmp_path / "reference"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        try:
            here = read_reference(path)
        except FileRefusedError as problem:
            with pytest.raises(FileRefusedError, match=f"^{re.escape(str(problem))}$"):
                shared_reading.read_reference(path)
            raise
        found = shared_reading.read_reference(path)
        assert (found.format, found.source) == (here.format, here.source)
        for trial, same in zip(found.trials, here.trials, strict=True):
            assert set(trial.angles) == set(same.angles)
            for joint, (time_s, angle_rad) in trial.angles.items():
                np.testing.assert_array_equal(time_s, same.angles[joint][0])
                np.testing.assert_array_equal(angle_rad, same.angles[joint][1])
        return found

    return of


def degrees(file: ReferenceFile, joint: Joint, trial: int = 0) -> np.ndarray:
    return np.rad2deg(file.trials[trial].angles[joint][1])


def csv_of(header: str, *columns: np.ndarray) -> str:
    return header + "\n" + "".join(",".join(f"{v:.6f}" for v in row) + "\n" for row in np.column_stack(columns))


def test_a_csv_of_angles_is_read_in_degrees(read: Read) -> None:
    found = read(csv_of("time_s,left_knee,right_ankle_deg,note", TIME_S, KNEE_DEG, ANKLE_DEG, TIME_S))
    assert (found.format, found.source) == ("csv", "angles")
    (trial,) = found.trials
    assert set(trial.angles) == {Joint.LEFT_KNEE, Joint.RIGHT_ANKLE}
    np.testing.assert_allclose(trial.angles[Joint.LEFT_KNEE][0], TIME_S)
    np.testing.assert_allclose(degrees(found, Joint.LEFT_KNEE), KNEE_DEG, atol=1e-5)
    np.testing.assert_allclose(degrees(found, Joint.RIGHT_ANKLE), ANKLE_DEG, atol=1e-5)


def test_a_column_of_recordings_makes_trials_each_with_a_clock_of_its_own(read: Read) -> None:
    rows = [f"walk {k};{t:.2f};{k + t:.3f}" for k in (1, 2) for t in (0.0, 0.01, 0.02)]
    found = read("# a laboratory\nrecording;time_s;left_ankle\n" + "\n".join(rows) + "\n")
    assert [trial.name for trial in found.trials] == ["walk 1", "walk 2"]
    np.testing.assert_allclose(degrees(found, Joint.LEFT_ANKLE, 1), [2.0, 2.01, 2.02])


def test_an_empty_cell_is_a_gap(read: Read) -> None:
    found = read("time_s,left_knee\n0.0,1.0\n0.1,\n0.2,3.0\n")
    np.testing.assert_array_equal(np.isnan(degrees(found, Joint.LEFT_KNEE)), [False, True, False])


def test_events_and_strides_have_tables_of_their_own(read: Read) -> None:
    events = read("time_s,side,event\n2.5,left,initial_contact\n1.5,left,initial_contact\n2.1,right,toe_off\n")
    assert events.source == "events"
    np.testing.assert_array_equal(events.trials[0].events[Side.LEFT]["initial_contact"], [1.5, 2.5])
    assert set(events.trials[0].events[Side.RIGHT]) == {"toe_off"}
    strides = read("side,start_s,end_s,stride_length_m\nright,1.0,2.1,1.31\n")
    np.testing.assert_array_equal(strides.trials[0].strides[Side.RIGHT], [[1.0, 2.1, 1.31]])


def test_what_is_no_reference_is_refused_with_what_where_and_what_to_do(
    read: Read, snapshot: SnapshotAssertion
) -> None:
    contents = (
        "time_s,hip\n0,1\n",
        "time_s,left_knee\n0.0,1\n0.2,2\n0.1,3\n",
        "time_s,left_knee\n0.0,one\n",
        "time_s,left_knee\n,1\n",
        "time_s,side,event\n1,left,landing\n",
        "time_s,side,event\n1,middle,toe_off\n",
        "<xml>\n",
        "",
    )
    assert {content.replace("\n", " / "): refused(read, content) for content in contents} == snapshot


def test_a_folder_and_a_file_that_is_not_there_are_refused(tmp_path: Path) -> None:
    assert "this is a folder. Give the reference file" in refused(read_reference, tmp_path)
    assert "this file does not exist" in refused(read_reference, tmp_path / "gone.csv")


def motion(in_degrees: str = "yes", names: str = "time\tpelvis_tilt\tknee_angle_r\tankle_angle_l") -> str:
    values = KNEE_DEG if in_degrees == "yes" else np.deg2rad(KNEE_DEG)
    rows = [f"{t:.4f}\t0.1\t{knee:.8f}\tnan" for t, knee in zip(TIME_S, values, strict=True)]
    head = (
        f"Coordinates\nversion=1\nnRows={len(rows)}\nnColumns=4\ninDegrees={in_degrees}\n\nUnits are S.I.\nendheader\n"
    )
    return head + names + "\n" + "\n".join(rows) + "\n"


@pytest.mark.parametrize("in_degrees", ["yes", "no"])
def test_opensim_states_whether_it_is_degrees(read: Read, in_degrees: str) -> None:
    found = read(motion(in_degrees))
    assert found.format == "opensim"
    np.testing.assert_allclose(degrees(found, Joint.RIGHT_KNEE), KNEE_DEG, atol=1e-5)
    assert np.isnan(degrees(found, Joint.LEFT_ANKLE)).all()


def test_a_state_is_named_by_its_path(read: Read) -> None:
    state = "/jointset/walker_knee_r/knee_angle_r/"
    found = read(motion("no", f"time\t{state}speed\t{state}value\tpelvis_tx"))
    assert set(found.trials[0].angles) == {Joint.RIGHT_KNEE}
    np.testing.assert_allclose(degrees(found, Joint.RIGHT_KNEE), KNEE_DEG, atol=1e-5)


def test_an_opensim_file_without_angles_is_refused(read: Read, snapshot: SnapshotAssertion) -> None:
    contents = {
        "other names": motion(names="time\tpelvis_tilt\tpelvis_list\tlumbar"),
        "cut off": motion()[:-30],
        "orientations": motion().replace("Coordinates", "DataType=Quaternion"),
        "no columns": "Coordinates\nendheader\n",
        "no rows": "Coordinates\nendheader\ntime\tknee_angle_r\n",
    }
    assert {case: refused(read, content) for case, content in contents.items()} == snapshot


def visual3d(time: str = "TIME", knee: str = "RKneeAngle") -> str:
    head = [
        ["", r"D:\lab\walk 1.c3d", r"D:\lab\walk 1.c3d", r"D:\lab\walk 1.c3d", r"D:\lab\walk 2.c3d"],
        ["", time, knee, knee, knee],
        ["", "FRAME_NUMBERS", "LINK_MODEL_BASED", "LINK_MODEL_BASED", "LINK_MODEL_BASED"],
        ["", "ORIGINAL", "ORIGINAL", "ORIGINAL", "ORIGINAL"],
        ["ITEM", "X", "X", "Y", "X"],
    ]
    rows = [
        [str(k + 1), f"{t:.4f}", f"{-a:.6f}", "99.0", f"{a:.6f}"]
        for k, (t, a) in enumerate(zip(TIME_S, KNEE_DEG, strict=True))
    ]
    for row in rows[40:]:
        row[4] = ""  # the second trial is shorter
    return "\n".join("\t".join(row) for row in [*head, *rows]) + "\n"


def test_visual3d_has_trials_beside_one_another(read: Read) -> None:
    found = read(visual3d())
    assert found.format == "visual3d"
    assert [trial.name for trial in found.trials] == ["walk 1", "walk 2"]
    np.testing.assert_allclose(degrees(found, Joint.RIGHT_KNEE), -KNEE_DEG, atol=1e-5)
    second = degrees(found, Joint.RIGHT_KNEE, 1)
    np.testing.assert_allclose(second[:40], KNEE_DEG[:40], atol=1e-5)
    assert np.isnan(second[40:]).all()


def test_a_visual3d_text_that_lacks_something_is_refused(read: Read, snapshot: SnapshotAssertion) -> None:
    contents = {
        "no times": visual3d(time="FRAMES"),
        "other signals": visual3d(knee="RElbowAngle"),
        "cut off": visual3d() + "61\t0.1\n",
    }
    assert {case: refused(read, content) for case, content in contents.items()} == snapshot


@pytest.mark.parametrize(
    ("joint", "names"),
    [
        (Joint.LEFT_KNEE, "LKneeAngles; LKNEE_ANGLE; LKneeAngles_SHAPE"),
        (Joint.RIGHT_KNEE, "r_kne_angle"),
        (Joint.LEFT_ANKLE, "Left Ankle Angle"),
        (Joint.RIGHT_ANKLE, "patient:RAnkleAngles"),
        (Joint.LEFT_HIP, "LHipAngles; Left Hip Angle"),
        (None, "LKneeMoment; LKNE; RHIP; LPelvisAngles; KneeAngle; LKneeAngleVelocity; Left Right Knee"),
    ],
)
def test_a_signal_is_reported_by_its_name(joint: Joint | None, names: str) -> None:
    for name in names.split("; "):
        assert joint_of_name(name) is joint, name


def c3d_of(path: Path, points: dict[str, np.ndarray], residual: np.ndarray | None = None) -> bytes:
    """A C3D of points (3, n) at 100 Hz with two events, as bytes."""
    c3d = ezc3d.c3d()
    values = np.ones((4, len(points), len(TIME_S)))
    values[:3] = np.stack(list(points.values()), axis=1)
    c3d["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    c3d["parameters"]["POINT"]["LABELS"]["value"] = list(points)
    c3d["data"]["points"] = values
    if residual is not None:
        c3d["data"]["meta_points"]["residuals"] = np.tile(residual, (len(points), 1))[None]
    c3d.add_parameter("EVENT", "USED", [2])
    c3d.add_parameter("EVENT", "CONTEXTS", ["Left", "Right"])
    c3d.add_parameter("EVENT", "LABELS", ["Foot Strike", "Foot Off"])
    c3d.add_parameter("EVENT", "TIMES", np.array([[0.0, 1.0], [0.31, 2.5]]))
    c3d.write(str(path))
    return path.read_bytes()


def bent(angle_deg: np.ndarray) -> np.ndarray:
    return np.stack([angle_deg, 0.5 + 0 * angle_deg, 0.5 + 0 * angle_deg])


def test_a_c3d_has_angles_by_name_events_and_gaps_where_residuals_say_so(read: Read, tmp_path: Path) -> None:
    residual = np.zeros(len(TIME_S))
    residual[10:15] = -1.0
    points = {"P1:LKneeAngles": bent(KNEE_DEG), "P1:RAnkleAngles": bent(ANKLE_DEG), "P1:LKNE": bent(KNEE_DEG)}
    found = read(c3d_of(tmp_path / "made.c3d", {k: v for k, v in points.items() if k != "P1:LKNE"}, residual))
    assert (found.format, found.source) == ("c3d", "angles")
    knee = degrees(found, Joint.LEFT_KNEE)
    assert np.isnan(knee[10:15]).all()
    np.testing.assert_allclose(np.delete(knee, range(10, 15)), np.delete(KNEE_DEG, range(10, 15)), atol=1e-4)
    np.testing.assert_allclose(np.diff(found.trials[0].angles[Joint.LEFT_KNEE][0]), 0.01)
    np.testing.assert_allclose(found.trials[0].events[Side.LEFT]["initial_contact"], [0.31], atol=1e-6)
    np.testing.assert_allclose(found.trials[0].events[Side.RIGHT]["toe_off"], [62.5], atol=1e-4)


def c3d_by_hand(points: np.ndarray, processor: int, scale: float, frames: float, analogs: int = 0) -> bytes:
    """A C3D of points (n, k, 3) at 100 Hz, byte by byte by the format's guide: any processor, integers or floats."""
    order, n, k = ">" if processor == 86 else "<", len(points), points.shape[1]

    def real(value: float) -> bytes:
        packed = struct.pack(f"{order}f", value * (4.0 if processor == 85 else 1.0))
        return packed[2:] + packed[:2] if processor == 85 else packed

    def parameter(name: str, kind: int, shape: tuple[int, ...], content: bytes) -> bytes:
        data = struct.pack("bB", kind, len(shape)) + bytes(shape) + content + b"\0"
        return struct.pack("bb", len(name), 1) + name.encode() + struct.pack(f"{order}h", len(data) + 2) + data

    labels = b"".join(name.encode().ljust(12) for name in ("LKneeAngles", "RKneeAngles")[:k])
    group = struct.pack("bb", 5, -1) + b"POINT" + struct.pack(f"{order}h", 3) + b"\0"
    written = [
        group,
        parameter("USED", 2, (), struct.pack(f"{order}h", k)),
        parameter("SCALE", 4, (), real(scale)),
        parameter("RATE", 4, (), real(100.0)),
        parameter("LABELS", -1, (12, k), labels),
        parameter("FRAMES", 4, (), real(frames)),
    ]
    body = (bytes([1, 80, 1, processor]) + b"".join(written)).ljust(512, b"\0")
    header = struct.pack("BB", 2, 80) + struct.pack(f"{order}5H", k, analogs, 1, min(n, 65_535), 10)
    header += real(scale) + struct.pack(f"{order}H", 3)
    data = b""
    for frame in points:
        words = [value for point in frame for value in (*point, 0.0 if np.isfinite(point).all() else -1.0)]
        words = [0.0 if not np.isfinite(value) else value for value in words] + [7.0] * analogs
        if scale > 0:
            data += struct.pack(f"{order}{len(words)}h", *(round(w / scale) if w != -1.0 else -1 for w in words))
        else:
            data += b"".join(map(real, words))
    return header.ljust(512, b"\0") + body + data


@pytest.mark.parametrize("processor", [84, 85, 86])
@pytest.mark.parametrize("scale", [-1.0, 0.01])
@pytest.mark.parametrize("analogs", [0, 3])
def test_a_c3d_of_any_processor_is_read_with_frames_as_a_float(
    read: Read, processor: int, scale: float, analogs: int
) -> None:
    points = np.stack([bent(KNEE_DEG).T, bent(-KNEE_DEG).T], axis=1)
    points[10:15, 0] = np.nan
    found = read(c3d_by_hand(points, processor, scale, len(points), analogs))
    knee = degrees(found, Joint.LEFT_KNEE)
    assert np.isnan(knee[10:15]).all()
    np.testing.assert_allclose(np.delete(knee, range(10, 15)), np.delete(KNEE_DEG, range(10, 15)), atol=0.006)
    np.testing.assert_allclose(degrees(found, Joint.RIGHT_KNEE), -KNEE_DEG, atol=0.006)
    assert found.trials[0].angles[Joint.LEFT_KNEE][0][0] == 0.0


def test_a_c3d_of_more_frames_than_16_bits_count_is_read_whole(read: Read) -> None:
    """Frames are those of the file: the header ends at 65 535."""
    many = 70_000
    one = c3d_by_hand(np.ones((1, 1, 3)), 84, -1.0, 65_535.0)
    found = read(one[:8] + struct.pack("<H", 65_535) + one[10:] + one[1024:] * (many - 1))
    assert len(degrees(found, Joint.LEFT_KNEE)) == many


def leg(turn: np.ndarray | None = None) -> dict[str, np.ndarray]:
    """Markers (3, n) in mm of a right leg that goes along y with its joints bent by KNEE_DEG and ANKLE_DEG."""
    thigh = np.deg2rad(10.0) + 0 * TIME_S  # forward of the vertical
    shank = thigh - np.deg2rad(KNEE_DEG)
    foot = shank + np.deg2rad(ANKLE_DEG)  # toes above the level
    forward, up = np.array([[0.0], [1.0], [0.0]]), np.array([[0.0], [0.0], [1.0]])
    down = {name: forward * np.sin(a) - up * np.cos(a) for name, a in (("thigh", thigh), ("shank", shank))}
    hip = forward * (1200 * TIME_S) + up * 900 + np.array([[90.0], [0.0], [0.0]])
    knee = hip + 430 * down["thigh"]
    ankle = knee + 430 * down["shank"]
    toe = ankle + 200 * (forward * np.cos(foot) + up * np.sin(foot))
    return {"RHIP": hip, "RKNE": knee, "RANK": ankle, "RHEE": ankle + 0 * toe, "RTOE": toe}


def test_a_c3d_without_angles_has_them_made_of_markers(read: Read, tmp_path: Path) -> None:
    found = read(c3d_of(tmp_path / "made.c3d", leg()))
    assert found.source == "markers"
    np.testing.assert_allclose(degrees(found, Joint.RIGHT_KNEE), KNEE_DEG, atol=0.01)
    np.testing.assert_allclose(degrees(found, Joint.RIGHT_ANKLE), ANKLE_DEG, atol=0.01)


def test_markers_may_go_any_way_and_one_that_is_hidden_is_a_gap() -> None:
    points = {label: np.stack([-p[1], p[2], -p[0]], axis=1) for label, p in leg().items()}  # y up, walking along -x
    markers = {at: p for label, p in points.items() if (at := landmark_of(label)) is not None}
    assert len(markers) == 5
    hidden = next(p for (_, landmark), p in markers.items() if landmark == "toe")
    hidden[20:25] = np.nan
    angles = angles_of_markers(markers)
    np.testing.assert_allclose(np.rad2deg(angles[Joint.RIGHT_KNEE]), KNEE_DEG, atol=0.01)
    ankle = np.rad2deg(angles[Joint.RIGHT_ANKLE])
    assert np.isnan(ankle[20:25]).all()
    np.testing.assert_allclose(np.delete(ankle, range(20, 25)), np.delete(ANKLE_DEG, range(20, 25)), atol=0.01)


def test_a_c3d_of_other_points_and_a_broken_one_are_refused(read: Read, tmp_path: Path) -> None:
    content = c3d_of(tmp_path / "made.c3d", {"C7": bent(KNEE_DEG)})
    assert "the file contains neither hip, knee or ankle angles nor the markers to compute them" in refused(
        read, content
    )
    for length in (512, 700, len(content) // 2, len(content) - 512):
        cut_off = refused(read, content[:length])
        assert "ends before the end of its data; it may have been cut off. Copy the file again" in cut_off


def test_an_answer_that_no_reader_gives_is_not_believed(tmp_path: Path) -> None:
    path = tmp_path / "reference"
    path.write_text(csv_of("time_s,left_knee", TIME_S, KNEE_DEG), encoding="utf-8")
    arrays: list[Array] = []
    details = details_of(read_reference(path), arrays)
    assert reference_from(details, arrays).trials[0].angles.keys() == {Joint.LEFT_KNEE}
    (trial,) = details["trials"]
    for broken in (
        {**details, "format": "exe"},
        {**details, "trials": [{**trial, "angles": {"left_elbow": [0, 1]}}]},
        {**details, "trials": [{**trial, "angles": {"left_knee": [0, 9]}}]},
        {**details, "trials": [{**trial, "name": 5}]},
        {**details, "trials": [{**trial, "strides": {"left": 0}}]},
        {**details, "trials": [{**trial, "events": {"left": {"landing": 0}}}]},
    ):
        with pytest.raises(BrokenAnswerError):
            reference_from(broken, arrays)
    with pytest.raises(BrokenAnswerError):
        reference_from(details, [arrays[0][::-1], arrays[1]])

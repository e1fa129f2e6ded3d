"""Tests that a session folder comes back as it was written. A spoilt one is refused in words."""

import os
from collections import Counter
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from syrupy.assertion import SnapshotAssertion

from core.analysis import analyse
from core.body import LEG_JOINTS, LEG_SITES, Side, Site
from core.findings import Finding, Severity
from core.samples import ImuBlock, RateKind, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.files import session_folder, site_files
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import read_session, write_session
from devices.files.site_files import NUMERIC
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.devices.files.conftest import COLUMNS, ROWS, TOML, MakeSession
from tests.simulated import session_of
from tests.trials_of_files import refused

PLACE = "walk 1, left_thigh"
MOST_READS = 9  # of one file, by the analysis of a session too large to be held; each takes seconds

some_text = st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=12)


def table(*rows: str, columns: str = COLUMNS, end: str = "\n") -> str:
    return "\n".join([columns, *rows]) + end


def thigh(folder: Path) -> ImuBlock:
    return read_session(folder).recordings[0].imu[Site.LEFT_THIGH]


def refusal(folder: Path) -> str:
    return refused(read_session, folder)


def keys(session: Session) -> list[tuple[str, str, object]]:
    return [(finding.key, finding.where, finding.numbers.get("name")) for finding in session.findings]


def findings(session: Session) -> list[str]:
    return [f"{found.key}: {found.where} {dict(found.numbers)}" for found in session.findings]


def simple_block(n: int = 3, sensor: str = "left_thigh") -> ImuBlock:
    rng = np.random.default_rng(n)
    return ImuBlock(sensor, np.arange(n) / 100, rng.normal(size=(n, 3)), rng.normal(size=(n, 3)))


def walk(imu: dict[Site, ImuBlock], name: str = "walk 1", folder: str = "walk_1") -> Recording:
    return Recording(name, RecordingKind.WALKING, folder, imu)


# --- what is read


def test_a_session_folder_is_read(make_session: MakeSession) -> None:
    session = read_session(make_session())
    assert session.findings == ()
    assert [(r.name, r.kind, r.folder) for r in session.recordings] == [("walk 1", "walking", "walk_1")]
    block = session.recordings[0].imu[Site.LEFT_THIGH]
    np.testing.assert_array_equal(block.time_s, [0.0, 0.01, 0.02])
    np.testing.assert_array_equal(block.acc_m_s2, [[0.1, 0.2, 9.8]] * 3)
    np.testing.assert_array_equal(block.gyr_rad_s, [[0.01, 0.02, 0.03]] * 3)
    assert block.q_earth_from_sensor is None
    assert block.mag is None


def test_parquet_holds_the_same_samples(make_session: MakeSession) -> None:
    folder = make_session({})
    columns: dict[str, object] = {name: np.arange(4.0) + i for i, name in enumerate(COLUMNS.split(","))}
    columns["gyr_x_rad_s"] = pa.array([1, None, 3, 4], pa.int32())
    columns["battery"] = pa.array([90, 91, 92, 93])
    columns["remark"] = pa.array(["a", None, "c\nd", "d"])
    pq.write_table(pa.table(columns), folder / "walk_1" / "left_thigh.parquet")
    session = read_session(folder)
    block = session.recordings[0].imu[Site.LEFT_THIGH]
    np.testing.assert_array_equal(block.acc_m_s2[:, 1], np.arange(4.0) + 2)
    np.testing.assert_array_equal(block.gyr_rad_s[:, 0], [1, np.nan, 3, 4])
    np.testing.assert_array_equal(block.unknown["battery"], [90, 91, 92, 93])
    assert list(block.unknown["remark"]) == ["a", "", "c\nd", "d"]
    assert keys(session) == [("unknown_column", PLACE, "battery"), ("unknown_column", PLACE, "remark")]


QUATERNION = ",mag_x,mag_y,mag_z,quat_w,quat_x,quat_y,quat_z"
DRESSED = [
    "\ufeff" + ", ".join(f'"{name}"' for name in COLUMNS.split(",")),
    ROWS[0],
    ROWS[1].replace(",", " , "),
    ROWS[2],
]
TEXTS = {
    "quotation marks, blanks, other line ends and a mark of UTF-8": "\r\n".join([*DRESSED, "", ""]),
    "columns in another order": table("3,2,1,6,5,4,0", columns=",".join(reversed(COLUMNS.split(",")))),
    "an empty cell is NaN and a missing row a gap": table("0,,1,1,1,1,1", "0.01, ,nan,1,1,1,1", "5,1,1,1,1,1,1"),
    "no row": table(),
    "one row": table("0,1,1,1,1,1,1"),
    "five rows": table(*[f"{i},1,1,1,1,1,1" for i in range(5)]),
    "an orientation and a field": table("0,1,1,1,1,1,1,7,8,9,1,0,0,0", columns=COLUMNS + QUATERNION),
    "half an orientation is unknown": table("0,1,1,1,1,1,1,0.5", columns=COLUMNS + ",quat_w"),
    "of a doubled stamp the first row stays": table("0,1,1,1,1,1,1", "0,2,2,2,2,2,2", "1,3,3,3,3,3,3"),
    "infinite values are missing": table("0,inf,1,1,1,1,1e999"),
    "a last line without end": table("0,1,1,1,1,1,1", end=""),
    "delimiters at the end of every line are nothing": table(*[row + ",," for row in ROWS], columns=COLUMNS + ",,"),
}


def test_odd_texts_are_read_and_what_is_lost_is_a_finding(
    make_session: MakeSession, snapshot: SnapshotAssertion
) -> None:
    found = {}
    for case, text in TEXTS.items():
        session = read_session(make_session({"left_thigh.csv": text}))
        block = session.recordings[0].imu[Site.LEFT_THIGH]
        arrays = {
            name: getattr(block, name) for name in ("time_s", "acc_m_s2", "gyr_rad_s", "mag", "q_earth_from_sensor")
        }
        arrays |= block.unknown
        samples = {name: str(array.tolist()) for name, array in arrays.items() if array is not None}
        found[case] = (samples, findings(session))
    assert found == snapshot


SECOND = '[[recordings]]\nname = "walk 2"\nkind = "walking"\nfolder = "walk_2"\n'


def test_what_is_odd_about_files_is_found_in_the_text_then_in_the_files_then_in_both(
    make_session: MakeSession, snapshot: SnapshotAssertion
) -> None:
    def found(*others: str, toml: str = "", of_second: str | None = None) -> dict[str, object]:
        files = {"left_thigh.csv": table(*ROWS)} | dict.fromkeys(others, "\0")
        folder = make_session(files, toml="\ufeff" + (TOML + toml).replace("\n", "\r\n"))
        (folder / "walk_2").mkdir()
        if of_second is not None:
            (folder / "walk_2" / "left_thigh.csv").write_text(of_second)
        session = read_session(folder)
        return {"sites": [list(map(str, one.imu)) for one in session.recordings], "findings": findings(session)}

    changes = SECOND + 'sensors = {left_thigh = "B"}\n'
    assert {
        "nothing but other line ends": found(),
        "files without a site, but for those of the system": found("video.mp4", ".DS_Store"),
        "a recording without data beside one with": found(toml=SECOND),
        "a sensor that changes": found(toml=changes, of_second=table(*ROWS)),
        "all of them": found("video.mp4", toml='weather = "rain"\n' + changes, of_second=table(*ROWS)),
    } == snapshot


UNKNOWN = """\
format = "gaitwright-session/1"
clinic = "north"
[session]
room = 4
[patient]
shoe = 42.5
[sensors.left_thigh]
colour = "red"
[sensors.sternum]
serial = "P"
[zero]
left_hip = 3.0
[sign]
left_hip = 1
[extra]
deep = {list = [1, 2, {a = 2024-01-01}]}
[[recordings]]
name = "walk 1"
kind = "walking"
folder = "walk_1"
speed = "slow"
sensors = 6
rates_derived = ["hip"]
strides_left_out = {left = [3.5, "late"]}
"""


def test_unknown_keys_are_reported_and_survive(
    make_session: MakeSession, tmp_path: Path, snapshot: SnapshotAssertion
) -> None:
    session = read_session(make_session(toml=UNKNOWN))
    assert sorted(findings(session)) == snapshot
    grave = {f.where for f in session.findings if f.severity is not Severity.INFO}
    assert grave == {"zero", "sign"}
    write_session(session, tmp_path / "copy")
    assert_same(read_session(tmp_path / "copy"), session)


def test_unknown_columns_are_reported_and_survive(make_session: MakeSession, tmp_path: Path) -> None:
    names = COLUMNS + ',"a ""b"", c",steps'
    session = read_session(make_session({"left_thigh.csv": table('0,1,1,1,1,1,1," x, ""y""",007', columns=names)}))
    assert keys(session) == [("unknown_column", PLACE, 'a "b", c'), ("unknown_column", PLACE, "steps")]
    write_session(session, tmp_path / "copy")
    again = read_session(tmp_path / "copy")
    assert_same(again, session)
    unknown = again.recordings[0].imu[Site.LEFT_THIGH].unknown
    assert {name: list(values) for name, values in unknown.items()} == {'a "b", c': [' x, "y"'], "steps": ["007"]}


# --- refusals


WRONG_TEXTS: dict[str, str | bytes] = {
    "nothing": "",
    "empty lines": "\n\n",
    "another table": "a,b\n1,2\n",
    "a column too few": table("0,1,1,1,1,1", columns=COLUMNS.replace("acc_y_m_s2,", "")),
    "a column twice": table(*ROWS, columns=COLUMNS.replace("acc_y", "acc_x")),
    "the clock goes back": table("0,1,1,1,1,1,1", "1,1,1,1,1,1,1", "0.5,1,1,1,1,1,1"),
    "the clock of 1970 goes back": table("1700000000.5,1,1,1,1,1,1", "1700000000.25,1,1,1,1,1,1"),
    "the clock goes back, empty lines": table("0,1,1,1,1,1,1", "", "1,1,1,1,1,1,1", "", "0.5,1,1,1,1,1,1"),
    "a word in a cell": table("0,1,1,1,1,1,1", "1,1,x1,1,1,1,1"),
    "a hexadecimal number": table("0,1,1,1,1,1,1", "1,1,0x10,1,1,1,1"),
    "semicolons": table("0;1;1;1;1;1;1", columns=COLUMNS.replace(",", ";")),
    "cut off": table("0,1,1,1,1,1,1", "1,1,1", end=""),
    "a short last line": table("0,1,1,1,1,1,1", "1,1,1"),
    "a short line": table("0,1,1", "1,1,1,1,1,1,1"),
    "a long line": table("0,1,1,1,1,1,1,1"),
    "no time in the first row": table(",1,1,1,1,1,1"),
    "NaN as a time": table("0,1,1,1,1,1,1", "nan,1,1,1,1,1,1"),
    "an infinite time": table("inf,1,1,1,1,1,1"),
    "a quotation mark that is not closed": table('0,1,1,1,1,1,1,"a', "1,1,1,1,1,1,1,b", columns=COLUMNS + ",x"),
    "a quotation mark in a number": table('0,1,1,1,1,1,"1'),
    "other bytes in a number": COLUMNS.encode() + b"\n0,1,1,1,1,1,\xff\n",
    "other bytes in a text": (COLUMNS + ",x").encode() + b"\n0,1,1,1,1,1,1,\xff\n",
    "carriage returns alone": table(*ROWS).replace("\n", "\r"),
    "a carriage return between rows": table("1,1,1,1,1,1,1\r0,1,1,1,1,1,1"),
    "a picture": b"\xff\xd8\xff",
    "an archive": b"PK\0\0",
    "a line without end": b"x" * 200_000,
}


def test_a_wrong_text_is_refused(make_session: MakeSession, snapshot: SnapshotAssertion) -> None:
    assert {case: refusal(make_session({"left_thigh.csv": text})) for case, text in WRONG_TEXTS.items()} == snapshot


def test_other_wrong_files_are_refused(make_session: MakeSession, snapshot: SnapshotAssertion) -> None:
    def of_parquet(columns: dict[str, list[object]]) -> str:
        folder = make_session({})
        pq.write_table(pa.table(columns), folder / "walk_1" / "left_thigh.parquet")
        return refusal(folder)

    def of_a_folder_as_file() -> str:
        folder = make_session({})
        (folder / "walk_1" / "left_thigh.csv").mkdir()
        return refusal(folder)

    numbers: dict[str, list[object]] = {name: [0.0, 1.0] for name in COLUMNS.split(",")}
    assert {
        "the folder of a walk is missing": refusal(make_session(toml=TOML.replace("walk_1", "walk_9"))),
        "session.toml in UTF-16": refusal(make_session(toml=b"\xff\xfe")),
        "Parquet, a column too few": of_parquet({"time_s": [0.0, 1.0]}),
        "Parquet, texts as times": of_parquet(numbers | {"time_s": ["a", "b"]}),
        "Parquet, the clock goes back": of_parquet(numbers | {"time_s": [1.0, 0.0]}),
        "no file of a site": refusal(make_session({"notes.txt": "x"})),
        "a folder in place of a file": of_a_folder_as_file(),
    } == snapshot


def test_what_others_report_of_a_file_is_in_the_refusal(make_session: MakeSession) -> None:
    """Python, the system and Arrow; their words change with them."""
    assert "session.toml: the file is not TOML" in refusal(make_session(toml="x = "))
    too_long = refusal(make_session(toml=TOML.replace("walk_1", "w" * 5000)))
    assert "the file or folder cannot be read (File name too long)" in too_long
    assert "not a readable Parquet file" in refusal(make_session({"left_thigh.parquet": table(*ROWS)}))


def test_a_folder_without_session_toml_is_refused(tmp_path: Path) -> None:
    assert "it contains no session.toml" in refusal(tmp_path)
    assert "it contains no session.toml" in refusal(tmp_path / "none")


def test_a_site_twice_is_refused(make_session: MakeSession) -> None:
    folder = make_session({"left_thigh.csv": table(*ROWS), "left_thigh.parquet": b""})
    assert "walk_1: left_thigh exists twice: left_thigh.csv and left_thigh.parquet" in refusal(folder)


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_links_out_of_the_session_are_refused(make_session: MakeSession, tmp_path: Path) -> None:
    folder = make_session({})
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "left_thigh.csv").write_text(table(*ROWS))
    link = folder / "walk_1" / "left_thigh.csv"
    link.symlink_to(outside / "left_thigh.csv")
    assert "walk_1/left_thigh.csv: the path leads out of the session folder" in refusal(folder)
    (folder / "session.toml").rename(outside / "session.toml")
    (folder / "session.toml").symlink_to(outside / "session.toml")
    assert "session.toml: the path leads out of the session folder" in refusal(folder)
    (folder / "session.toml").unlink()
    (outside / "session.toml").rename(folder / "session.toml")
    link.unlink()
    (folder / "walk_1").rmdir()
    (folder / "walk_1").symlink_to(outside)
    assert "walk_1: the path leads out of the session folder" in refusal(folder)
    (folder / "walk_1").unlink()
    (folder / "walk_1").symlink_to(folder / "walk_1")
    assert "walk_1" in refusal(folder)


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="needs a user whom permissions stop")
def test_a_file_that_may_not_be_read_is_refused(make_session: MakeSession) -> None:
    folder = make_session()
    (folder / "walk_1" / "left_thigh.csv").chmod(0)
    assert "cannot be read (Permission denied)" in refusal(folder)


# --- writing


def assert_same(one: Session, other: Session) -> None:
    """Equal in all but the findings, samples bit for bit."""
    for field in ("patient", "sensors", "turned_sign", "started", "operator", "surface", "notes", "software"):
        assert getattr(one, field) == getattr(other, field)
    assert (one.is_simulated, one.unknown) == (other.is_simulated, other.unknown)
    assert dict(one.zero_rad) == pytest.approx(dict(other.zero_rad), abs=1e-10)
    assert len(one.recordings) == len(other.recordings)
    for a, b in zip(one.recordings, other.recordings, strict=True):
        for field in ("name", "kind", "folder", "condition", "started", "note", "unknown"):
            assert getattr(a, field) == getattr(b, field)
        assert (a.is_kept, a.is_restrapped_before) == (b.is_kept, b.is_restrapped_before)
        assert list(a.imu) == list(b.imu)
        for site in a.imu:
            assert_same_block(a.imu[site], b.imu[site])


def assert_same_block(one: ImuBlock, other: ImuBlock) -> None:
    assert (one.sensor, one.is_rate_derived) == (other.sensor, other.is_rate_derived)
    for name in ("time_s", "acc_m_s2", "gyr_rad_s", "q_earth_from_sensor", "mag"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert list(one.unknown) == list(other.unknown)
    for name, column in one.unknown.items():
        assert [str(value) for value in column] == [str(value) for value in other.unknown[name]]


def is_a_strange_name(text: str) -> bool:
    return text not in {"", *NUMERIC} and "\ufeff" not in text


measured = st.floats(allow_infinity=False)


@st.composite
def blocks(draw: st.DrawFn) -> ImuBlock:
    stamps = draw(st.lists(st.floats(allow_nan=False, allow_infinity=False), max_size=6, unique=True))
    n = len(stamps)
    optional = (
        [st.none(), npst.arrays(float, (n, 4), elements=measured)],
        [
            st.none(),
            npst.arrays(float, (n, 3), elements=measured),
        ],
    )
    names = draw(st.lists(some_text.map(str.strip).filter(is_a_strange_name), max_size=2, unique=True))
    return ImuBlock(
        sensor=draw(some_text.filter(bool)),
        time_s=np.array(sorted(stamps), dtype=float),
        gyr_rad_s=draw(npst.arrays(float, (n, 3), elements=measured)),
        acc_m_s2=draw(npst.arrays(float, (n, 3), elements=measured)),
        q_earth_from_sensor=draw(st.one_of(optional[0])),
        mag=draw(st.one_of(optional[1])),
        is_rate_derived=draw(st.booleans()),
        unknown={name: np.array(draw(st.lists(some_text, min_size=n, max_size=n)), dtype=object) for name in names},
    )


@st.composite
def sessions(draw: st.DrawFn) -> Session:
    times = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=3).map(sorted).map(tuple)
    folders = draw(st.lists(st.sampled_from(["standing", "walk_1", "a/b", "ünì 2"]), min_size=1, unique=True))
    recordings = tuple(
        Recording(
            name=f"{folder} {draw(some_text)}",
            kind=draw(st.sampled_from(RecordingKind)),
            folder=folder,
            imu={site: draw(blocks()) for site in [Site.LEFT_THIGH, Site.RIGHT_FOOT][: draw(st.integers(1, 2))]},
            condition=draw(some_text),
            is_kept=draw(st.booleans()),
            note=draw(st.text(max_size=9).filter(str.isprintable)),
            is_restrapped_before=draw(st.booleans()),
            left_out_s=draw(st.dictionaries(st.sampled_from(Side), times)),
        )
        for folder in folders
    )
    return Session(
        recordings=recordings,
        patient=Patient(code=draw(some_text), birth_year=draw(st.none() | st.integers(1900, 2020))),
        sensors={Site.LEFT_THIGH: SensorInfo(serial=draw(some_text), rate_kind=draw(st.sampled_from(RateKind)))},
        zero_rad=draw(st.dictionaries(st.sampled_from(LEG_JOINTS), st.floats(-3, 3))),
        turned_sign=draw(st.dictionaries(st.sampled_from(LEG_JOINTS), st.sampled_from([1, -1]))),
        notes=draw(some_text),
        software="gaitwright 0",
        is_simulated=draw(st.booleans()),
        unknown=draw(st.dictionaries(some_text.map(lambda t: "x" + t), st.integers(0, 9), max_size=2)),
    )


@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
@given(session=sessions())
def test_what_is_written_is_read_back_bit_for_bit(session: Session, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("round") / "session"
    write_session(session, folder)
    again = read_session(folder)
    assert_same(again, session)
    bytes_before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    write_session(again, folder)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == bytes_before


def test_nothing_is_left_beside_what_was_written(tmp_path: Path) -> None:
    session = Session((walk({Site.LEFT_THIGH: simple_block()}),))
    write_session(session, tmp_path / "deep" / "session")
    write_session(session, tmp_path / "deep" / "session")
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["session"]


def test_a_line_end_in_an_unknown_text_becomes_a_blank(tmp_path: Path) -> None:
    unknown = {"a\nb": np.array(["c\r\nd"])}
    block = ImuBlock("left_thigh", np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3)), unknown=unknown)
    write_session(Session((walk({Site.LEFT_THIGH: block}),)), tmp_path / "session")
    again = thigh(tmp_path / "session").unknown
    assert {name: list(column) for name, column in again.items()} == {"a b": ["c d"]}


def test_an_unknown_column_does_not_replace_a_known_one(tmp_path: Path) -> None:
    block = ImuBlock("x", np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3)), unknown={"time_s": np.ones(1)})
    with pytest.raises(ValueError, match="the unknown column time_s"):
        write_session(Session((walk({Site.LEFT_THIGH: block}),)), tmp_path / "session")
    assert list(tmp_path.iterdir()) == []


def test_a_failing_write_leaves_the_old_session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session((walk({Site.LEFT_THIGH: simple_block()}),))
    write_session(session, tmp_path / "session")
    before = (tmp_path / "session" / "walk_1" / "left_thigh.csv").read_bytes()

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(session_folder, "write_site", fail)
    with pytest.raises(OSError, match="disk full"):
        write_session(Session((walk({Site.LEFT_THIGH: simple_block(9)}),)), tmp_path / "session")
    assert [path.name for path in tmp_path.iterdir()] == ["session"]
    assert (tmp_path / "session" / "walk_1" / "left_thigh.csv").read_bytes() == before


def test_a_rename_that_fails_puts_the_old_session_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session((walk({Site.LEFT_THIGH: simple_block()}),))
    write_session(session, tmp_path / "session")
    rename = Path.rename

    def fail(path: Path, target: Path) -> Path:
        if path.name == "new":
            raise OSError("in use")
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", fail)
    with pytest.raises(OSError, match="in use"):
        write_session(session, tmp_path / "session")
    assert len(thigh(tmp_path / "session")) == 3


def test_what_else_a_session_folder_holds_is_taken_along(tmp_path: Path) -> None:
    folder = tmp_path / "session"
    write_session(Session((walk({Site.LEFT_THIGH: simple_block()}),)), folder)
    (folder / "truth.csv").write_text("a")
    (folder / "walk_1" / "video.mp4").write_text("b")
    write_session(Session((walk({Site.RIGHT_FOOT: simple_block(sensor="right_foot")}),)), folder)
    files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    assert files == ["session.toml", "truth.csv", "walk_1/right_foot.csv", "walk_1/video.mp4"]


def test_a_folder_that_is_no_session_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "holiday.jpg").write_text("x")
    with pytest.raises(FileRefusedError, match="is not a session folder"):
        write_session(Session((walk({Site.LEFT_THIGH: simple_block()}),)), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["holiday.jpg"]


@pytest.mark.parametrize("folder", ["../out", "/tmp/out", ""])
def test_nothing_is_written_outside_of_the_folder(tmp_path: Path, folder: str) -> None:
    with pytest.raises(FileRefusedError, match="inside of the session folder"):
        write_session(Session((walk({Site.LEFT_THIGH: simple_block()}, folder=folder),)), tmp_path / "session")
    assert list(tmp_path.iterdir()) == []


# --- large sessions


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The files that are read, in order; every session counts as a large one."""
    read: list[Path] = []
    read_site = site_files.SiteFile.read

    def noting(file: site_files.SiteFile) -> object:
        read.append(file.path)
        return read_site(file)

    monkeypatch.setattr(session_folder, "HELD_BYTES", 10)
    monkeypatch.setattr(site_files.SiteFile, "read", noting)
    return read


def test_a_large_session_is_read_site_by_site(tmp_path: Path, reads: list[Path]) -> None:
    imu = {site: simple_block(4 + i, site) for i, site in enumerate(LEG_SITES)}
    write_session(Session((walk(imu),)), tmp_path / "session")
    found = read_session(tmp_path / "session").recordings[0]
    assert len(reads) == 6
    assert list(found.imu) == list(LEG_SITES)
    assert found.holds(Site.LEFT_FOOT)
    assert Site.LEFT_FOOT in found.imu
    assert len(reads) == 6  # asking which sites there are reads nothing
    for site in (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_THIGH, Site.LEFT_SHANK):
        assert_same_block(found.imu[site], imu[site])
    assert len(reads) == 8  # two are kept
    write_session(Session((found,)), tmp_path / "session")
    assert_same_block(read_session(tmp_path / "session").recordings[0].imu[Site.LEFT_FOOT], imu[Site.LEFT_FOOT])


def test_an_analysis_of_a_large_session_does_not_read_it_again_for_every_check(
    tmp_path: Path, reads: list[Path]
) -> None:
    made = session_of(WalkerSettings(recordings=(Standing(), FreeMotion(), Walk("walk", strides=10))))
    write_session(made, tmp_path / "session")
    found = analyse(read_session(tmp_path / "session"))
    assert set(found.recordings[-1].joints) == set(LEG_JOINTS)
    assert max(Counter(path for path in reads if path.parent.name == "walk").values()) <= MOST_READS


def test_no_session_of_the_shortest_numbers_that_is_held_has_more_samples_than_are_allowed() -> None:
    row = "0,0,0,0,0,0,0\n"
    in_memory = np.zeros(7).nbytes
    assert session_folder.HELD_BYTES / len(row) * in_memory <= session_folder.MOST_HELD_BYTES


def test_a_large_session_is_refused_at_once(make_session: MakeSession, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session_folder, "HELD_BYTES", 10)
    text = table("0,1,1,1,1,1,1", "1,1,1")
    assert "line 3" in refusal(make_session({"left_thigh.csv": table(*ROWS), "right_foot.csv": text}))


# --- spoilt files


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), kind=st.sampled_from(["left_thigh.csv", "left_thigh.parquet", "session.toml"]))
def test_spoilt_files_are_refused_or_read(
    data: st.DataObject, kind: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("spoilt")
    (folder / "walk_1").mkdir()
    (folder / "session.toml").write_text(UNKNOWN)
    path = folder / ("session.toml" if kind == "session.toml" else f"walk_1/{kind}")
    if kind.endswith("parquet"):
        pq.write_table(pa.table({name: [0.0, 1.0, 2.0] for name in (*COLUMNS.split(","), "x")}), path)
    else:
        (folder / "walk_1" / "left_thigh.csv").write_text(table(*[r + ",a" for r in ROWS], columns=COLUMNS + ",x"))
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(0, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    try:
        session = read_session(folder)
    except FileRefusedError as refused:
        stated = str(refused)
        assert stated.isprintable()
        return
    assert session.recordings


# --- findings of an import


def found_by_import() -> tuple[Finding, ...]:
    return (
        Finding("stamps_mended", Severity.WARNING, PLACE, {"count": 1, "left_out": 0, "first": 11, "off_s": 3.5}),
        Finding("not_synchronised", Severity.WARNING, PLACE),
        Finding("columns_left_out", Severity.INFO, PLACE, {"names": 'é, "x"'}),
    )


def test_what_an_import_found_is_kept_however_often_the_folder_is_written(tmp_path: Path) -> None:
    session = Session((walk({Site.LEFT_THIGH: simple_block()}),), findings=found_by_import(), unknown={"odd": {"a": 1}})
    for _ in range(3):
        write_session(session, tmp_path / "s")
        session = read_session(tmp_path / "s")
        assert session.findings[:3] == found_by_import()
        assert keys(session)[3:] == [("unknown_key", "session.toml", "odd")]
        assert session.unknown == {"odd": {"a": 1}}


def test_what_reading_finds_again_is_not_kept(make_session: MakeSession, tmp_path: Path) -> None:
    folder = make_session({"left_thigh.csv": table("0,1,1,1,1,1,1,5", "1,3,3,3,3,3,3,5", columns=f"{COLUMNS},odd")})
    write_session(read_session(folder), tmp_path / "s")
    assert "findings" not in (tmp_path / "s" / "session.toml").read_text()


@pytest.mark.parametrize(
    "other",
    [
        "findings = 1",
        'findings = ["a"]',
        '[[findings]]\nkey = "a"\nseverity = "bad"\nwhere = ""',
        '[[findings]]\nkey = "a"\nseverity = "info"\nwhere = ""\nnumbers = [1]',
        '[[findings]]\nkey = "a"\nseverity = "info"\nwhere = ""\nnumbers = {x = inf}',
        f'[[findings]]\nkey = "a"\nseverity = "info"\nwhere = ""\nnumbers = {{x = 1{"0" * 400}}}',
        '[[findings]]\nkey = "a"\nseverity = "info"\nwhere = ""\nmore = 1',
    ],
)
def test_findings_that_are_none_of_ours_are_an_unknown_key_and_stay(tmp_path: Path, other: str) -> None:
    write_session(Session((walk({Site.LEFT_THIGH: simple_block()}),)), tmp_path / "s")
    path = tmp_path / "s" / "session.toml"
    head, rest = path.read_text().split("\n", 1)
    path.write_text(f"{head}\n{other}\n{rest}" if other.startswith("findings") else f"{head}\n{rest}\n{other}\n")
    for _ in range(2):
        session = read_session(tmp_path / "s")
        assert keys(session) == [("unknown_key", "session.toml", "findings")]
        write_session(session, tmp_path / "s")


def test_an_analysis_knows_what_the_import_found(tmp_path: Path) -> None:
    session = Session((walk({Site.LEFT_THIGH: simple_block(600)}),), findings=found_by_import())
    write_session(session, tmp_path / "s")
    found = analyse(read_session(tmp_path / "s")).findings
    assert all(one in found for one in found_by_import())

"""Tests that every choice about a table is found, can be stated instead, and is kept by the table's fingerprint."""

from collections.abc import Callable
from dataclasses import fields, replace
from io import BufferedReader, FileIO
from pathlib import Path

import numpy as np
import pytest

from app.home.importing.table_words import stated_of
from devices.files import table_layout
from devices.files.answers import details_of, value_from
from devices.files.formats import format_of, read_trial
from devices.files.gathering import gather
from devices.files.limited_reader import LimitedReading
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import NO_CHOICES, NONE, TableChoices, TablePreview, column_named
from devices.files.table_layout import HEAD_BYTES, fingerprint_of
from devices.files.table_preview import preview_of
from tests.devices.files.test_public_layouts import (
    LEFT,
    RIGHT,
    ROWS,
    G,
    MovedSensor,
    a_letter,
    a_picture,
    commas_in_commas,
    lpms,
    no_header,
    rows_of,
    windows_excel,
    write,
)

NAMES = ("t", "p", "q", "r", "u", "v", "w")  # of which none states anything
STATED = TableChoices(acc=("p", "q", "r"), gyr=("u", "v", "w"), time="t")


def table(path: Path, *, names: tuple[str, ...] = NAMES, motion: MovedSensor = LEFT, by: str = ",") -> Path:
    body = rows_of(motion.time_s, motion.acc, motion.gyr, by=by)
    return write(path, [by.join(names), *body])


def block_of(preview: TablePreview, number: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    assert preview.refusal is None
    one = preview.sensors[number]
    return one.time_s, one.acc_m_s2, one.gyr_rad_s


def is_left(preview: TablePreview) -> bool:
    time_s, acc, gyr = block_of(preview)
    n = len(time_s)
    return bool(
        np.allclose(time_s - time_s[0], LEFT.time_s[:n], atol=1e-6)
        and np.allclose(acc, LEFT.acc[:n], atol=1e-5)
        and np.allclose(gyr, LEFT.gyr[:n], atol=1e-5)
    )


def test_columns_without_names_are_found_by_their_values(tmp_path: Path) -> None:
    for path in (table(tmp_path / "a.csv"), *no_header(tmp_path / "b")):
        preview = preview_of(path, NO_CHOICES)
        assert preview.is_by_values
        assert is_left(preview)
        assert preview.found.acc_unit == "m/s2"
        assert preview.found.gyr_unit == "rad/s"  # as gravity turns
        assert is_left(preview_of(path, preview.choices))  # what has to be stated for it to be read so
    assert preview.found.header_line == 0
    named = preview_of(table(tmp_path / "c.csv", names=("time_s", "ax", "ay", "az", "gx", "gy", "gz")), NO_CHOICES)
    assert is_left(named)
    assert not named.is_by_values
    assert named.choices == NO_CHOICES


CHOICES: dict[str, tuple[Callable[[Path], Path], TableChoices]] = {
    "header line": (
        lambda path: write(path, ["1,2,3,4,5,6,7", ",".join(NAMES), *rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr)]),
        replace(STATED, header_line=2),
    ),
    "separator": (
        lambda path: write(path, ["t|p|q|r|u|v|w", *rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr, by="|")]),
        replace(STATED, separator="|"),
    ),
    "decimal sign": (
        lambda path: write(
            path,
            ["t;p;q;r;u;v;w", *(row.replace(".", ",") for row in rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr, by=";"))],
        ),
        replace(STATED, decimal=","),
    ),
    "encoding": (
        lambda path: write(path, [",".join(NAMES), *rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr)], "utf-16"),
        replace(STATED, encoding="utf-16"),
    ),
    "columns by number": (table, TableChoices(acc=("2", "3", "4"), gyr=("5", "6", "7"), time="1")),
    "another order": (
        lambda path: write(
            path, [",".join("zyxwvut"), *rows_of(LEFT.acc[:, ::-1], LEFT.gyr[:, ::-1], LEFT.time_s[:, None])]
        ),
        TableChoices(acc=("x", "y", "z"), gyr=("u", "v", "w"), time="t"),
    ),
    "units": (
        lambda path: write(
            path, [",".join(NAMES), *rows_of(1e3 * LEFT.time_s, 1e3 / G * LEFT.acc, np.degrees(LEFT.gyr), form="%.9g")]
        ),
        replace(STATED, acc_unit="mg", gyr_unit="deg/s", time_unit="ms"),
    ),
    "samples counted": (
        lambda path: write(path, [",".join(NAMES), *rows_of(100 * LEFT.time_s, LEFT.acc, LEFT.gyr)]),
        replace(STATED, time_unit="count", rate_hz=100.0),
    ),
    "no times": (table, replace(STATED, time=NONE, rate_hz=100.0)),
    "days of a spreadsheet": (
        lambda path: write(
            path, [",".join(NAMES), *rows_of(45_321 + LEFT.time_s / 86_400, LEFT.acc, LEFT.gyr, form="%.17g")]
        ),
        replace(STATED, time_unit="d"),
    ),
}


@pytest.mark.parametrize("name", CHOICES)
def test_each_choice_can_be_stated(name: str, tmp_path: Path) -> None:
    make, stated = CHOICES[name]
    path = make(tmp_path / "a.csv")
    assert is_left(preview_of(path, stated))
    (sensor,) = read_trial("", [path], None, {"": stated}).sensors
    assert len(sensor.block) == ROWS
    np.testing.assert_allclose(sensor.block.acc_m_s2, LEFT.acc, atol=1e-5)
    np.testing.assert_allclose(sensor.block.gyr_rad_s, LEFT.gyr, atol=1e-5)


def test_a_wrong_choice_shows_why_it_cannot_be(tmp_path: Path) -> None:
    def refusal(**stated: object) -> str:
        found = preview_of(table(tmp_path / "a.csv"), replace(STATED, **stated)).refusal  # type: ignore[arg-type]  # of several types
        assert found is not None
        return str(found)

    assert 'the table has no column "x"; its columns are t, p, q, r, u, v, w' in refusal(acc=("x", "p", "q"))
    assert "2 columns are chosen for the three axes: p, p, q" in refusal(acc=("p", "p", "q"))
    assert "is labelled g, but its median of" in refusal(acc_unit="g")
    assert "the times in the file give 0.1 samples per second" not in refusal(time_unit="us")
    assert "samples per second, expected" in refusal(time_unit="us")
    assert "the samples in the file have no times" in refusal(time=NONE)
    assert '"0.000000" in column "t" is not a time' in refusal(time_unit="clock")
    assert "neither acceleration nor angular rates are chosen" in refusal(acc=(NONE,), gyr=(NONE,))
    assert "in column t is not a number" in refusal(decimal=",")
    assert "the file is not a table of numbers" in refusal(separator=";")


def test_a_sensor_that_cannot_be_read_beside_one_that_can_is_named(tmp_path: Path) -> None:
    names = ["time_s", *(f"{site}_{what}" for site in ("lt", "ls") for what in ("ax", "ay", "az", "gx", "gy", "gz"))]
    body = rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr, LEFT.free_acc, LEFT.gyr)
    preview = preview_of(write(tmp_path / "a.csv", [",".join(names), *body]), NO_CHOICES)
    assert [one.name for one in preview.sensors] == ["lt"]
    (refusal,) = preview.unread
    assert "the acceleration ls_ax, ls_ay, ls_az points nowhere in the mean" in str(refusal)
    assert stated_of(preview).is_caution
    assert "Other sensors in this table cannot be read." in stated_of(preview).then
    assert preview_of(table(tmp_path / "b.csv"), STATED).unread == ()


def test_units_that_names_give_are_shown_where_a_table_is_refused(tmp_path: Path) -> None:
    names = ["ms", *(f"acc {axis} (g)" for axis in "xyz"), *(f"gyr {axis} (deg/s)" for axis in "xyz")]
    preview = preview_of(table(tmp_path / "a.csv", names=tuple(names)), NO_CHOICES)
    assert "is labelled g, but its median" in str(preview.refusal)
    assert (preview.found.time, preview.found.time_unit) == ("ms", "ms")
    assert (preview.found.acc_unit, preview.found.gyr_unit) == ("g", "deg/s")


def test_a_column_without_name_and_content_is_refused_as_times_or_names_of_sensors(tmp_path: Path) -> None:
    (path,) = windows_excel(tmp_path)
    for stated, why in (
        (TableChoices(time="column 8", time_unit="clock"), 'a sample has no time in column "column 8"'),
        (TableChoices(sensor="column 9"), 'the column "column 9" holds 0 different names of sensors'),
    ):
        refusal = preview_of(path, stated).refusal
        assert why in str(refusal)


def test_the_sensors_of_a_table_may_be_named_by_a_column_or_not(tmp_path: Path) -> None:
    (path,) = lpms(tmp_path)
    both = preview_of(path, NO_CHOICES)
    assert [one.name for one in both.sensors] == ["1", "2"]
    np.testing.assert_allclose(block_of(both, 1)[1], RIGHT.acc[: len(block_of(both, 1)[1])], atol=1e-4)
    assert both.found.sensor == "SensorId"
    assert len(preview_of(path, TableChoices(sensor=NONE)).sensors) == 1


def test_what_is_no_table_has_no_fingerprint_and_states_why(tmp_path: Path) -> None:
    for make in (a_letter, a_picture, commas_in_commas):
        (path,) = make(tmp_path)
        preview = preview_of(path, NO_CHOICES)
        assert preview.fingerprint == fingerprint_of(path) == ""
        assert preview.refusal is not None
        assert preview.sensors == ()
    assert preview.lines[0].startswith("time_s,")
    assert preview_of(a_picture(tmp_path)[0], NO_CHOICES).lines == ()


def test_only_the_beginning_of_a_large_file_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("devices.files.table_preview.PREVIEW_BYTES", 20_000)
    preview = preview_of(table(tmp_path / "a.csv"), STATED)
    assert preview.is_cut
    assert 1.0 < preview.sensors[0].length_s < 5.0


def test_a_utf_16_table_that_is_read_whole_is_not_cut(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = table(tmp_path / "a.csv")
    text = path.read_text()
    path.write_text(text, encoding="utf-16")
    monkeypatch.setattr("devices.files.table_preview.PREVIEW_BYTES", len(text))
    preview = preview_of(path, STATED)
    assert not preview.is_cut
    assert len(text) < path.stat().st_size
    assert preview.sensors[0].length_s == pytest.approx(np.ptp(LEFT.time_s))
    monkeypatch.setattr("devices.files.table_preview.PREVIEW_BYTES", len(text) - 1)
    assert preview_of(path, STATED).is_cut


def test_of_a_long_table_separated_by_blanks_only_the_head_is_read_for_its_layout(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = table(tmp_path / "a.txt", by=" ")
    short = fingerprint_of(path)
    lines = path.read_text().splitlines()
    path.write_text("\n".join([lines[0], *lines[1:] * 50]))
    read: list[int] = []

    class CountedFile(BufferedReader):
        def read(self, size: int | None = -1, /) -> bytes:
            read.append(len(found := super().read(size)))
            return found

    monkeypatch.setattr(table_layout, "open_text", lambda path, _encoding: CountedFile(FileIO(path)))
    assert path.stat().st_size > 8 * HEAD_BYTES
    assert fingerprint_of(path) == short
    assert sum(read) <= 2 * (HEAD_BYTES + 1)  # as it is, and with its blanks squeezed


def test_a_fingerprint_is_of_the_columns_alone(tmp_path: Path) -> None:
    one, other = table(tmp_path / "a.csv"), table(tmp_path / "b.csv", motion=RIGHT)
    assert fingerprint_of(one) == fingerprint_of(other) != ""
    assert fingerprint_of(one) != fingerprint_of(table(tmp_path / "c.csv", by=";"))
    assert fingerprint_of(one) != fingerprint_of(table(tmp_path / "d.csv", names=("T", *NAMES[1:])))
    assert not any(name in fingerprint_of(one) for name in ("acc", "t,p"))


def test_a_table_that_was_explained_once_is_read_without_being_asked_about(tmp_path: Path) -> None:
    one = table(tmp_path / "walk_left_thigh.csv")
    other = table(tmp_path / "walk_left_shank.csv", motion=RIGHT)
    assert format_of(one) is None
    assert gather([tmp_path]).tables == (str(other), str(one))
    known = {fingerprint_of(one): STATED}
    (trial,) = gather([tmp_path], known).trials
    assert (trial.format, trial.name, len(trial.files)) == ("csv", "walk", 2)
    read = read_trial("csv", [one, other], None, known)
    assert [len(sensor.block) for sensor in read.sensors] == [ROWS, ROWS]
    assert gather([tmp_path], {"another": STATED}).trials == ()


def test_accelerometer_and_gyroscope_apart_are_joined_by_what_is_stated_of_each(tmp_path: Path) -> None:
    acc = write(tmp_path / "lt_acc.csv", ["t,p,q,r", *rows_of(LEFT.time_s, LEFT.acc)])
    gyr = write(tmp_path / "lt_gyro.csv", ["t,u,v,w", *rows_of(LEFT.time_s, LEFT.gyr)])
    known = {
        fingerprint_of(acc): TableChoices(acc=("p", "q", "r"), gyr=(NONE,), time="t"),
        fingerprint_of(gyr): TableChoices(acc=(NONE,), gyr=("u", "v", "w"), gyr_unit="rad/s", time="t"),
    }
    (sensor,) = read_trial("", [acc, gyr], None, known).sensors
    np.testing.assert_allclose(sensor.block.acc_m_s2, LEFT.acc, atol=1e-5)
    np.testing.assert_allclose(sensor.block.gyr_rad_s, LEFT.gyr, atol=1e-5)
    with pytest.raises(FileRefusedError, match="the file holds acceleration but no angular rates"):
        read_trial("", [acc], None, known)


def test_files_of_one_sensor_each_are_one_trial_where_somebody_states_it(tmp_path: Path) -> None:
    names = ("time_s", "ax", "ay", "az", "gx", "gy", "gz")
    for name in ("A7F2", "B801"):
        table(tmp_path / f"{name}.csv", names=names)
    assert [len(one.files) for one in gather([tmp_path]).trials] == [1, 1]
    assert [len(one.files) for one in gather([tmp_path], are_one=True).trials] == [2]


def test_a_column_is_called_by_its_name_before_its_number() -> None:
    names = ["Time", "2", "ACC x"]
    assert [column_named(stated, names) for stated in ("time", "2", "3", "acc X", "4", "0", "y")] == [
        *("Time", "2", "ACC x", "ACC x", None, None, None)
    ]


def test_choices_and_previews_come_through_the_limited_process(tmp_path: Path, shared_reading: LimitedReading) -> None:
    path = table(tmp_path / "a.csv")
    assert is_left(shared_reading.preview(path, STATED))
    assert shared_reading.preview(path, replace(STATED, acc_unit="g")).refusal is not None
    assert len(shared_reading.read_trial("", [path], None, {"": STATED}).sensors) == 1
    assert shared_reading.gather([path], {fingerprint_of(path): STATED}).trials[0].format == "csv"


def test_choices_are_the_same_after_being_written_down() -> None:
    full = TableChoices("utf-16", 3, ";", ",", ("a", "b", "c"), "g", ("d", "e", "f"), "deg/s", "t", "ms", "s", 100.0)
    assert all(getattr(full, one.name) not in ("", (), None) for one in fields(full))
    for choices in (full, NO_CHOICES, STATED):
        assert value_from(TableChoices, details_of(choices, [])) == choices
    assert full.are_any
    assert TableChoices(header_line=0).are_any
    assert not NO_CHOICES.are_any

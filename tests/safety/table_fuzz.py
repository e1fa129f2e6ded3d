"""T13: spoilt tables of no known program, previewed and read as somebody states who may be wrong.

Check whether one ends or hangs the reading process, writes anywhere, or raises anything but a refusal; and whether what
is shown before a table is taken in is what is read of it then.

    python -m tests.safety.table_fuzz --files 1250

Each table is damaged as in `file_fuzz`, or in one of four not at all, and some of its choices (encoding, header line,
separator, decimal sign, columns, units, times, rate) are stated at random. Eight kinds of tables: 10 000 files.
"""

import random
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from app.home.importing.table_words import findings_of, stated_of
from app.wording.findings import sentence
from devices.files.limited_reader import LimitedReader, LimitedReading
from devices.files.table_choices import NO_CHOICES, NONE, SEPARATORS, TIME_UNITS, TableChoices, TablePreview, by_place
from devices.files.text_files import ENCODINGS
from tests.devices.files.test_public_layouts import (
    MovedSensor,
    clock,
    lpms,
    no_header,
    of_r,
    phyphox_german,
    rows_of,
    windows_excel,
    write,
)
from tests.devices.files.test_table_preview import NAMES, table
from tests.driver import drive
from tests.safety.file_fuzz import Spoilable, fuzz_each, nobody

SHORT = MovedSensor(rows=500)
PLACE = "export.csv"
ACC_UNITS, GYR_UNITS = ("m/s2", "g", "mg"), ("rad/s", "deg/s", "mdeg/s")
WHOLE_SHARE = 0.25  # of the tables that are not damaged
STATED = (0, 1, 1, 2, 4)  # choices that somebody states


def clocked(path: Path) -> Path:
    """Times of day over midnight, an empty cell, and decimal commas."""
    cells = rows_of(SHORT.acc, SHORT.gyr, by=";")
    rows = [f"{clock(time_s)};{row}" for time_s, row in zip(SHORT.time_s, cells, strict=True)]
    rows[9] = rows[9].rpartition(";")[0] + ";NA"
    return write(path, [";".join(NAMES), *(row.replace(".", ",") for row in rows)])


MAKERS: dict[str, Callable[[Path], Path]] = {
    "unknown names": lambda folder: table(folder / "a.csv", motion=SHORT),
    "no names": lambda folder: no_header(folder)[0],
    "time of day": lambda folder: clocked(folder / "a.csv"),
    "sensors below each other": lambda folder: lpms(folder)[0],
    "German": lambda folder: phyphox_german(folder)[0],
    "cp1252": lambda folder: windows_excel(folder)[0],
    "row names": lambda folder: of_r(folder)[0],
    "acceleration alone": lambda folder: write(folder / "a.csv", ["t,p,q,r", *rows_of(SHORT.time_s, SHORT.acc)]),
}


@cache
def tables() -> dict[str, Spoilable]:
    found = {}
    with tempfile.TemporaryDirectory() as place:
        for name, make in MAKERS.items():
            content = make(Path(place) / name).read_bytes()
            found[name] = Spoilable(content, PLACE, read_of(content, random.Random(name)), may_be_a_link=False)
    return found


def read_of(content: bytes, chance: random.Random) -> Callable[[LimitedReader, Path], object]:
    """Preview and read the table as stated at random; the good one as it is found."""

    def read(reader: LimitedReader, folder: Path) -> object:
        path, reading = folder / PLACE, LimitedReading(reader, nobody)
        is_good = path.read_bytes() == content
        if chance.random() < WHOLE_SHARE:
            path.write_bytes(content)
        preview = reading.preview(path, NO_CHOICES)
        if not is_good:
            base = chance.choice((NO_CHOICES, preview.choices))
            preview = reading.preview(path, stated_at_random(base, chance, preview.columns or NAMES))
        stated = stated_of(preview)
        assert stated.what
        assert stated.then
        assert all(map(sentence, findings_of(preview)))
        if preview.refusal is not None:
            assert not stated.may_be_read
            raise preview.refusal
        if not preview.sensors or NONE in (*preview.choices.acc, *preview.choices.gyr):
            return preview
        return as_shown(reading, path, preview)

    return read


def as_shown(reading: LimitedReading, path: Path, preview: TablePreview) -> object:
    """Read a table as it was shown, and compare."""
    trial = reading.read_trial("csv", [path], None, {str(path): preview.choices})
    if preview.is_cut:
        return trial  # only its beginning was shown; what a line of megabytes holds may be refused
    blocks = {sensor.name: sensor.block for sensor in trial.sensors}
    for one in preview.sensors:
        n = len(one.time_s)
        for shown, read in (
            (one.time_s, blocks[one.name].time_s),
            (one.acc_m_s2, blocks[one.name].acc_m_s2),
            (one.gyr_rad_s, blocks[one.name].gyr_rad_s),
        ):
            np.testing.assert_array_equal(shown, read[:n])
    try:
        kept = by_place(preview.choices, preview.columns)
    except ValueError:
        return trial
    again = reading.preview(path, kept)
    assert again.found == preview.found
    return trial


def stated_at_random(base: TableChoices, chance: random.Random, names: Sequence[str]) -> TableChoices:
    """What is known, and some of the choices changed, rightly or wrongly."""
    columns = [*names, "1", "2", "99", "0", "no such column", NONE]
    start = chance.randrange(len(names))
    axes = ((), (NONE,), tuple(names[start : start + 3]), tuple(chance.choice(columns) for _ in range(3)))
    ways: dict[str, Sequence[object]] = {
        "encoding": ENCODINGS,
        "header_line": (0, 1, 2, 5, 1000),
        "separator": [*SEPARATORS.values()],
        "decimal": (".", ","),
        "acc": axes,
        "acc_unit": ACC_UNITS,
        "gyr": axes,
        "gyr_unit": GYR_UNITS,
        "time": columns,
        "time_unit": TIME_UNITS,
        "sensor": columns,
        "rate_hz": (0.5, 50.0, 100.0, 2000.0),
    }
    stated: dict[str, Any] = {key: chance.choice(ways[key]) for key in chance.sample([*ways], chance.choice(STATED))}
    return replace(base, **stated)


if __name__ == "__main__":
    drive(
        __doc__,
        lambda asked, _: fuzz_each(tables(), asked.files, asked.seed, asked.table),
        files=1250,
        seed=1,
        table={"choices": tuple(tables()), "action": "append"},
    )

"""T13: spoilt files.

Check whether one ends or hangs the application, writes anywhere, or raises anything but a refusal.

    python -m tests.safety.file_fuzz --files 10000

Each importer reads files of which bits, bursts, blocks, lines, numbers or the encoding were changed, which were cut,
doubled, nested deeply or replaced by a link that leads outside. All are read by one limited process, as the application
reads them, each followed now and then by a good one, which has to be read.
"""

import os
import random
import re
import tempfile
import time
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from core.body import Site
from devices.drivers.xbus import Item
from devices.files.imports import place_trial
from devices.files.limited_reader import LimitedReader, LimitedReading, ReadingEndedError
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import read_session
from devices.files.site_files import MAG, QUAT, REQUIRED
from tests.devices.files import (
    test_apdm,
    test_apdm_hdf5,
    test_bids_motion,
    test_csv_tables,
    test_matlab_tables,
    test_movella_dot,
    test_mti_streams,
    test_mvnx,
    test_opensim_orientations,
    test_parquet_tables,
    test_public_layouts,
    test_shimmer_card,
    test_shimmer_tables,
    test_xdf,
    test_ximu3_files,
    test_xsens_mtmanager,
)
from tests.driver import Found, drive
from tests.swinging_sensor import swinging_sensor

ROWS = 30
GOOD_EVERY = 50
LONGEST_S = 30.0  # for one file; the deadline of the application is twice that
TOML = """format = "gaitwright-session/1"
own = [1979-05-27T07:32:00Z, 1979-05-27, 07:32:00, [1, 2.5, nan, { deep = "ä" }]]
[session]
started = "2026-01-01T10:00:00"
simulated = true
[patient]
code = "DEMO-1"
birth_year = 1950
height_m = 1.8
prosthetic_side = "left"
[sensors.left_thigh]
serial = "A1"
rate_hz = 100.0
rate_kind = "averaged"
[zero]
left_knee = 2.0
[sign]
left_knee = -1
[[recordings]]
name = "walk 1"
kind = "walking"
folder = "walk_1"
kept = true
sensors = { left_thigh = "A1" }
rates_derived = ["left_thigh"]
strides_left_out = { left = [1.0, 2.0] }
"""
HUGE = (b"1e999", b"-1e308", b"9" * 400, b"9" * 5000, b"0x7fffffffffffffff", b"1e-400", b"nan", b"inf", b"-0", b"65536")
DEEP = (b"[" * 3000, b"{a=" * 2000, b"[" + b"a." * 3000 + b"b]", b"a" + b".a" * 3000 + b" = 1", b'"' * 3, b"{" * 400)


@dataclass(frozen=True, slots=True)
class Spoilable:
    """A good file, where it lies in the folder, how the folder is read, and good files that belong to it."""

    content: bytes
    place: str
    read: Callable[[LimitedReader, Path], object]
    may_be_a_link: bool
    beside: Mapping[str, bytes] = field(default_factory=dict)
    is_stream: bool = False  # whose damage is passed over, so that most of it is still read


def columns() -> dict[str, np.ndarray[tuple[int], np.dtype[np.float64]]]:
    chance = np.random.default_rng(1)
    names = (*REQUIRED[1:], *QUAT, *MAG)
    return {REQUIRED[0]: np.arange(ROWS) / 100.0} | {name: chance.normal(size=ROWS).round(4) for name in names}


def csv_text() -> bytes:
    table = columns()
    rows = (",".join(map(str, row)) + ",good\n" for row in zip(*table.values(), strict=True))
    return (",".join(table) + ",note\n" + "".join(rows)).encode()


def parquet() -> bytes:
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table(columns() | {"note": ["good"] * ROWS}), sink)
    return bytes(sink.getvalue().to_pybytes())


def read_folder(reader: LimitedReader, folder: Path) -> object:
    return read_session(folder, LimitedReading(reader, nobody))


def read_of(name: str, file: str) -> Callable[[LimitedReader, Path], object]:
    """Reads `file` as of this format, and places its first sensor."""

    def read(reader: LimitedReader, folder: Path) -> object:
        trial = LimitedReading(reader, nobody).read_trial(name, [folder / file], None, splits=True)
        return place_trial(trial, {Site.LEFT_THIGH: trial.sensors[0].name}, "walk 1")

    return read


def nobody() -> None: ...


def in_tables(folder: Path) -> Iterator[tuple[str, Path]]:
    """A short file of each format that is given its name or content alone: as the tests of the formats write them."""
    path, swing = folder / "made", swinging_sensor(ROWS)
    names = ["PacketCounter", "SampleTimeFine", *test_xsens_mtmanager.ACC_GYR[1:]]
    names += ("Mag_X", "Mag_Y", "Mag_Z", "Quat_q0", "Quat_q1", "Quat_q2", "Quat_q3")
    samples = [0.1, 0.2, 9.8, 0.01, 0.02, 0.03, 0.4, 0.5, 0.6, 1.0, 0.0, 0.0, 0.0]
    head = "// Start Time: Unknown\n// Update Rate: 100.0Hz\n// DeviceId: 00B42D4B"
    yield (
        "xsens-mtmanager",
        test_xsens_mtmanager.export(path, names, [[k, 100 * k, *samples] for k in range(ROWS)], head),
    )
    columns = test_movella_dot.swing(ROWS)
    yield "movella-dot", test_movella_dot.dot(path, "Quat", "Acc", "Gyr", columns=columns)
    test_movella_dot.as_workbook(path, folder / "made.xlsx")
    yield "movella-dot-xlsx", without_times(folder / "made.xlsx")
    elements = test_mvnx.elements([swing], "sensorFreeAcceleration", "sensorOrientation")
    yield "mvnx", test_mvnx.mvnx(path, elements, index=range(ROWS), names=["A"])
    yield "apdm", test_apdm.moveo(path)
    still = {"1262": ("A", test_apdm_hdf5.stamps(ROWS), test_apdm_hdf5.still(ROWS))}
    yield "apdm-hdf5", test_apdm_hdf5.version_5(path, still, is_packed=True)
    time_s = np.arange(ROWS) / 100.0
    yield "csv-named", named_csv(path)
    named = {name: values[:ROWS] for name, values in test_parquet_tables.columns("A_").items()}
    yield "parquet-named", test_parquet_tables.written(path, {"time_ms": 10 * np.arange(ROWS), **named})
    sent = test_xdf.SentStream("A", test_xdf.motion()[:ROWS], test_xdf.START_S + time_s)
    yield "xdf", test_xdf.recorded(path, sent)
    sensors = {name: {"time_s": time_s, "acc": swing.acc_m_s2, "gyr": swing.gyr_rad_s} for name in ("A", "B")}
    variables = {"units": {"acc": "m/s^2", "gyr": "rad/s"}, **sensors}
    test_matlab_tables.written(path, variables)
    path.write_bytes(b"MATLAB 5.0 MAT-file".ljust(116) + path.read_bytes()[116:])  # else with the time of now
    yield "matlab", path
    yield "matlab-7.3", test_matlab_tables.written_7_3(path, variables)
    yield "opensim", test_opensim_orientations.sto(path, swing, swing)
    yield "shimmer", test_shimmer_tables.written(path, count=ROWS)
    yield "ximu3", test_ximu3_files.converted(folder, count=ROWS) / "Inertial.csv"


def named_csv(path: Path) -> Path:
    """Two sensors with orientations, in g and deg/s, a line of units and decimal commas."""
    time_s = np.arange(ROWS) / 100.0
    table, units = {"Time": 1000 * time_s}, ["ms"]
    for sensor in "AB":
        motion = test_csv_tables.named(f"{sensor}_acc_{{}}", f"{sensor}_gyr_{{}}", test_csv_tables.G, np.pi / 180)
        table |= {name: values[:ROWS] for name, values in motion.items()}
        table |= {f"{sensor}_q{k}": np.full(ROWS, float(k == 0)) for k in range(4)}
        units += [*["g"] * 3, *["deg/s"] * 3, *[""] * 4]
    test_csv_tables.write(path, table, ";", units)
    path.write_text("# exported\n" + path.read_text().replace(".", ","))
    return path


def without_times(path: Path) -> Path:
    """An Excel file whose bytes are the same whenever it is written."""
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            dated = re.sub(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", b"2026-01-01T00:00:00Z", content)
            archive.writestr(zipfile.ZipInfo(name), dated, zipfile.ZIP_DEFLATED)
    return path


def in_streams(path: Path) -> Iterator[tuple[str, bytes]]:
    """Formats whose damage is passed over."""
    kinds = frozenset({Item.RATE, Item.ACCELERATION})
    yield "xsens-mti", test_mti_streams.written(path, kinds=kinds, count=ROWS).read_bytes()
    both = [test_ximu3_files.kept(path, is_binary=is_binary, count=ROWS).read_bytes() for is_binary in (False, True)]
    yield "ximu3", b"".join(both)
    yield "shimmer", test_shimmer_card.written(path, count=ROWS).read_bytes()


@cache
def importers() -> dict[str, Spoilable]:
    session = {
        "csv": (csv_text(), "walk_1/left_thigh.csv"),
        "parquet": (parquet(), "walk_1/left_thigh.parquet"),
        "session.toml": (TOML.encode(), "session.toml"),
    }
    found = {name: Spoilable(*of, read_folder, may_be_a_link=True) for name, of in session.items()}
    with tempfile.TemporaryDirectory() as folder:
        for name, path in in_tables(Path(folder)):
            is_named = name in ("xsens-mtmanager", "shimmer", "ximu3")  # the others are known by their content
            place = "export.txt" if name == "xsens-mtmanager" else "export.csv"
            read = read_of(name if is_named else "", place)
            key = "ximu3-csv" if name == "ximu3" else name
            found[key] = Spoilable(path.read_bytes(), place, read, may_be_a_link=False)
        for name, content in in_streams(Path(folder) / "stream"):
            key = "shimmer-card" if name == "shimmer" else name
            read = read_of(name, "export.bin")
            found[key] = Spoilable(content, "export.bin", read, may_be_a_link=False, is_stream=True)
        channels = test_bids_motion.channels("A", swinging_sensor(ROWS))
        latency = test_bids_motion.other("LATENCY", "n/a", np.arange(ROWS) / 100.0, unit="s")
        motion = test_bids_motion.bids(Path(folder), [latency, *channels], "export")
        files = {name: motion.with_name(name).read_bytes() for name in ("export_motion.tsv", "export_channels.tsv")}
        (counted,) = test_public_layouts.ximu(Path(folder))
        registers = counted.with_name("00033_Registers.csv")
        whole = {path.name: path.read_bytes() for path in (counted, registers)}
    for key, place in zip(("ximu", "ximu-registers"), whole, strict=True):
        beside = {name: content for name, content in whole.items() if name != place}
        read, is_stream = read_of("ximu", counted.name), key == "ximu-registers"  # of which one line is needed
        found[key] = Spoilable(whole[place], place, read, may_be_a_link=False, beside=beside, is_stream=is_stream)
    for key, place in zip(("bids-motion", "bids-channels"), files, strict=True):
        beside = {name: content for name, content in files.items() if name != place}
        read = read_of("bids-motion", "export_motion.tsv")
        found[key] = Spoilable(files[place], place, read, may_be_a_link=False, beside=beside)
    return found


def spoilt(content: bytes, chance: random.Random) -> bytes:
    """The content with one to three things wrong."""
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        content = chance.choice(WAYS)(content, chance)
    return content


def _flip(content: bytes, chance: random.Random) -> bytes:
    changed = bytearray(content or b"\0")
    for _ in range(chance.choice((1, 1, 3, 30))):
        changed[chance.randrange(len(changed))] ^= 1 << chance.randrange(8)
    return bytes(changed)


def _burst(content: bytes, chance: random.Random) -> bytes:
    at, length = chance.randrange(len(content) + 1), chance.choice((1, 8, 200, 5000))
    return content[:at] + chance.randbytes(length) + content[at + chance.choice((0, length)) :]


def _cut(content: bytes, chance: random.Random) -> bytes:
    at, end = sorted(chance.randrange(len(content) + 1) for _ in range(2))
    return chance.choice((content[:at], content[at:], content[:at] + content[end:]))


def _double(content: bytes, chance: random.Random) -> bytes:
    at, end = sorted(chance.randrange(len(content) + 1) for _ in range(2))
    return content[:end] + content[at:end] * chance.choice((1, 1, 30)) + content[end:]


def _swap_lines(content: bytes, chance: random.Random) -> bytes:
    lines = content.split(b"\n")
    one, other = (chance.randrange(len(lines)) for _ in range(2))
    lines[one], lines[other] = lines[other], lines[one]
    return chance.choice((b"\n", b"\n", b"\r", b"\r\n", b"\n\n")).join(lines)


def _word(content: bytes, chance: random.Random, words: Sequence[bytes]) -> bytes:
    """Put a word in place of another, or between two letters."""
    if chance.random() < 0.3:
        at = end = chance.randrange(len(content) + 1)
    else:
        edges = [i for i, letter in enumerate(content) if letter in b',\t\n =".[]{}'] or [0]
        at = chance.choice(edges) + 1
        end = next((edge for edge in edges if edge >= at), len(content))
    return content[:at] + chance.choice(words) + content[end:]


def _huge(content: bytes, chance: random.Random) -> bytes:
    return _word(content, chance, HUGE)


def _nul(content: bytes, chance: random.Random) -> bytes:
    return _word(
        content, chance, (b"\0", b"\0" * 4096, b"\xff\xfe", b"\xef\xbb\xbf", b"\x1b[2J", b"{x!r:>99}", b'"', b"\r")
    )


def _deep(content: bytes, chance: random.Random) -> bytes:
    return _word(content, chance, DEEP)


def _path(content: bytes, chance: random.Random) -> bytes:
    return _word(
        content, chance, (b"../outside", b"/etc", b"walk_1/..", b"C:\\x", b"a" * 5000, "\u202egnp.exe".encode(), b".")
    )


def _encode(content: bytes, chance: random.Random) -> bytes:
    text = content.decode("utf-8", "replace")
    return text.encode(chance.choice(("utf-16", "utf-16-le", "utf-32", "utf-8-sig", "cp037", "utf-7")), "replace")


def _no_lines(content: bytes, chance: random.Random) -> bytes:
    return chance.choice((content.replace(b"\n", b""), content + b"1," * 100_000, content + b"\n" * 100_000, b""))


WAYS = (_flip, _burst, _cut, _double, _swap_lines, _huge, _nul, _deep, _path, _encode, _no_lines)


def fuzz(importer: Spoilable, files: int, seed: int, reader: LimitedReader) -> Found:
    """Spoil and read that many files."""
    chance, found = random.Random(seed), Found(Counter(files=files))
    with tempfile.TemporaryDirectory(prefix="gaitwright-fuzz-") as place:
        root = Path(place)
        (root / "outside").mkdir()
        (root / "outside" / "secret").write_bytes(importer.content)
        (root / "session" / "walk_1").mkdir(parents=True)
        (root / "session" / "session.toml").write_text(TOML, encoding="utf-8")
        target = root / "session" / importer.place
        if target.parent.name != "walk_1":
            (root / "session" / "walk_1" / "left_thigh.csv").write_bytes(csv_text())
        for name, content in importer.beside.items():
            (root / "session" / name).write_bytes(content)
        before = _everything(root, target)
        for number in range(files):
            is_link = importer.may_be_a_link and number % 100 == 99
            content = importer.content if number % GOOD_EVERY == 0 else spoilt(importer.content, chance)
            target.unlink(missing_ok=True)
            if is_link:
                outside = root / "outside" / "secret"
                target.symlink_to(chance.choice((outside, os.path.relpath(outside, target.parent))))
            else:
                target.write_bytes(content)
            outcome = _outcome(importer, reader, root / "session", number, found)
            found.count[outcome] += 1
            if number % GOOD_EVERY == 0 and outcome != "read":
                found.faults.append(f"file {number}: a good one came out as {outcome}")
            if is_link and outcome != "refused":
                found.faults.append(f"file {number}: a link that leads outside came out as {outcome}")
            if number % 100 == 0 and _everything(root, target) != before:
                found.faults.append(f"up to file {number}: something was written")
        if _everything(root, target) != before:
            found.faults.append("something was written")
    return found


def _outcome(importer: Spoilable, reader: LimitedReader, folder: Path, number: int, found: Found) -> str:
    began_s = time.monotonic()
    try:
        importer.read(reader, folder)
        outcome = "read"
    except ReadingEndedError as ended:
        outcome = ended.cause
        if ended.cause != "memory":  # a file may claim to be large
            found.faults.append(f"file {number}: the reader ended, {ended.cause}")
    except FileRefusedError as refusal:
        outcome = "refused"
        if not str(refusal).isprintable() or not refusal.where or not refusal.remedy:
            found.faults.append(f"file {number}: {refusal!r} is no line")
    except Exception as error:  # whatever it is, it is a fault
        outcome = "raised"
        found.faults.append(f"file {number}: {error!r}")
    took_s = time.monotonic() - began_s
    found.figures["time, s"].append(took_s)
    if took_s > LONGEST_S:
        found.faults.append(f"file {number}: took {took_s:.0f} s")
    return outcome


def _everything(root: Path, target: Path) -> dict[str, tuple[int, bytes]]:
    """All files and folders but the one that is spoilt, with when they were changed and what they hold."""
    return {
        str(path.relative_to(root)): (
            0 if path == target.parent else path.lstat().st_mtime_ns,
            path.read_bytes() if path.is_file() else b"",
        )
        for path in sorted(root.rglob("*"))
        if path != target
    }


def fuzz_each(
    known: Mapping[str, Spoilable], files: int, seed: int, only: Sequence[str] | None = None
) -> Iterator[tuple[str, Found]]:
    """All of them, or `only` some, by one process."""
    with closing(LimitedReader()) as reader:
        for name in only or known:
            yield name, fuzz(known[name], files, seed, reader)


if __name__ == "__main__":
    drive(
        __doc__,
        lambda asked, _: fuzz_each(importers(), asked.files, asked.seed, asked.importer),
        files=10_000,
        seed=1,
        importer={"choices": tuple(importers()), "action": "append"},
    )

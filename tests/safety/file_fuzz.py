"""T13: spoilt files.

Check whether one ends or hangs the application, writes anywhere, or raises anything but a refusal.

    python -m tests.safety.file_fuzz --files 10000

Each importer reads files of which bits, bursts, blocks, lines, numbers or the encoding were changed, which were cut,
doubled, nested deeply or replaced by a link that leads outside. All are read by one limited process, as the application
reads them, each followed now and then by a good one, which has to be read.
"""

import io
import os
import random
import struct
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import openpyxl
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.io import savemat

from core.body import Site
from devices.drivers.xbus import Item, Mid, item, message
from devices.files.imports import place_trial
from devices.files.limited_reader import LimitedReader, LimitedReading, ReadingEndedError
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import read_session
from devices.files.site_files import MAG, QUAT, REQUIRED
from tests.driver import Found, drive

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


def mtmanager() -> bytes:
    names = ["PacketCounter", "SampleTimeFine", "Acc_X", "Acc_Y", "Acc_Z", "Gyr_X", "Gyr_Y", "Gyr_Z"]
    names += ("Mag_X", "Mag_Y", "Mag_Z", "Quat_q0", "Quat_q1", "Quat_q2", "Quat_q3")
    lines = ["// Start Time: Unknown", "// Update Rate: 100.0Hz", "// DeviceId: 00B42D4B", "\t".join(names)]
    for number in range(ROWS):
        samples = (0.1, 0.2, 9.8, 0.01, 0.02, 0.03, 0.4, 0.5, 0.6, 1.0, 0.0, 0.0, 0.0)
        lines.append("\t".join([f"{number:05d}", str(number * 100), *(f"{value:.6f}" for value in samples)]))
    return "\n".join([*lines, ""]).encode()


def read_folder(reader: LimitedReader, folder: Path) -> object:
    return read_session(folder, LimitedReading(reader, nobody))


def apdm() -> bytes:
    quantities = {"Acceleration": "XYZ", "Angular Velocity": "XYZ", "Magnetic Field": "XYZ", "Orientation": "SXYZ"}
    columns = [(name, axis.replace("S", "Scalar")) for name, axes in quantities.items() for axis in axes]
    units = {"Acceleration": "m/s^2", "Angular Velocity": "rad/s", "Magnetic Field": "uT", "Orientation": ""}
    lines = [
        "Test Name:,a walk",
        "Sample Rate:,128,Hz",
        ",".join(["Time", *(f"A/{one}/{axis}" for one, axis in columns)]),
    ]
    lines.append(",".join(["s", *(units[name] for name, _ in columns)]))
    lines += [f"{k / 128:.6f},0.1,0.2,9.8,0.01,0.02,0.03,40.0,5.0,6.0,1.0,0.0,0.0,0.0" for k in range(ROWS)]
    return "\n".join([*lines, ""]).encode()


def apdm_hdf5() -> bytes:
    """As version 5 of APDM's files."""
    import h5py  # an extra

    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        file.attrs["FileFormatVersion"] = 5
        sensor = file.create_group("Sensors/1262")
        sensor.create_group("Configuration").attrs["Label 0"] = np.bytes_("A")
        sensor["Configuration"].attrs["Sample Rate"] = 128
        sensor["Time"] = (1_550_879_504_438_281 + 7812 * np.arange(ROWS)).astype(np.uint64)
        for name, sample in {"Accelerometer": (0.1, 0.2, 9.8), "Gyroscope": (0.01, 0.02, 0.03)}.items():
            sensor.create_dataset(name, data=np.tile(sample, (ROWS, 1)), chunks=(8, 3), compression="gzip")
        file["Processed/1262/Orientation"] = np.tile((1.0, 0.0, 0.0, 0.0), (ROWS, 1))
    return content.getvalue()


def movella_dot_rows() -> list[list[object]]:
    names = ["PacketCounter", "SampleTimeFine", "Quat_W", "Quat_X", "Quat_Y", "Quat_Z"]
    names += ("Acc_X", "Acc_Y", "Acc_Z", "Gyr_X", "Gyr_Y", "Gyr_Z")
    head: list[list[object]] = [["sep=", ""], ["DeviceTag:", "A"], ["OutputRate:", "60Hz"], [], list(names)]
    return head + [[k, 16667 * k, 1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 9.8, 1.5, 2.5, 3.5] for k in range(ROWS)]


def movella_dot() -> bytes:
    return "\n".join([*(",".join(map(str, row)) for row in movella_dot_rows()), ""]).encode()


def movella_dot_xlsx() -> bytes:
    book = openpyxl.Workbook()
    assert book.active is not None
    for row in movella_dot_rows():
        book.active.append(row)
    with io.BytesIO() as file:
        book.save(file)
        return file.getvalue()


def mvnx() -> bytes:
    frames = "".join(
        f'<frame time="{10 * k}" index="{k}" type="normal"><sensorFreeAcceleration>0.1 0.2 0.3</sensorFreeAcceleration>'
        f"<sensorOrientation>1.0 0.0 0.0 0.0</sensorOrientation></frame>\n"
        for k in range(ROWS)
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<mvnx version="4"><subject label="S" frameRate="100">\n'
        f'<sensors><sensor label="A"/></sensors>\n<frames sensorCount="1">\n{frames}</frames></subject></mvnx>\n'
    ).encode()


def opensim() -> bytes:
    head = "DataRate=100.000000\nDataType=Quaternion\nversion=3\nOpenSimVersion=4.4\nendheader\ntime\tA\tB\n"
    return (head + "".join(f"{k / 100:.2f}\t1.0,0.0,0.0,0.0\t0.6,0.8,0.0,0.0\n" for k in range(ROWS))).encode()


def bids_rows() -> bytes:
    return "".join(f"{k / 100}\t0.1\t0.2\t9.8\t0.01\t0.02\t0.03\n" for k in range(ROWS)).encode()


def bids_channels() -> bytes:
    kinds = [("ACCEL", "m/s^2"), ("GYRO", "rad/s")]
    rows = [f"A_{kind}_{axis}\t{axis}\t{kind}\tA\t{unit}\n" for kind, unit in kinds for axis in "xyz"]
    return "".join(["name\tcomponent\ttype\ttracked_point\tunits\n", "latency\tn/a\tLATENCY\tn/a\ts\n", *rows]).encode()


def read_bids(reader: LimitedReader, folder: Path) -> object:
    trial = LimitedReading(reader, nobody).read_trial("bids-motion", [folder / "export_motion.tsv"], None)
    return place_trial(trial, {Site.LEFT_THIGH: "A"}, "walk 1")


def read_export(reader: LimitedReader, folder: Path) -> object:
    trial = LimitedReading(reader, nobody).read_trial("xsens-mtmanager", [folder / "export.txt"], None)
    return place_trial(trial, {Site.LEFT_THIGH: "export.txt"}, "walk 1")


def read_unnamed(reader: LimitedReader, folder: Path) -> object:
    """The format reported by the content, as without --as."""
    trial = LimitedReading(reader, nobody).read_trial("", [folder / "export.csv"], None)
    return place_trial(trial, {Site.LEFT_THIGH: "A"}, "walk 1")


def foreign_csv() -> bytes:
    """As of no particular program: other names, other units, a line of units, two sensors."""
    names = [
        f"{sensor}_{one}" for sensor in "AB" for one in ("ax", "ay", "az", "gx", "gy", "gz", "q0", "q1", "q2", "q3")
    ]
    units = ["g", "g", "g", "deg/s", "deg/s", "deg/s", "", "", "", ""] * 2
    rows = [
        f"{10 * k};" + ";".join(["0,01", "0,02", "1,0", "1,5", "2,5", "90,0", "1", "0", "0", "0"] * 2)
        for k in range(ROWS)
    ]
    return "\n".join(["# exported", "Time;" + ";".join(names), "ms;" + ";".join(units), *rows, ""]).encode()


def foreign_parquet() -> bytes:
    axes = {f"A_acc_{axis}_g": value for axis, value in zip("xyz", (0.1, 0.2, 1.0), strict=True)}
    axes |= {f"A_gyr_{axis}_deg_s": value for axis, value in zip("xyz", (1.0, 2.0, 90.0), strict=True)}
    sink = pa.BufferOutputStream()
    table = pa.table({"time_ms": 10 * np.arange(ROWS)} | {name: np.full(ROWS, value) for name, value in axes.items()})
    pq.write_table(table, sink)
    return bytes(sink.getvalue().to_pybytes())


def xdf() -> bytes:
    """As LabRecorder: a stream of numbers and one of texts, offsets of the clock, footers."""

    def chunk(tag: int, content: bytes) -> bytes:
        return struct.pack("<BIH", 4, len(content) + 2, tag) + content

    labels = "".join(
        f"<channel><label>{name}_{axis}</label><unit>{unit}</unit></channel>"
        for name, unit in (("acc", "m/s^2"), ("gyr", "deg/s"))
        for axis in "xyz"
    )
    head = "<info><name>{}</name><channel_count>{}</channel_count><nominal_srate>{}</nominal_srate>{}</info>"
    numbers = head.format(
        "A", 6, 100, f"<channel_format>float32</channel_format><desc><channels>{labels}</channels></desc>"
    )
    texts = head.format("marks", 1, 0, "<channel_format>string</channel_format><desc/>")
    chunks = [chunk(1, b"<info><version>1.0</version></info>")]
    chunks += [chunk(2, struct.pack("<I", number) + one.encode()) for number, one in ((1, numbers), (2, texts))]
    for first in range(0, ROWS, 10):
        samples = [struct.pack("<Bd6f", 8, 5.0 + k / 100, 0.1, 0.2, 9.8, 1, 2, 90) for k in range(first, first + 10)]
        chunks.append(chunk(3, struct.pack("<IBB", 1, 1, 10) + b"".join(samples)))
        chunks.append(chunk(4, struct.pack("<Idd", 1, 5.0 + first / 100, -0.5)))
        chunks.append(chunk(3, struct.pack("<IBBBdBB", 2, 1, 1, 8, 5.0 + first / 100, 1, 2) + b"go"))
    chunks.append(chunk(5, bytes.fromhex("43A546DCCBF5410FB30ED5467383CBE4")))
    footer = f"<info><sample_count>{ROWS}</sample_count></info>".encode()
    return b"XDF:" + b"".join([*chunks, *(chunk(6, struct.pack("<I", number) + footer) for number in (1, 2))])


def matlab(version: int) -> bytes:
    """Two sensors as structures: as SciPy writes version 5, or laid out by hand as HDF5 of version 7.3."""
    axes = {"acc": np.tile((0.1, 0.2, 9.8), (ROWS, 1)), "gyr": np.tile((0.01, 0.02, 0.03), (ROWS, 1))}
    sensors = {name: {"time_s": np.arange(ROWS) / 100.0, **axes} for name in "AB"}
    units = {"acc": "m/s^2", "gyr": "rad/s"}
    content = io.BytesIO()
    if version == 5:
        savemat(content, {"units": units, **sensors})  # type: ignore[arg-type]  # its stubs know paths only
        return b"MATLAB 5.0 MAT-file".ljust(116) + content.getvalue()[116:]  # else with the time of now
    import h5py  # an extra

    with h5py.File(content, "w", userblock_size=512) as file:
        for name, columns_of in sensors.items():
            file.create_group(name).attrs["MATLAB_class"] = np.bytes_("struct")
            for column, values in columns_of.items():
                file[f"{name}/{column}"] = np.atleast_2d(values.T)
                file[f"{name}/{column}"].attrs["MATLAB_class"] = np.bytes_("double")
        for name, unit in units.items():
            file[f"units/{name}"] = np.array([[ord(letter)] for letter in unit], dtype=np.uint16)
            file[f"units/{name}"].attrs["MATLAB_class"] = np.bytes_("char")
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    return head.ljust(512, b"\0") + content.getvalue()[512:]


def mti() -> bytes:
    """As an MTi sends it: a header, then messages with counter, time, rate and acceleration."""
    data = message(Mid.DEVICE_ID + 1, bytes.fromhex("0123ABCD"))
    for k in range(ROWS):
        items = [(Item.COUNTER, struct.pack(">H", k)), (Item.FINE_TIME, struct.pack(">I", 100 * k))]
        items += [
            (Item.RATE, struct.pack(">3f", 0.1, 0.2, 0.3)),
            (Item.ACCELERATION, struct.pack(">3f", 0.1, 0.2, 9.8)),
        ]
        data += message(Mid.MT_DATA2, b"".join(item(identifier, content) for identifier, content in items))
    return data


def ximu3() -> bytes:
    """As an x-IMU3 sends it, in text and in binary."""
    lines = [f"I,{10_000 * k},1.0,2.0,3.0,0.1,0.2,1.0\r\n".encode() for k in range(ROWS)]
    packed = (struct.pack("<BQ6f", 0xC9, 10_000 * (ROWS + k), 1.0, 2.0, 3.0, 0.1, 0.2, 1.0) for k in range(ROWS))
    lines += [one.replace(b"\xdb", b"\xdb\xdd").replace(b"\n", b"\xdb\xdc") + b"\n" for one in packed]
    return b"".join(lines)


def ximu3_csv() -> bytes:
    axes = [*(f"Gyroscope {axis} (deg/s)" for axis in "XYZ"), *(f"Accelerometer {axis} (g)" for axis in "XYZ")]
    rows = [f"{10_000 * k},1.0,2.0,3.0,0.1,0.2,1.0" for k in range(ROWS)]
    return "\n".join([",".join(["Timestamp (us)", *axes]), *rows, ""]).encode()


def shimmer() -> bytes:
    names = ["Timestamp_Unix", *(f"Accel_WR_{axis}" for axis in "XYZ"), *(f"Gyro_{axis}" for axis in "XYZ")]
    units = ["ms", *["m/(s^2)"] * 3, *["deg/s"] * 3]
    rows = [f"{1_732_790_638_000 + 10 * k},0.1,0.2,9.8,1.0,2.0,3.0," for k in range(ROWS)]
    head = [",".join([f"Shimmer_40AC_{name}_CAL" for name in names] + [""]), ",".join([*units, ""])]
    return "\n".join(['"sep=,"', *head, *rows, ""]).encode()


def shimmer_card() -> bytes:
    """As a Shimmer3 keeps gyroscope and wide-range accelerometer, 102.4 Hz."""
    head = bytearray(256)
    head[0:2], head[3:6], head[30:32] = struct.pack("<H", 320), bytes([0x40, 0x10, 0]), struct.pack(">H", 3)
    for at in (76, 97):
        head[at : at + 21] = struct.pack(">6h9b", 0, 0, 0, 209, 209, 209, -100, 0, 0, 0, 100, 0, 0, 0, -100)
    samples = ((320 * k).to_bytes(3, "little") + struct.pack(">3h", 10, 20, 30) for k in range(ROWS))
    return bytes(head) + b"".join(one + struct.pack("<3h", 0, 0, 2050) for one in samples)


def read_of(name: str, file: str = "export.bin") -> Callable[[LimitedReader, Path], object]:
    """Reads `file` as of this format, and places its first sensor."""

    def read(reader: LimitedReader, folder: Path) -> object:
        trial = LimitedReading(reader, nobody).read_trial(name, [folder / file], None)
        return place_trial(trial, {Site.LEFT_THIGH: trial.sensors[0].name}, "walk 1")

    return read


def nobody() -> None: ...


def importers() -> dict[str, Spoilable]:
    return {
        "csv": Spoilable(csv_text(), "walk_1/left_thigh.csv", read_folder, may_be_a_link=True),
        "parquet": Spoilable(parquet(), "walk_1/left_thigh.parquet", read_folder, may_be_a_link=True),
        "session.toml": Spoilable(TOML.encode(), "session.toml", read_folder, may_be_a_link=True),
        "xsens-mtmanager": Spoilable(mtmanager(), "export.txt", read_export, may_be_a_link=False),
        "movella-dot": Spoilable(movella_dot(), "export.csv", read_unnamed, may_be_a_link=False),
        "movella-dot-xlsx": Spoilable(movella_dot_xlsx(), "export.csv", read_unnamed, may_be_a_link=False),
        "mvnx": Spoilable(mvnx(), "export.csv", read_unnamed, may_be_a_link=False),
        "xsens-mti": Spoilable(mti(), "export.bin", read_of("xsens-mti"), may_be_a_link=False, is_stream=True),
        "ximu3": Spoilable(ximu3(), "export.bin", read_of("ximu3"), may_be_a_link=False, is_stream=True),
        "ximu3-csv": Spoilable(ximu3_csv(), "a.csv", read_of("ximu3", "a.csv"), may_be_a_link=False),
        "shimmer": Spoilable(shimmer(), "a.csv", read_of("shimmer", "a.csv"), may_be_a_link=False),
        "shimmer-card": Spoilable(
            shimmer_card(), "a.bin", read_of("shimmer", "a.bin"), may_be_a_link=False, is_stream=True
        ),
        "apdm": Spoilable(apdm(), "export.csv", read_unnamed, may_be_a_link=False),
        "csv-named": Spoilable(foreign_csv(), "export.csv", read_unnamed, may_be_a_link=False),
        "parquet-named": Spoilable(foreign_parquet(), "export.csv", read_unnamed, may_be_a_link=False),
        "xdf": Spoilable(xdf(), "export.csv", read_unnamed, may_be_a_link=False),
        "matlab": Spoilable(matlab(5), "export.csv", read_unnamed, may_be_a_link=False),
        "matlab-7.3": Spoilable(matlab(7), "export.csv", read_unnamed, may_be_a_link=False),
        "apdm-hdf5": Spoilable(apdm_hdf5(), "export.csv", read_unnamed, may_be_a_link=False),
        "opensim": Spoilable(opensim(), "export.csv", read_unnamed, may_be_a_link=False),
        "bids-motion": Spoilable(
            bids_rows(),
            "export_motion.tsv",
            read_bids,
            may_be_a_link=False,
            beside={"export_channels.tsv": bids_channels()},
        ),
        "bids-channels": Spoilable(
            bids_channels(),
            "export_channels.tsv",
            read_bids,
            may_be_a_link=False,
            beside={"export_motion.tsv": bids_rows()},
        ),
    }


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

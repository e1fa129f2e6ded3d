"""Small files that are large inside, deep, or never end: what each parser makes of them, in the reading process.

python -m tests.safety.bombs
"""

import gzip
import io
import json
import struct
import tempfile
import time
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

from devices.files.formats import FORMATS
from devices.files.limited_reader import LimitedReader, LimitedReading
from devices.files.refusal import FileRefusedError
from tests.driver import Found, drive

MOST_S = 90.0  # a file that is read to its deadline and a start of the process
HEAD = b"time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s\n"


def _laughs(levels: int, width: int) -> bytes:
    entities = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * width if k else "x" * 100}">' for k in range(levels))
    return f'<?xml version="1.0"?><!DOCTYPE mvnx [{entities}]><mvnx version="4">&l{levels - 1};</mvnx>'.encode()


def _zip(name: str, size: int, entries: int = 1) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for k in range(entries):
            archive.writestr(name.format(k), b"\0" * size)
    return content.getvalue()


def _matlab(size: int) -> bytes:
    """A MATLAB file of version 5 whose one compressed variable is `size` zeros."""
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H2s", 0x0100, b"IM")
    inside = struct.pack("<II", 14, size) + bytes(size)
    packed = zlib.compress(inside, 9)
    return head + struct.pack("<II", 15, len(packed)) + packed


def _xdf(length: int) -> bytes:
    return b"XDF:" + bytes([1, 9]) + struct.pack("<BQH", 8, length, 2) + b"<info/>"


def _hdf5(shape: tuple[int, ...]) -> bytes:
    import h5py

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.h5"
        with h5py.File(path, "w") as file:
            file.attrs["FileFormatVersion"] = 5
            group = file.create_group("Sensors/1")
            for name in ("Accelerometer", "Gyroscope", "Time"):
                group.create_dataset(name, shape, "f8", chunks=tuple(min(n, 1024) for n in shape), fillvalue=1.0)
        return path.read_bytes()


def bombs() -> dict[str, bytes]:
    """Files by name."""
    files: dict[str, bytes] = {}
    for levels, width in ((5, 10), (9, 10), (30, 2)):
        files[f"laughs-{levels}-{width}.mvnx"] = _laughs(levels, width)
    files["external.mvnx"] = (
        b'<?xml version="1.0"?><!DOCTYPE m [<!ENTITY e SYSTEM "file:///etc/passwd">]><mvnx>&e;</mvnx>'
    )
    files["deep.mvnx"] = b"<mvnx>" + b"<a>" * 200_000
    for depth in (1000, 200_000):
        files[f"deep-{depth}.json"] = b"[" * depth
        files[f"objects-{depth}_motion.json"] = b'{"a":' * depth
    files["numbers.json"] = b'{"SamplingFrequency": ' + b"9" * 2_000_000 + b"}"
    for size in (10**6, 10**9):
        files[f"sheet-{size}.xlsx"] = _zip("xl/worksheets/sheet1.xml", size)
        files[f"zeros-{size}.mat"] = _matlab(size)
        files[f"zeros-{size}.gz"] = gzip.compress(bytes(size), 9)
    files["many.zip"] = _zip("entry-{}", 10, 5000)
    for length in (2**31, 2**62, 2**64 - 1, 0):
        files[f"chunk-{length}.xdf"] = _xdf(length)
    for shape in ((10**9, 3), (10**12,), (2**40, 3)):
        files[f"empty-{shape[0]}.h5"] = _hdf5(shape)
    files["columns.csv"] = b"time_s," + b",".join(b"c%d" % k for k in range(300_000)) + b"\n1\n"
    files["one-line.csv"] = b"x" * 50_000_000
    files["commas.csv"] = HEAD + b"," * 20_000_000
    files["quotes.csv"] = HEAD + b'"' * 10_000_001
    files["quoted.csv"] = HEAD + b'"' + b"a\n" * 5_000_000
    files["nul.csv"] = HEAD + b"\0" * 10_000_000
    files["exponents.csv"] = HEAD + b"1e999999999,1,1,1,1,1,1\n" * 1000
    files["digits.csv"] = HEAD + b"9" * 5_000_000 + b",1,1,1,1,1,1\n"
    files["utf16.csv"] = HEAD.decode().encode("utf-16") * 1000
    files["header.txt"] = b"// " * 10_000_000
    files["comments.txt"] = b"// Update Rate: 100.0Hz\n" * 1_000_000
    files["tabs.sto"] = b"DataRate=100\nendheader\ntime" + b"\tleft" * 1_000_000
    files["rows.sto"] = b"nRows=99999999999\nnColumns=99999999999\nendheader\n"
    files["frames.c3d"] = bytes([2, 0x50]) + struct.pack("<HHHHHf", 65535, 65535, 1, 65535, 65535, -1.0) + bytes(500)
    files["packets.ximu3"] = b"I,0,1,2,3\n" * 1_000_000
    files["stream.bin"] = b"\xfa\xff\x36\xff\xff\xff" * 1_000_000
    files["card.000"] = b"\xff" * 20_000_000
    files["toml.toml"] = b"a = " + b"[" * 100_000
    files["parquet.parquet"] = b"PAR1" + bytes(10**7) + struct.pack("<I", 2**31 - 1) + b"PAR1"
    files["empty.csv"] = b""
    files["json-lines.csv"] = json.dumps({"a": "x" * 1_000_000}).encode() * 10
    return files


def run(formats: Callable[[str], bool] = lambda _: True) -> Found:
    """Read every file as each format, and without being given which."""
    outcome = Found()
    reader = LimitedReader()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in bombs().items():
            (folder / file).write_bytes(content)
        before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
        for path in sorted(folder.iterdir()):
            for format_name in ("", *filter(formats, FORMATS)):
                _read(LimitedReading(reader, lambda: None), path, format_name, outcome)
        if {path.name: path.stat().st_mtime_ns for path in folder.iterdir()} != before:
            outcome.faults.append("a file was made or changed")
    reader.close()
    return outcome


def _read(reading: LimitedReading, path: Path, format_name: str, outcome: Found) -> None:
    began_s = time.monotonic()
    outcome.count["readings"] += 1
    try:
        reading.read_trial(format_name, [path], 100.0)
    except FileRefusedError as refusal:
        outcome.count["refused"] += 1
        if "\n" in str(refusal):
            outcome.faults.append(f"{path.name} as {format_name}: a refusal of several lines")
    except Exception as error:  # the fault that is looked for
        outcome.faults.append(f"{path.name} as {format_name}: {type(error).__name__} {error!s:.200}")
    took_s = time.monotonic() - began_s
    outcome.figures["time, s"].append(took_s)
    if took_s > MOST_S + path.stat().st_size / 5e6:
        outcome.faults.append(f"{path.name} as {format_name}: {took_s:.0f} s")


if __name__ == "__main__":
    drive(__doc__, lambda _asked, _folder: run())

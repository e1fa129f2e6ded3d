"""What each emulated sensor states, kept as a file: imported with its units, counts and rates, or refused as none."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from devices.emulators.csv_lines import LineVoice
from devices.emulators.shimmer3 import Shimmer3Voice
from devices.emulators.witmotion import WitVoice
from devices.emulators.ximu3 import Ximu3Voice
from devices.emulators.xsens_mti import MtiVoice
from devices.files.formats import format_of, read_trial
from devices.files.gathering import gather

COUNT, HZ = 300, 100
RAD_S, M_S2 = (0.5, -1.0, 2.0), (1.0, -2.0, 9.5)


def in_g_and_degrees(number: int) -> tuple[float, ...]:
    return (*(value * 180 / np.pi for value in RAD_S), *(value / 9.80665 for value in M_S2))


def in_si(number: int) -> tuple[float, ...]:
    return (*RAD_S, *M_S2)


def raw(number: int) -> tuple[int, ...]:
    return (100, -200, 300, 10, 20, 2050)


def measured() -> bytes:
    """What an MTi sends by itself in three seconds."""
    now_s = [0.0]
    voice = MtiVoice("0280A1B2", in_si, has_orientation=False, now_ns=lambda: round(now_s[0] * 1e9))
    now_s[0] = (COUNT + 0.5) / HZ
    return voice.say()


STATED: dict[str, Callable[[], bytes]] = {
    "ximu3": lambda: b"\n" + b"".join(Ximu3Voice("0123ABCD", in_g_and_degrees).sample(k) for k in range(COUNT)),
    "xsens-mti": measured,
    "witmotion": lambda: b"".join(WitVoice("7", in_g_and_degrees).sample(k) for k in range(COUNT)),
    "shimmer3": lambda: b"".join(Shimmer3Voice(raw).sample(k) for k in range(COUNT)),
    "csv": lambda: b"".join(LineVoice(in_g_and_degrees).sample(k) for k in range(COUNT)),
}


@pytest.mark.parametrize("kind", ["ximu3", "xsens-mti"])
def test_bytes_that_a_program_keeps_are_imported(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "left_shank.bin"
    path.write_bytes(STATED[kind]())
    assert format_of(path) == kind
    (sensor,) = read_trial("", [path], None).sensors
    assert (len(sensor.block), sensor.info.rate_hz) == (COUNT, HZ)
    assert np.diff(sensor.block.time_s) == pytest.approx(1 / HZ, abs=1e-6)
    assert sensor.block.gyr_rad_s == pytest.approx(np.tile(RAD_S, (COUNT, 1)), abs=1e-4)
    assert sensor.block.acc_m_s2 == pytest.approx(np.tile(M_S2, (COUNT, 1)), abs=1e-3)
    assert sensor.findings == ()


@pytest.mark.parametrize("kind", ["witmotion", "shimmer3", "csv"])
def test_bytes_that_no_program_keeps_so_are_called_none(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "left_shank.bin"
    path.write_bytes(STATED[kind]())
    assert format_of(path) is None
    (refusal,) = gather([path]).refused
    assert refusal.what.startswith("the file format is not recognised")

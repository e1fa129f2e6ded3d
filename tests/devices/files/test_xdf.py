"""Tests that XDF files become samples on the recording computer's clock, with every loss reported.

No recording of LabRecorder is at hand: files are written here by the format's description, chunk by chunk.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.findings import Finding
from devices.files import xdf_streams
from devices.files.formats import recognised
from devices.files.refusal import FileRefusedError
from devices.files.straight_times import straight_times
from devices.files.trial import ImportedSensor
from devices.files.xdf import xdf_trial
from devices.simulation.walker_body import Walk, WalkerSettings
from tests.simulated import session_of
from tests.trials_of_files import import_with, refused

Numbers = NDArray[np.float64]
ROWS, RATE_HZ, START_S = 2000, 100.0, 4321.0
TIME_S = np.arange(ROWS) / RATE_HZ
LABELS = [*(f"acc_{axis}" for axis in "xyz"), *(f"gyr_{axis}" for axis in "xyz")]
UNITS = ["m/s^2"] * 3 + ["degrees/second"] * 3
BOUNDARY = bytes.fromhex("43A546DCCBF5410FB30ED5467383CBE4")


def motion(seed: int = 1) -> Numbers:
    """(n, 6): specific force in m/s2, rates in deg/s; of 32 bits as they are sent."""
    chance = np.random.default_rng(seed)
    samples = np.hstack([chance.normal([0.0, 0.0, 9.81], size=(ROWS, 3)), 50.0 * chance.normal(size=(ROWS, 3))])
    return samples.astype(np.float32).astype(np.float64)


@dataclass
class SentStream:
    """What one sender put on the network."""

    name: str
    samples: Numbers = field(default_factory=motion)
    stamp_s: Numbers = field(default_factory=lambda: START_S + TIME_S)
    labels: Sequence[str] = tuple(LABELS)
    units: Sequence[str] = tuple(UNITS)
    rate_hz: float = RATE_HZ
    host: str = "lab"
    offset_s: float | None = 0.0  # from the sender's clock to the recorder's
    is_deduced: bool = False  # stamps are given of the first of ten samples only
    footer: bool = True
    source: str | None = None

    def header(self, kind: str = "float32") -> str:
        channels = "".join(
            f"<channel><label>{label}</label><unit>{unit}</unit><type>IMU</type></channel>"
            for label, unit in zip(self.labels, self.units, strict=True)
        )
        source = f"id-{self.name}" if self.source is None else self.source
        return (
            f"<?xml version='1.0'?><info><name>{self.name}</name><type>IMU</type>"
            f"<channel_count>{len(self.labels)}</channel_count><nominal_srate>{self.rate_hz}</nominal_srate>"
            f"<channel_format>{kind}</channel_format><source_id>{source}</source_id>"
            f"<hostname>{self.host}</hostname><desc><channels>{channels}</channels></desc></info>"
        )


def chunk(tag: int, content: bytes) -> bytes:
    length = len(content) + 2
    head = struct.pack("<BB", 1, length) if length < 256 else struct.pack("<BI", 4, length)
    return head + struct.pack("<H", tag) + content


def recorded(path: Path, *streams: SentStream, has_markers: bool = True) -> Path:
    content = [b"XDF:"]
    content.append(chunk(1, b"<info><version>1.0</version><datetime>2026-03-04T10:11:12+0100</datetime></info>"))
    for number, one in enumerate(streams, start=1):
        content.append(chunk(2, struct.pack("<I", number) + one.header().encode()))
    if has_markers:
        content.append(
            chunk(2, struct.pack("<I", 99) + SentStream("buttons", labels=["go"], units=[""]).header("string").encode())
        )
        content.append(chunk(3, struct.pack("<IBBBd", 99, 1, 1, 8, START_S) + b"\x01\x03now"))
    for first in range(0, ROWS, 10):
        for number, one in enumerate(streams, start=1):
            rows = range(first, min(first + 10, len(one.stamp_s)))
            if one.offset_s is not None and first % 500 == 0:
                content.append(
                    chunk(4, struct.pack("<Idd", number, START_S - one.offset_s + first / 100, one.offset_s))
                )
            if not rows:
                continue
            reported = [
                struct.pack("<B", 0) if one.is_deduced and k != first else struct.pack("<Bd", 8, one.stamp_s[k])
                for k in rows
            ]
            values = [one.samples[k].astype("<f4").tobytes() for k in rows]
            samples = b"".join(stamp + value for stamp, value in zip(reported, values, strict=True))
            content.append(chunk(3, struct.pack("<IBB", number, 1, len(rows)) + samples))
        if first % 1000 == 0:
            content.append(chunk(5, BOUNDARY))
    for number, one in enumerate(streams, start=1):
        if one.footer:
            footer = f"<info><sample_count>{len(one.stamp_s)}</sample_count></info>"
            content.append(chunk(6, struct.pack("<I", number) + footer.encode()))
    path.write_bytes(b"".join(content))
    return path


def only(path: Path, rate_hz: float | None = None) -> ImportedSensor:
    (sensor,) = xdf_trial([path], rate_hz).sensors
    return sensor


def finding(sensor: ImportedSensor, key: str) -> Finding | None:
    return next((one for one in sensor.findings if one.key == key), None)


def test_streams_are_sensors_in_si_units_on_the_recorders_clock(tmp_path: Path) -> None:
    far = SentStream("right shank", motion(2), START_S + 7000.0 + TIME_S + 0.25, host="phone", offset_s=-7000.0)
    path = recorded(tmp_path / "a.txt", SentStream("left shank"), far)
    assert recognised([path]) == "xdf"
    trial = xdf_trial([path])
    assert trial.started[:10] == "2026-03-04"
    assert [len(one.block) for one in trial.sensors] == [ROWS, ROWS]
    placement = {Site.LEFT_SHANK: "left shank", Site.RIGHT_SHANK: "right_shank"}
    imported = import_with(xdf_trial, [path], placement, "walk 1")
    for site, seed, late_s in ((Site.LEFT_SHANK, 1, 0.0), (Site.RIGHT_SHANK, 2, 0.25)):
        block = imported.imu[site]
        np.testing.assert_allclose(block.acc_m_s2, motion(seed)[:, :3])
        np.testing.assert_allclose(block.gyr_rad_s, np.deg2rad(motion(seed)[:, 3:]))
        np.testing.assert_allclose(block.time_s, TIME_S + late_s, atol=1e-6)
        assert imported.sensors[site].rate_hz == RATE_HZ
    assert {one.key for one in imported.findings} == {"columns_understood", "columns_left_out"}
    assert [one.numbers for one in imported.findings if one.key == "columns_left_out"] == [{"names": "buttons"}] * 2


def test_two_sensors_in_one_stream_and_stamps_that_are_deduced(tmp_path: Path) -> None:
    labels = [f"{side}_{label}" for side in ("L", "R") for label in LABELS]
    both = SentStream("feet", np.hstack([motion(1), motion(2)]), labels=labels, units=UNITS * 2, is_deduced=True)
    trial = xdf_trial([recorded(tmp_path / "a.xdf", both)])
    assert [one.name for one in trial.sensors] == ["L", "R"]
    np.testing.assert_allclose(trial.sensors[1].block.acc_m_s2, motion(2)[:, :3])
    np.testing.assert_allclose(trial.sensors[1].block.time_s, TIME_S, atol=1e-9)


def test_a_shimmers_labels_are_understood_as_when_it_is_received(tmp_path: Path) -> None:
    """Labels and units as Consensys sends them: two accelerometers, of which the wide one is taken."""
    parts = {"Accel_LN": "m/(s^2)", "Accel_WR": "m/(s^2)", "Gyro": "deg/s"}
    labels = [f"Shimmer_5E3A_{part}_{axis}_CAL" for part in parts for axis in "XYZ"]
    units = [unit for unit in parts.values() for _ in "XYZ"]
    samples = np.hstack([motion(2)[:, :3], motion()])
    sensor = only(recorded(tmp_path / "a.xdf", SentStream("Shimmer", samples, labels=labels, units=units)))
    assert sensor.name == "Shimmer_5E3A"
    np.testing.assert_allclose(sensor.block.acc_m_s2, motion()[:, :3])
    np.testing.assert_allclose(sensor.block.gyr_rad_s, np.deg2rad(motion()[:, 3:]))
    left_out = finding(sensor, "columns_left_out")
    assert left_out is not None
    assert str(left_out.numbers["names"]).startswith("Shimmer_5E3A_Accel_LN_X_CAL, ")


def test_samples_that_a_sensor_did_not_send_are_a_gap(tmp_path: Path) -> None:
    kept = np.r_[0:500, 530:ROWS]
    sensor = only(recorded(tmp_path / "a.xdf", SentStream("a", motion()[kept], START_S + TIME_S[kept])))
    np.testing.assert_allclose(sensor.block.time_s, TIME_S[kept], atol=1e-9)
    assert finding(sensor, "times_straightened") is None


def test_stamps_of_packets_are_put_on_a_line_and_losses_stay_gaps(tmp_path: Path) -> None:
    chance = np.random.default_rng(3)
    kept = np.r_[0:700, 712:1500, 1501:ROWS]  # 120 ms are lost, and 10 ms that do not show
    late_s = np.repeat(chance.exponential(0.008, size=ROWS // 10), 10)
    late_s[1000:1050] += 0.4  # five packets wait and come at once
    stamps = np.repeat((TIME_S[9::10]), 10) + np.tile(np.arange(-9, 1), ROWS // 10) / RATE_HZ + late_s
    sensor = only(recorded(tmp_path / "a.xdf", SentStream("a", motion()[kept], START_S + stamps[kept])))
    stated = finding(sensor, "times_straightened")
    assert stated is not None
    assert 5.0 < float(stated.numbers["away_ms"]) < 40.0
    off_s = sensor.block.time_s - TIME_S[kept]
    assert np.ptp(off_s) < 0.012  # the one sample that does not show, and nothing of 400 ms
    assert np.diff(sensor.block.time_s)[699] == pytest.approx(0.13, abs=0.001)
    assert np.sum(np.diff(sensor.block.time_s) > 0.015) == 1


def test_even_stamps_stay_as_they_are() -> None:
    assert straight_times(START_S + TIME_S, RATE_HZ) is None
    assert straight_times(START_S + TIME_S[::3], RATE_HZ) is None  # every third was received
    assert straight_times(np.full(ROWS, np.nan), RATE_HZ) is None
    straight = straight_times(START_S + np.floor(TIME_S * 20) / 20, RATE_HZ)
    assert straight is not None
    assert np.ptp(straight.time_s - TIME_S) < 0.002


def test_a_recording_that_was_not_ended_states_so(tmp_path: Path) -> None:
    whole = recorded(tmp_path / "a.xdf", SentStream("a"))
    assert finding(only(whole), "stream_not_ended") is None
    assert finding(only(recorded(tmp_path / "b.xdf", SentStream("a", footer=False))), "stream_not_ended") is not None
    content = whole.read_bytes()
    whole.write_bytes(content[: len(content) // 2])
    cut = only(whole)
    assert finding(cut, "stream_not_ended") is not None
    assert 0.4 * ROWS < len(cut.block) < 0.6 * ROWS
    np.testing.assert_allclose(cut.block.acc_m_s2, motion()[: len(cut.block), :3])
    place = content.index(struct.pack("<IBB", 1, 1, 10), len(content) // 3)  # ten samples are called eleven
    whole.write_bytes(content[: place + 5] + b"\x0b" + content[place + 6 :])
    damaged = only(whole)
    assert finding(damaged, "stream_not_ended") is not None
    row = round(damaged.block.time_s[-1] * RATE_HZ)
    np.testing.assert_allclose(damaged.block.acc_m_s2[-1], motion()[row, :3])  # behind the next boundary it goes on
    assert set(map(tuple, damaged.block.acc_m_s2)) <= set(map(tuple, motion()[:, :3]))  # and nothing was made up


def test_a_clock_that_nobody_measured_is_reported(tmp_path: Path) -> None:
    both = xdf_trial(
        [recorded(tmp_path / "a.xdf", SentStream("a"), SentStream("b", host="phone", offset_s=None))]
    ).sensors
    assert [finding(one, "clock_not_measured") is not None for one in both] == [False, True]
    alone = only(recorded(tmp_path / "a.xdf", SentStream("b", host="phone", offset_s=None)))
    assert finding(alone, "clock_not_measured") is None


def test_what_senders_do_not_show_is_asked_for(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    def of(*streams: SentStream, rate_hz: float | None = None) -> str:
        return refused(xdf_trial, [recorded(tmp_path / "a.xdf", *streams)], rate_hz)

    back = START_S + TIME_S - 3.0 * (np.arange(ROWS) >= 1000)
    assert {
        "force and rates in streams of their own": of(
            SentStream("force", motion()[:, :3], labels=LABELS[:3], units=UNITS[:3]),
            SentStream("rate", motion()[:, 3:], labels=LABELS[3:], units=UNITS[3:]),
        ),
        "an unknown unit": of(SentStream("a", units=["V"] * 3 + UNITS[3:])),
        "called g, and m/s2": of(SentStream("a", units=["g"] * 3 + UNITS[3:])),
        "every label twice": of(SentStream("a", np.hstack([motion(), motion()]), labels=LABELS * 2, units=UNITS * 2)),
        "times that go back": of(SentStream("a", stamp_s=back, rate_hz=0.0)),
        "another rate is stated": of(SentStream("a"), rate_hz=60.0),
    } == snapshot


def test_a_simulated_walk_comes_back_as_it_was_sent(tmp_path: Path) -> None:
    """Three sensors of one leg that lose samples, each on the clock of its own sender."""
    sites = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
    settings = WalkerSettings(seed=3, recordings=(Walk(strides=8),), sites=sites, loss_fraction=0.02)
    walk = session_of(settings).recordings[0].imu
    assert max(map(len, walk.values())) <= ROWS
    streams = []
    for number, site in enumerate(sites):
        samples = np.hstack([walk[site].acc_m_s2, np.rad2deg(walk[site].gyr_rad_s)])
        stamps = (START_S + walk[site].time_s - 1000.0 * number).astype(np.float64)
        streams.append(SentStream(site, samples, stamps, host=site, offset_s=1000.0 * number))
    path = recorded(tmp_path / "a.xdf", *streams)
    imported = import_with(xdf_trial, [path], {site: site for site in sites}, "walk 1")
    start_s = min(walk[site].time_s[0] for site in sites)
    for site in sites:
        block = imported.imu[site]
        assert np.max(np.diff(block.time_s)) > 0.015
        np.testing.assert_allclose(block.time_s, walk[site].time_s - start_s, atol=1e-6)
        np.testing.assert_allclose(block.acc_m_s2, walk[site].acc_m_s2, atol=1e-4)
        np.testing.assert_allclose(block.gyr_rad_s, walk[site].gyr_rad_s, atol=1e-6)
        assert imported.sensors[site].rate_hz == settings.rate_hz
    assert {one.key for one in imported.findings} == {"columns_understood", "columns_left_out"}


def test_other_files_and_damaged_ones_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.xdf"
    for content in (b"XDF:", b"XDF:\x09", b"XDF:\x01\x02\x02\x00", b"XDF:\x08" + b"\xff" * 8):
        path.write_bytes(content)
        assert recognised([path]) == "xdf"
        with pytest.raises(FileRefusedError, match=r"cannot be read as XDF|no stream has acceleration"):
            xdf_trial([path])


def test_without_its_library_it_states_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = recorded(tmp_path / "a.xdf", SentStream("a"))
    monkeypatch.setattr(xdf_streams, "find_spec", lambda _: None)
    assert "pyxdf, which is not installed. Install gaitwright[imports]" in refused(xdf_trial, [path])


def test_stamps_of_packets_that_step_back_for_good_are_refused_and_make_no_other_rate(tmp_path: Path) -> None:
    chance = np.random.default_rng(3)
    late_s = np.repeat(chance.exponential(0.008, size=ROWS // 10), 10)
    stamps = START_S + np.repeat((TIME_S[9::10]), 10) + late_s
    assert (
        finding(only(recorded(tmp_path / "a.xdf", SentStream("a", stamp_s=stamps))), "times_straightened") is not None
    )
    for by_s in (0.3, 0.5, 3.0):
        back = stamps.copy()
        back[1000:] -= by_s
        with pytest.raises(FileRefusedError, match=r'a.xdf, a, sample 1001: "time" goes back from'):
            only(recorded(tmp_path / "a.xdf", SentStream("a", stamp_s=back)))


def test_a_line_through_stamps_of_packets_has_the_rate_that_the_sender_shows(tmp_path: Path) -> None:
    packets = np.repeat(TIME_S[9::10], 10)
    late_s = np.repeat(np.random.default_rng(3).exponential(0.008, size=ROWS // 10), 10)
    late_s[1000:1050] += 0.4  # five packets wait and come at once
    for factor in (0.985, 1.015):
        sensor = only(recorded(tmp_path / "a.xdf", SentStream("a", stamp_s=START_S + packets * factor + late_s)))
        assert finding(sensor, "times_straightened") is not None
    for factor in (0.96, 1.04):
        with pytest.raises(
            FileRefusedError, match=r"a.xdf, a: the times in the file give .* samples per second, expected 100"
        ):
            only(recorded(tmp_path / "a.xdf", SentStream("a", stamp_s=START_S + packets * factor)))


def test_a_block_that_jumps_away_and_returns_is_put_back_and_reported(tmp_path: Path) -> None:
    stamps = START_S + TIME_S
    stamps[800:900] += 200_000.0
    sensor = only(recorded(tmp_path / "a.xdf", SentStream("a", stamp_s=stamps)))
    np.testing.assert_allclose(sensor.block.time_s, TIME_S, atol=1e-6)
    reported = finding(sensor, "stamps_mended")
    assert reported is not None
    assert reported.numbers == {"count": 100, "left_out": 0, "first": 801, "off_s": 200_000.0}


def test_streams_of_one_name_are_reported_apart_by_their_source_or_their_number(tmp_path: Path) -> None:
    def names(*sources: str) -> list[str]:
        streams = [SentStream("imu", motion(seed), source=source) for seed, source in enumerate(sources)]
        return [one.name for one in xdf_trial([recorded(tmp_path / "a.xdf", *streams)]).sensors]

    assert names("x") == ["imu"]
    assert names("x", "y") == ["imu x", "imu y"]
    assert names("x", "x") == ["imu 1", "imu 2"]
    assert names("", "") == ["imu 1", "imu 2"]


def test_computers_whose_clocks_were_not_measured_start_together_on_clocks_of_their_own(tmp_path: Path) -> None:
    streams = [
        SentStream("a", motion(1), START_S + TIME_S, host="one", offset_s=None),
        SentStream("b", motion(2), START_S + TIME_S + 0.25, host="one", offset_s=None),
        SentStream("c", motion(3), START_S + TIME_S + 5000.0, host="two", offset_s=None),
    ]
    sensors = xdf_trial([recorded(tmp_path / "a.xdf", *streams)]).sensors
    assert [round(float(one.block.time_s[0]), 6) for one in sensors] == [0.0, 0.25, 0.0]
    assert [one.info.clock for one in sensors] == ["one", "one", "two"]
    assert all(finding(one, "clock_not_measured") is not None for one in sensors)
    measured = xdf_trial([recorded(tmp_path / "a.xdf", SentStream("a"), SentStream("b", host="phone"))]).sensors
    assert {one.info.clock for one in measured} == {""}

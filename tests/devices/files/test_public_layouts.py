"""Tests that files laid out as public ones of many programs are read, or refused with the reason.

The layouts are those that programs and readers of such files show in public repositories; the motion is ours.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from syrupy.assertion import SnapshotAssertion

from devices.files.formats import read_trial
from devices.files.table_choices import ALL_TABLES, TableChoices
from devices.files.trial import ImportedTrial
from tests.trials_of_files import refused

Numbers = NDArray[np.float64]
G = 9.80665
ROWS = 800
NANOSECONDS = 1_788_594_189_000_000_000  # of a day in 2026


@dataclass(frozen=True)
class MovedSensor:
    """A shank that swings: specific force in m/s2, rates in rad/s, at even times."""

    hz: float = 100.0
    rows: int = ROWS
    phase: float = 0.0
    time_s: Numbers = field(init=False)
    acc: Numbers = field(init=False)
    free_acc: Numbers = field(init=False)
    gyr: Numbers = field(init=False)

    def __post_init__(self) -> None:
        time_s = np.arange(self.rows) / self.hz
        angle, rate = 0.7 * np.sin(5.65 * time_s + self.phase), 0.7 * 5.65 * np.cos(5.65 * time_s + self.phase)
        turn = Rotation.from_euler("x", 70, degrees=True) * Rotation.from_rotvec(angle[:, None] * [0.6, 0.0, 0.8])
        moved = np.column_stack([np.sin(7 * time_s), time_s * 0, np.cos(5 * time_s)])
        values = {
            "time_s": time_s,
            "acc": turn.inv().apply(moved + np.array([0.0, 0.0, G])),
            "free_acc": turn.inv().apply(moved),
            "gyr": rate[:, None] * np.array([0.6, 0.0, 0.8]),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)


LEFT, RIGHT = MovedSensor(), MovedSensor(phase=1.0)


def write(path: Path, lines: Sequence[str], encoding: str = "utf-8") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes("\n".join([*lines, ""]).encode(encoding))
    return path


def rows_of(*columns: Numbers, form: str = "%.6f", by: str = ",", end: str = "") -> list[str]:
    return [by.join(form % value for value in row) + end for row in np.column_stack(columns)]


def clock(time_s: float, start_s: float = 86_395.0, form: str = "{:02d}:{:02d}:{:02d}.{:03d}") -> str:
    """The time of day, over midnight."""
    ms = round(1000 * (start_s + time_s)) % 86_400_000
    return form.format(ms // 3_600_000, ms // 60_000 % 60, ms // 1000 % 60, ms % 1000)


def iso(time_s: float, between: str = "T") -> str:
    day = 28 if time_s < 5 else 29
    return f"2026-11-{day}{between}{clock(time_s)}"


# Each writes files below a folder and gives those to import.


def ximu(folder: Path) -> list[Path]:
    """x-io's x-IMU: packet numbers count all packets, the rate is in the registers; a comma ends each row."""
    motion = MovedSensor(hz=128.0)
    number = 100 + np.cumsum(1 + np.arange(ROWS) % 2)
    head = "Packet number,Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s),Accelerometer X (g),"
    head += "Accelerometer Y (g),Accelerometer Z (g),Magnetometer X (G),Magnetometer Y (G),Magnetometer Z (G)"
    body = rows_of(np.degrees(motion.gyr), motion.acc / G, 0 * motion.acc + 0.2, form="%.7g")
    lines = [head, *(f"{int(n)},{row}" for n, row in zip(number, body, strict=True))]
    registers = ["Packet number,Address,Value,Fixed-point value,Name", "70,69,8,NaN,InertialAndMagneticDataRate"]
    write(folder / "00033_Registers.csv", [*registers, "71,70,8,NaN,QuaternionDataRate"])
    return [write(folder / "00033_CalInertialAndMag.csv", lines)]


WITMOTION = "DeviceName\tChipTime()\tAccX(g)\tAccY(g)\tAccZ(g)\tAsX(°/s)\tAsY(°/s)\tAsZ(°/s)\tAngleX(°)\tQ0()"


def witmotion_of_two(folder: Path) -> list[Path]:
    """WitMotion: rows of two sensors in turn, ISO times over midnight, a chip time of null, the header again."""
    lines = [f"time\t{WITMOTION}"]
    values = [rows_of(one.acc / G, np.degrees(one.gyr), by="\t") for one in (LEFT, RIGHT)]
    for k in range(ROWS):
        for name, body in zip(("WT901(0C:BF)", "WT901(1C:BF)"), values, strict=True):
            lines.append(f"{iso(LEFT.time_s[k])}\t{name}\tnull\t{body[k]}\t1.0\t0.9")
        lines += lines[:1] if k == 400 else []
    return [write(folder / "20260103105034.tsv", lines, "utf-8-sig")]


def witmotion_chinese(folder: Path) -> list[Path]:
    head = "时间,设备名称,加速度X(g),加速度Y(g),加速度Z(g),角速度X(°/s),角速度Y(°/s),角速度Z(°/s),角度X(°)"
    body = rows_of(LEFT.acc / G, np.degrees(LEFT.gyr))
    times = [clock(time_s) for time_s in LEFT.time_s]
    return [write(folder / "a.csv", [head, *(f"{t},WT,{b},0" for t, b in zip(times, body, strict=True))], "utf-8-sig")]


def witmotion_text(folder: Path) -> list[Path]:
    """Its older program: columns of blanks, below the time of the start."""
    head = " Time(s)        ax(g)    ay(g)    az(g)    wx(deg/s) wy(deg/s) wz(deg/s) AngleX(deg)"
    body = rows_of(LEFT.acc / G, np.degrees(LEFT.gyr), LEFT.time_s, by="   ", form="%9.6f")
    times = [clock(time_s) for time_s in LEFT.time_s]
    return [write(folder / "a.txt", ["StartTime: 2026-11-28", head, *map("  ".join, zip(times, body, strict=True))])]


def metabase(folder: Path) -> list[Path]:
    """MetaMotion: accelerometer and gyroscope apart, three times, the sensor's address in the names."""
    files = []
    for address, motion in (("F1B2C3D4E5F6", LEFT), ("A1B2C3D4E5F6", RIGHT)):
        for what, unit, values in (
            ("Accelerometer", "g", motion.acc / G),
            ("Gyroscope", "deg/s", motion.gyr * 57.29578),
        ):
            name = f"MetaWear_2026-11-28T16.57.34.945_{address}_{what}_100.000Hz_1.7.3.csv"
            head = "epoc (ms),timestamp (-0700),elapsed (s)," + ",".join(f"{axis}-axis ({unit})" for axis in "xyz")
            rows = [
                f"{1_664_377_054_945 + 10 * k},{iso(0.01 * k).replace(':', '.')},{0.01 * k:.3f},{row}"
                for k, row in enumerate(rows_of(values))
            ]
            files.append(write(folder / name, [head, *rows]))
    return files


def sensor_logger(folder: Path, force: str = "TotalAcceleration", acc: Numbers = LEFT.acc) -> list[Path]:
    """A telephone's Sensor Logger: nanoseconds of 1970, the axes in another order, the quantity in the name alone."""
    files = []
    for what, values in ((force, acc), ("Gyroscope", LEFT.gyr)):
        stamps = [NANOSECONDS + round(1e9 * t) for t in LEFT.time_s]
        rows = [
            f"{stamp},{t + 0.07:.7f},{row}"
            for stamp, t, row in zip(stamps, LEFT.time_s, rows_of(values[:, ::-1]), strict=True)
        ]
        files.append(write(folder / "walk" / f"{what}.csv", ["time,seconds_elapsed,z,y,x", *rows]))
    return files


def phyphox_german(folder: Path) -> list[Path]:
    """phyphox as saved for a German spreadsheet."""
    head = '"Zeit (s)";"Beschleunigung x (m/s^2)";"Beschleunigung y (m/s^2)";"Beschleunigung z (m/s^2)";'
    head += '"Gyroskop x (rad/s)";"Gyroskop y (rad/s)";"Gyroskop z (rad/s)"'
    body = [row.replace(".", ",") for row in rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr, by=";", form="%.9E")]
    return [write(folder / "Raw Data.csv", [head, *body])]


def phyphox_apart(folder: Path) -> list[Path]:
    """phyphox in two files of different rates."""
    fast = MovedSensor(hz=200.0, rows=2 * ROWS)
    acc = (
        '"Time (s)","Acceleration x (m/s^2)","Acceleration y (m/s^2)","Acceleration z (m/s^2)","Absolute acceleration"'
    )
    gyr = '"Time (s)","Gyroscope x (rad/s)","Gyroscope y (rad/s)","Gyroscope z (rad/s)","Absolute (rad/s)"'
    size = np.linalg.norm(LEFT.acc, axis=1)
    return [
        write(folder / "walk" / "Accelerometer.csv", [acc, *rows_of(LEFT.time_s, LEFT.acc, size)]),
        write(folder / "walk" / "Gyroscope.csv", [gyr, *rows_of(fast.time_s, fast.gyr, fast.time_s)]),
    ]


def physics_toolbox(folder: Path) -> list[Path]:
    times = [clock(t, form="{:d}:{:02d}:{:02d}:{:03d}") for t in LEFT.time_s]
    body = rows_of(LEFT.acc / G, LEFT.gyr, 0 * LEFT.acc, form="%.4f", end=",")
    head = "time,gFx,gFy,gFz,wx (rad/s),wy (rad/s),wz (rad/s),Bx,By,Bz,"
    return [write(folder / "a.csv", [head, *map(",".join, zip(times, body, strict=True))])]


def axivity(folder: Path) -> list[Path]:
    head = "Time,Accel-X (g), Accel-Y (g), Accel-Z (g), Gyro-X (d/s), Gyro-Y (d/s), Gyro-Z (d/s)"
    body = rows_of(LEFT.acc / G, np.degrees(LEFT.gyr))
    return [
        write(folder / "a.csv", [head, *(f"{iso(t, ' ')},{row}" for t, row in zip(LEFT.time_s, body, strict=True))])
    ]


def lpms(folder: Path) -> list[Path]:
    """LP-Research: two sensors one after the other in each frame."""
    head = "SensorId, TimeStamp (s), FrameNumber, AccX (g), AccY (g), AccZ (g), GyroX (deg/s), GyroY (deg/s), "
    head += "GyroZ (deg/s), MagX (uT), MagY (uT), MagZ (uT), EulerX (deg), EulerY (deg), EulerZ (deg), QuatW, QuatX, "
    head += "QuatY, QuatZ, LinAccX (g), LinAccY (g), LinAccZ (g)"
    more = "1, 2, 3, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0"
    lines = [head]
    bodies = [rows_of(one.acc / G, np.degrees(one.gyr), by=", ") for one in (LEFT, RIGHT)]
    for k in range(ROWS):
        lines += [f"{n}, {0.01 * k:.4f}, {k}, {body[k]}, {more}" for n, body in enumerate(bodies, 1)]
    return [write(folder / "a.csv", lines)]


def blue_trident(folder: Path) -> list[Path]:
    head = "unix_timestamp_microsec,time_s,ax_m/s/s,ay_m/s/s,az_m/s/s,gx_deg/s,gy_deg/s,gz_deg/s"
    body = rows_of(LEFT.time_s, LEFT.acc, np.degrees(LEFT.gyr))
    rows = [f"{1_664_377_054_945_000 + 10_000 * k},{row}" for k, row in enumerate(body)]
    return [write(folder / "TS-02_2026-lowg.csv", [head, *rows])]


def ngimu(folder: Path) -> list[Path]:
    head = "Timestamp (s);Gyroscope X (deg/s);Gyroscope Y (deg/s);Gyroscope Z (deg/s);Accelerometer X (g);"
    head += "Accelerometer Y (g);Accelerometer Z (g);Magnetometer X (uT);Magnetometer Y (uT);Magnetometer Z (uT);"
    head += "Barometer (hPa)"
    body = rows_of(LEFT.time_s, np.degrees(LEFT.gyr), LEFT.acc / G, LEFT.acc, LEFT.time_s, by=";")
    return [write(folder / "sensors.csv", [head, *body])]


def picoquake(folder: Path) -> list[Path]:
    """No times: samples are counted, and the rate is in a comment."""
    head = [
        "# PLab PicoQuake Data",
        "# Num. samples: 800, Duration: 8.0 s",
        "# Config: data_rate = 100.0 Hz, filter = 42 Hz",
    ]
    body = [f"{k},{row}" for k, row in enumerate(rows_of(LEFT.acc / G, np.degrees(LEFT.gyr)), 1)]
    return [write(folder / "a.csv", [*head, "count,a_x,a_y,a_z,g_x,g_y,g_z", *body])]


def kfall(folder: Path) -> list[Path]:
    """Units by size: g and deg/s."""
    head = "TimeStamp(s),FrameCounter,AccX,AccY,AccZ,GyrX,GyrY,GyrZ,EulerX,EulerY,EulerZ"
    body = rows_of(LEFT.time_s, np.arange(float(ROWS)), LEFT.acc / G, np.degrees(LEFT.gyr), 0 * LEFT.acc)
    return [write(folder / "S06T01R01.csv", [head, *body])]


def sensorlog(folder: Path) -> list[Path]:
    """An iPhone's SensorLog: times as texts and as numbers, two accelerations of which one lacks gravity."""
    head = "loggingTime(txt),loggingSample(N),accelerometerTimestamp_sinceReboot(s),accelerometerAccelerationX(G),"
    head += (
        "accelerometerAccelerationY(G),accelerometerAccelerationZ(G),gyroTimestamp_sinceReboot(s),gyroRotationX(rad/s),"
    )
    head += "gyroRotationY(rad/s),gyroRotationZ(rad/s)"
    body = [
        f"{iso(t, ' ')} +0100,{k},{5000 + t:.6f},{a},{5000 + t:.6f},{g}"
        for k, (t, a, g) in enumerate(zip(LEFT.time_s, rows_of(LEFT.acc / G), rows_of(LEFT.gyr), strict=True))
    ]
    return [write(folder / "a.csv", [head, *body])]


def excel_unicode(folder: Path) -> list[Path]:
    """Saved as Unicode text by Excel: UTF-16, tabs, commas; a line of units; empty rows at the end."""
    names = ["Time", *(f"{what} {axis}" for what in ("Acc", "Gyro") for axis in "XYZ")]
    units = ["ms", *["m/s²"] * 3, *["°/s"] * 3]
    body = [row.replace(".", ",") for row in rows_of(1000 * LEFT.time_s, LEFT.acc, np.degrees(LEFT.gyr), by="\t")]
    return [write(folder / "a.txt", ["\t".join(names), "\t".join(units), *body, "\t" * 6, "\t" * 6], "utf-16")]


def of_r(folder: Path) -> list[Path]:
    """Written by R: quoted names, numbers of rows, NA."""
    head = '"","time_ms","acc_x","acc_y","acc_z","gyr_x_rad_s","gyr_y_rad_s","gyr_z_rad_s"'
    body = rows_of(1000 * LEFT.time_s, LEFT.acc, LEFT.gyr)
    body[100] = body[100].split(",")[0] + ",NA" * 6
    return [write(folder / "a.csv", [head, *(f'"{k}",{row}' for k, row in enumerate(body, 1))])]


def of_numpy(folder: Path) -> list[Path]:
    """Written by numpy.savetxt: the header is a comment, blanks divide the columns."""
    head = "# time_s acc_x acc_y acc_z gyr_x_rad_s gyr_y_rad_s gyr_z_rad_s"
    return [write(folder / "a.txt", [head, *rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr, by=" ", form="%.9e")])]


def windows_excel(folder: Path) -> list[Path]:
    """Saved by a German Excel: cp1252, a preamble, the times of a day, semicolons to the end of every line."""
    head = "Zeit;Acc X [m/s²];Acc Y [m/s²];Acc Z [m/s²];Gyro X [°/s];Gyro Y [°/s];Gyro Z [°/s];;"
    times = [clock(t, form="{:02d}:{:02d}:{:02d},{:03d}") for t in LEFT.time_s]
    body = [row.replace(".", ",") for row in rows_of(LEFT.acc, np.degrees(LEFT.gyr), by=";")]
    before = ["Patient;Größe 1,80 m;;;;;;;", "Abtastrate;100 Hz;;;;;;;", ";;;;;;;;", head]
    return [write(folder / "a.csv", [*before, *(f"{t};{r};;" for t, r in zip(times, body, strict=True))], "cp1252")]


def myoresearch(folder: Path) -> list[Path]:
    """Noraxon in German: cp1252, a preamble, mG, one word more in the names of accelerations, mixed line ends."""
    names, columns = ["Time [s]"], [LEFT.time_s]
    for place, motion in (("Thigh LT", LEFT), ("Shank LT", RIGHT)):
        names += [f"MyoMotion {place} Accel Sensor {axis} (mG)" for axis in "XYZ"]
        names += [f"MyoMotion {place} Gyroscope {axis} (°/s)" for axis in "XYZ"]
        columns += [motion.acc * 1000 / G, np.degrees(motion.gyr)]
    body = [row.replace(".", ",") + "\r" * (k % 2) for k, row in enumerate(rows_of(*columns, by=";"))]
    return [write(folder / "a.csv", ["Name;Müller", "Frequenz;100 Hz", "", ";".join(names), *body], "cp1252")]


def witmotion_unpadded(folder: Path) -> list[Path]:
    """Thousandths of seconds without zeros before them, four rows to a stamp, over midnight."""
    lines = ["time\tDeviceName\tAccX(g)\tAccY(g)\tAccZ(g)\tAsX(°/s)\tAsY(°/s)\tAsZ(°/s)"]
    for k, row in enumerate(rows_of(LEFT.acc / G, np.degrees(LEFT.gyr), by="\t")):
        whole, _, part = clock(LEFT.time_s[4 * (k // 4)]).partition(".")
        lines.append(f"{whole}:{int(part)}\tWT901\t{row}")
    return [write(folder / "a.txt", lines)]


def sensor_logger_joined(folder: Path) -> list[Path]:
    head = "time,seconds_elapsed,TotalAcceleration_z,TotalAcceleration_y,TotalAcceleration_x,"
    head += "Gyroscope_z,Gyroscope_y,Gyroscope_x"
    stamps = [NANOSECONDS + round(1e9 * t) for t in LEFT.time_s]
    body = rows_of(LEFT.time_s, LEFT.acc[:, ::-1], LEFT.gyr[:, ::-1])
    return [write(folder / "a.csv", [head, *(f"{s},{row}" for s, row in zip(stamps, body, strict=True))])]


def movesense(folder: Path) -> list[Path]:
    """No units, and milliseconds of packets of eight samples."""
    stamps = 2_345_678 + np.round(1000 * LEFT.time_s[8 * (np.arange(ROWS) // 8)])
    body = rows_of(stamps, LEFT.acc, np.degrees(LEFT.gyr), form="%.10g")
    return [write(folder / "a.csv", ["timestamp,accX,accY,accZ,gyroX,gyroY,gyroZ", *body])]


def nexus(folder: Path, force: str = "g", scale: float = 1 / G) -> list[Path]:
    """Vicon's devices: the rate, the names of groups, axes alone, and units in lines of their own."""
    groups = [f"{imu} - {what},," for imu in ("IMU 1", "IMU 2") for what in ("Acceleration", "Gyroscope")]
    head = ["Devices", "Sample rate: 100", ",," + ",".join(groups), "Frame,Sub Frame" + ",x,y,z" * 4]
    head += [",," + ",".join(([force] * 3 + ["deg/s"] * 3) * 2)]
    rates = [np.degrees(motion.gyr) for motion in (LEFT, RIGHT)]
    frames = 1 + np.arange(float(ROWS))
    body = rows_of(frames, 0 * frames, LEFT.acc * scale, rates[0], RIGHT.acc * scale, rates[1], form="%.10g")
    return [write(folder / "a.csv", [*head, *body])]


def groups_of_excel(folder: Path) -> list[Path]:
    """Merged cells with the places above the names."""
    axes = [f"{what} {axis} ({unit})" for what, unit in (("acc", "g"), ("gyr", "rad/s")) for axis in "xyz"]
    head = [",left thigh,,,,,,left shank,,,,,", ",".join(["time (s)", *axes, *axes])]
    body = rows_of(LEFT.time_s, LEFT.acc / G, LEFT.gyr, RIGHT.acc / G, RIGHT.gyr, form="%.7f")
    return [write(folder / "a.csv", [*head, *body], "utf-8-sig")]


def of_pandas(folder: Path) -> list[Path]:
    """Written by pandas: numbers of rows without a name, several words for nothing."""
    body = [f"{k},{row}" for k, row in enumerate(rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr))]
    for k, word in enumerate(("<NA>", "NaT", "None", "-1.#IND"), 150):
        body[k] = ",".join([*body[k].split(",")[:2], *[word] * 6])
    return [write(folder / "a.csv", [",t,ax,ay,az,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s", *body])]


def of_r_in_german(folder: Path) -> list[Path]:
    """write.csv2: semicolons and decimal commas, words cut short, numbers of rows in quotation marks."""
    names = [
        "",
        "Zeit [ms]",
        *(f"Beschl. {axis} [m/s²]" for axis in "xyz"),
        *(f"Drehrate {axis} [°/s]" for axis in "xyz"),
    ]
    body = [row.replace(".", ",") for row in rows_of(1000 * LEFT.time_s, LEFT.acc, np.degrees(LEFT.gyr), by=";")]
    lines = [";".join(f'"{name}"' for name in names), *(f'"{k}";{row}' for k, row in enumerate(body, 1))]
    return [write(folder / "a.csv", lines, "cp1252")]


def appended(folder: Path) -> list[Path]:
    """A logger that was started twice in one file: comments and header again."""
    head = ["# logger 2.1", "# boot", "Time [s],A_X [g],A_Y [g],A_Z [g],G_X [dps],G_Y [dps],G_Z [dps]"]
    body = rows_of(LEFT.time_s, LEFT.acc / G, np.degrees(LEFT.gyr))
    return [write(folder / "a.csv", [*head, *body[:400], *head, *body[400:]])]


def st_logger(folder: Path) -> list[Path]:
    """STMicroelectronics: mg and mdps, commas in times of a day, a preamble."""
    head = ["Logged started on;01/03/2026", "Nodes;LSM6DSOX@C0:51"]
    head += ["Time;Counter;A_X [mg];A_Y [mg];A_Z [mg];G_X [mdps];G_Y [mdps];G_Z [mdps]"]
    times = [clock(t, form="{:02d}:{:02d}:{:02d},{:03d}") for t in LEFT.time_s]
    body = rows_of(np.arange(float(ROWS)), LEFT.acc * 1000 / G, np.degrees(LEFT.gyr) * 1000, by=";", form="%.0f")
    return [write(folder / "a.csv", [*head, *map(";".join, zip(times, body, strict=True))])]


def minutes_and_broken_degrees(folder: Path) -> list[Path]:
    """Minutes, and degrees that were encoded twice."""
    head = "Time [min];AccX [g];AccY [g];AccZ [g];GyrX [Â°/s];GyrY [Â°/s];GyrZ [Â°/s]"
    body = rows_of(LEFT.time_s / 60, LEFT.acc / G, np.degrees(LEFT.gyr), by=";", form="%.9f")
    return [write(folder / "a.csv", [head, *body])]


def commas_in_quotes(folder: Path) -> list[Path]:
    head = '"time_s","acc_x_m_s2","acc_y_m_s2","acc_z_m_s2","gyr_x_rad_s","gyr_y_rad_s","gyr_z_rad_s"'
    body = rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr, by=" ")
    return [write(folder / "a.csv", [head, *(f'"{row}"'.replace(" ", '","').replace(".", ",") for row in body)])]


@dataclass(frozen=True)
class ReadLayout:
    """What has to come out: the sensors' motion in order, and findings that have to be among those reported."""

    write: Callable[[Path], list[Path]]
    motions: tuple[MovedSensor, ...] = (LEFT,)
    findings: tuple[str, ...] = ()
    atol: float = 2e-4  # of m/s2 and rad/s: digits that the layout has
    lost: int = 0


READ = {
    "x-IMU": ReadLayout(ximu, (MovedSensor(hz=128.0),), ("packet_numbers",)),
    "WitMotion, two sensors": ReadLayout(witmotion_of_two, (LEFT, RIGHT)),
    "WitMotion, Chinese": ReadLayout(witmotion_chinese),
    "WitMotion, text": ReadLayout(witmotion_text),
    "MetaBase": ReadLayout(metabase, (LEFT, RIGHT), ("joined_files",)),
    "Sensor Logger": ReadLayout(sensor_logger, findings=("joined_files",)),
    "phyphox, German": ReadLayout(phyphox_german),
    "phyphox, two files": ReadLayout(
        phyphox_apart, (MovedSensor(hz=200.0, rows=2 * ROWS),), ("joined_files",), atol=0.1
    ),
    "Physics Toolbox": ReadLayout(physics_toolbox, atol=2e-3),
    "Axivity AX6": ReadLayout(axivity),
    "LPMS": ReadLayout(lpms, (LEFT, RIGHT)),
    "Blue Trident": ReadLayout(blue_trident),
    "NGIMU": ReadLayout(ngimu),
    "PicoQuake": ReadLayout(picoquake, findings=("unit_by_size",)),
    "KFall": ReadLayout(kfall, findings=("unit_by_size",)),
    "SensorLog": ReadLayout(sensorlog),
    "Excel, Unicode": ReadLayout(excel_unicode),
    "R": ReadLayout(of_r, lost=1),
    "NumPy": ReadLayout(of_numpy),
    "Excel, Windows": ReadLayout(windows_excel),
    "myoResearch": ReadLayout(myoresearch, (LEFT, RIGHT)),
    "WitMotion, unpadded": ReadLayout(witmotion_unpadded, findings=("stamps_spread",)),
    "Sensor Logger, joined": ReadLayout(sensor_logger_joined),
    "Movesense": ReadLayout(movesense, findings=("stamps_spread", "unit_by_size")),
    "Nexus": ReadLayout(nexus, (LEFT, RIGHT)),
    "Excel, groups": ReadLayout(groups_of_excel, (LEFT, RIGHT)),
    "pandas": ReadLayout(of_pandas, lost=4),
    "R, German": ReadLayout(of_r_in_german),
    "appended": ReadLayout(appended),
    "ST": ReadLayout(st_logger, atol=1e-2),
    "minutes": ReadLayout(minutes_and_broken_degrees),
    "decimal commas in quotes": ReadLayout(commas_in_quotes),
}


def all_findings(trial: ImportedTrial) -> set[str]:
    return {found.key for sensor in trial.sensors for found in sensor.findings}


@pytest.mark.parametrize("name", READ)
def test_a_public_layout_is_read(name: str, tmp_path: Path) -> None:
    known = READ[name]
    trial = read_trial("", known.write(tmp_path), None)
    assert not trial.unread
    assert len(trial.sensors) == len(known.motions)
    for sensor, motion in zip(trial.sensors, known.motions, strict=True):
        block = sensor.block
        assert len(block) == len(motion.time_s) - known.lost
        at = np.rint((block.time_s - block.time_s[0]) * motion.hz).astype(int)
        np.testing.assert_allclose(block.time_s - block.time_s[0], at / motion.hz, atol=1.1e-3)
        np.testing.assert_allclose(block.acc_m_s2, motion.acc[at], atol=known.atol)
        np.testing.assert_allclose(block.gyr_rad_s, motion.gyr[at], atol=known.atol)
        assert sensor.info.rate_hz == pytest.approx(motion.hz, rel=0.01)
    assert set(known.findings) <= all_findings(trial)


# Each writes what cannot be read; the refusal has to say why.


def motionsense(folder: Path) -> list[Path]:
    head = ",attitude.roll,attitude.pitch,attitude.yaw,gravity.x,gravity.y,gravity.z,rotationRate.x,rotationRate.y,"
    head += "rotationRate.z,userAcceleration.x,userAcceleration.y,userAcceleration.z"
    body = rows_of(np.arange(float(ROWS)), 0 * LEFT.acc, LEFT.acc / G, LEFT.gyr, 0.1 * LEFT.acc / G)
    return [write(folder / "sub_1.csv", [head, *body])]


def actigraph(folder: Path) -> list[Path]:
    before = ["------------ Data File Created By ActiGraph GT3X+ ActiLife v6 ----------", "Serial Number: TAS1D4814"]
    before += ["Start Time 12:00:00", "Start Date 11/28/2026", "Epoch Period (hh:mm:ss) 00:00:00", *[""] * 4, "-----"]
    head = "Accelerometer X,Accelerometer Y,Accelerometer Z"
    return [write(folder / "a.csv", [*before, head, *rows_of(LEFT.acc / G)])]


def no_header(folder: Path) -> list[Path]:
    return [write(folder / "a.csv", rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr))]


def commas_in_commas(folder: Path) -> list[Path]:
    head = "time_s,acc_x,acc_y,acc_z,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s"
    return [
        write(folder / "a.csv", [head, *(row.replace(".", ",") for row in rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr))])
    ]


def angles_alone(folder: Path) -> list[Path]:
    """Movella DOT's logging of Euler angles alone."""
    head = ["sep=,", "DeviceTag:,lt", "OutputRate:,60Hz", "", "PacketCounter,SampleTimeFine,Euler_X,Euler_Y,Euler_Z"]
    return [write(folder / "a.csv", [*head, *(f"{k},{16667 * k},{k % 90},0.5,0.25" for k in range(100))])]


def a_letter(folder: Path) -> list[Path]:
    return [write(folder / "a.txt", ["Dear colleague,", "", "the walk of 3 March is attached.", "With kind regards"])]


def a_picture(folder: Path) -> list[Path]:
    (folder / "a.csv").write_bytes(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(range(256)) * 10)
    return [folder / "a.csv"]


def cut_while_copied(folder: Path) -> list[Path]:
    (path,) = blue_trident(folder)
    path.write_bytes(path.read_bytes()[:-30])
    return [path]


def two_clocks(folder: Path) -> list[Path]:
    """phyphox's two tables side by side."""
    names = ["Time (s)", *(f"Acceleration {axis} (m/s^2)" for axis in "xyz")]
    names += ["Time (s)", *(f"Gyroscope {axis} (rad/s)" for axis in "xyz")]
    body = rows_of(LEFT.time_s, LEFT.acc, LEFT.time_s + 0.3, LEFT.gyr)
    return [write(folder / "a.csv", [",".join(f'"{name}"' for name in names), *body])]


def thousands(folder: Path) -> list[Path]:
    """Whole numbers of mg and mdeg/s with points: 1.003 is a thousand and three."""
    head = "time (ms);acc x (mg);acc y (mg);acc z (mg);gyr x (mdps);gyr y (mdps);gyr z (mdps)"
    values = np.column_stack([LEFT.acc * 1000 / G, np.degrees(LEFT.gyr) * 1000])
    body = [";".join(f"{round(value):,}".replace(",", ".") for value in row) for row in values]
    return [write(folder / "a.csv", [head, *(f"{10 * k};{row}" for k, row in enumerate(body))])]


def named_in_another_unit(folder: Path) -> list[Path]:
    head = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_deg_s,gyr_y_deg_s,gyr_z_deg_s"
    return [write(folder / "a.csv", [head, *rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr)])]


def gravity_alone(folder: Path) -> list[Path]:
    """A telephone's direction of gravity, which feels no motion."""
    head = "time (s),gravity x (m/s^2),gravity y (m/s^2),gravity z (m/s^2),gyro x (rad/s),gyro y (rad/s),gyro z (rad/s)"
    return [write(folder / "a.csv", [head, *rows_of(LEFT.time_s, LEFT.acc - LEFT.free_acc, LEFT.gyr)])]


def two_ranges(folder: Path) -> list[Path]:
    """Two accelerometers in one sensor."""
    names = ["Time (s)", *(f"S1 Accel {kind} {axis} (m/s²)" for kind in ("low", "wide") for axis in "XYZ")]
    names += [f"S1 Gyro {axis} (deg/s)" for axis in "XYZ"]
    return [write(folder / "a.csv", [",".join(names), *rows_of(LEFT.time_s, LEFT.acc, LEFT.acc, np.degrees(LEFT.gyr))])]


def counts_of_a_converter(folder: Path) -> list[Path]:
    """An MPU-6050 without its scales; the times by their unit alone."""
    body = rows_of(1000 * LEFT.time_s, LEFT.acc * 4096 / G, np.degrees(LEFT.gyr) * 32.8, form="%.0f")
    return [write(folder / "a.csv", ["ms,ax,ay,az,gx,gy,gz", *body])]


def whole_seconds(folder: Path) -> list[Path]:
    """Excel has shown the times without their fractions."""
    head = "Date/Time,Accel X (g),Accel Y (g),Accel Z (g),Gyro X (deg/s),Gyro Y (deg/s),Gyro Z (deg/s)"
    body = rows_of(LEFT.acc / G, np.degrees(LEFT.gyr))
    return [
        write(folder / "a.csv", [head, *(f"03/01/2026 11:59:{k // 100:02d} AM,{row}" for k, row in enumerate(body))])
    ]


def labchart(folder: Path) -> list[Path]:
    """LabChart: key and values for each column above the rows, whose names come first; no name for the times."""
    keys = ["Interval=\t0,01 s", "ChannelTitle=\tAcc X\tAcc Y\tAcc Z\tGyro X\tGyro Y\tGyro Z"]
    keys += ["Range=" + "\t4,000 g" * 3 + "\t1000 dps" * 3, "UnitName=" + "\tg" * 3 + "\tdps" * 3]
    keys += ["TopValue=" + "\t4" * 3 + "\t1000" * 3]
    body = rows_of(LEFT.time_s, LEFT.acc / G, np.degrees(LEFT.gyr), by="\t")
    return [write(folder / "a.txt", [*keys, *(row.replace(".", ",") for row in body)], "cp1252")]


REFUSED: dict[str, Callable[[Path], list[Path]]] = {
    "two clocks": two_clocks,
    "thousands": thousands,
    "named in another unit": named_in_another_unit,
    "gravity alone": gravity_alone,
    "two ranges": two_ranges,
    "whole seconds": whole_seconds,
    "LabChart": labchart,
    "counts": counts_of_a_converter,
    "Nexus in mm/s2": lambda folder: nexus(folder, "mm/s^2", 1000.0),
    "MotionSense": motionsense,
    "Sensor Logger, no gravity": lambda folder: sensor_logger(folder, "Accelerometer", LEFT.free_acc),
    "ActiGraph": actigraph,
    "no header": no_header,
    "commas in commas": commas_in_commas,
    "Movella DOT, angles alone": angles_alone,
    "a letter": a_letter,
    "a picture": a_picture,
    "cut while copied": cut_while_copied,
}


STATED = {  # what somebody states of a table that is refused else
    "LabChart": (labchart, TableChoices(time="1", time_unit="s")),
    "two ranges": (
        two_ranges,
        TableChoices(acc=("5", "6", "7"), acc_unit="m/s2", gyr=("8", "9", "10"), gyr_unit="deg/s"),
    ),
}


@pytest.mark.parametrize("name", STATED)
def test_a_refused_layout_is_read_as_somebody_states(name: str, tmp_path: Path) -> None:
    make, stated = STATED[name]
    (sensor,) = read_trial("", make(tmp_path), None, {ALL_TABLES: stated}).sensors
    np.testing.assert_allclose(sensor.block.time_s, LEFT.time_s, atol=1e-9)
    np.testing.assert_allclose(sensor.block.acc_m_s2, LEFT.acc, atol=2e-4)
    np.testing.assert_allclose(sensor.block.gyr_rad_s, LEFT.gyr, atol=2e-4)


def test_what_cannot_be_read_is_refused_with_the_reason(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    assert {name: refused(read_trial, "", make(tmp_path), None) for name, make in REFUSED.items()} == snapshot

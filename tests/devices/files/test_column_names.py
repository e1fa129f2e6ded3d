"""Tests that a column's name is understood as its writer meant it."""

import pytest

from devices.files.column_names import Quantity, SensorColumns, half_columns, listed, meaning_of, sensor_columns
from devices.files.refusal import FileRefusedError

ACC, GYR, MAG, QUAT, TIME = Quantity.ACC, Quantity.GYR, Quantity.MAG, Quantity.QUAT, Quantity.TIME


def half_or_whole(names: list[str]) -> tuple[SensorColumns, ...]:
    return sensor_columns(names) or half_columns(names)


@pytest.mark.parametrize(
    ("name", "sensor", "quantity", "axis", "unit"),
    [
        ("acc_x_m_s2", "", ACC, "x", "m/s2"),  # ours
        ("gyr_z_rad_s", "", GYR, "z", "rad/s"),
        ("time_s", "", TIME, "", "s"),
        ("quat_w", "", QUAT, "w", ""),
        ("mag_y", "", MAG, "y", ""),
        ("Acc_X", "", ACC, "x", ""),
        ("ax", "", ACC, "x", ""),
        ("accel_x [g]", "", ACC, "x", "g"),
        ("accelerometer_z_mg", "", ACC, "z", "mg"),
        ("Accelerometer X (g)", "", ACC, "x", "g"),
        ("Acc Y [m/s²]", "", ACC, "y", "m/s2"),
        ("acc_ms2_x", "", ACC, "x", "m/s2"),
        ("gx", "", GYR, "x", ""),
        ("wz", "", GYR, "z", ""),
        ("Gyro X [°/s]", "", GYR, "x", "deg/s"),
        ("rotationRateX", "", GYR, "x", ""),
        ("angular_velocity.z", "", GYR, "z", ""),
        ("gyr_deg_s_y", "", GYR, "y", "deg/s"),
        ("q0", "", QUAT, "w", ""),
        ("Quat_q3", "", QUAT, "z", ""),
        ("orientation.w", "", QUAT, "w", ""),
        ("t", "", TIME, "", ""),
        ("t_ms", "", TIME, "", "ms"),
        ("Timestamp (us)", "", TIME, "", "us"),
        ("Time [s]", "", TIME, "", "s"),
        ("PacketCounter", "", Quantity.COUNTER, "", ""),
        ("fs", "", Quantity.SAMPLE_RATE, "", ""),
        ("linear_acceleration.x", "", Quantity.FREE_ACC, "x", ""),
        ("FreeAcc_X", "", Quantity.FREE_ACC, "x", ""),
        ("left_shank_gyro_z_dps", "left_shank", GYR, "z", "deg/s"),
        ("LeftShankAccX", "LeftShank", ACC, "x", ""),
        ("Left Shank Gyroscope X (deg/s)", "Left Shank", GYR, "x", "deg/s"),
        ("Acc_X_left_shank", "left_shank", ACC, "x", ""),
        ("left_ax", "left", ACC, "x", ""),
        ("IMU1_GyroZ", "IMU1", GYR, "z", ""),
        ("Device_5E3A_Gyro_X_CAL", "Device_5E3A", GYR, "x", ""),
        ("data.left_shank.gyr", "left_shank", GYR, "", ""),
    ],
)
def test_names_and_units_are_understood(name: str, sensor: str, quantity: Quantity, axis: str, unit: str) -> None:
    meaning = meaning_of(name)
    assert meaning is not None
    assert (meaning.sensor, meaning.quantity, meaning.axis, meaning.unit) == (sensor, quantity, axis, unit)


@pytest.mark.parametrize(
    "name",
    [
        "acc_mag",  # a magnitude, or a magnetometer
        "acc_norm",
        "gyr_x_raw",
        "SampleTimeFine",
        "start_time",
        "knee_angle",
        "A_x",
        "pressure",
        "x",
        "",
        "()",
        "[" * 300,
    ],
)
def test_what_is_something_else_is_left_alone(name: str) -> None:
    assert meaning_of(name) is None


def test_a_unit_that_is_elsewhere_counts() -> None:
    meaning = meaning_of("acc_x", "m/s^2")
    assert meaning is not None
    assert meaning.unit == "m/s2"


def columns_of(prefix: str) -> list[str]:
    return [f"{prefix}{one}_{axis}" for one in ("acc", "gyr") for axis in "xyz"]


def test_sensors_are_those_with_both_quantities() -> None:
    names = ["time", *columns_of("L_"), *columns_of("R_"), "M_acc_x", "M_acc_y", "M_acc_z", "R_time_s", "hip_angle"]
    found = sensor_columns(names)
    assert [(one.sensor, one.time) for one in found] == [("L", "time"), ("R", "R_time_s")]
    assert found[0].acc == ("L_acc_x", "L_acc_y", "L_acc_z")
    assert found[1].gyr == ("R_gyr_x", "R_gyr_y", "R_gyr_z")


def test_acceleration_goes_before_free_acceleration() -> None:
    names = [*columns_of(""), "freeacc_x", "freeacc_y", "freeacc_z"]
    assert sensor_columns(names)[0].acc == ("acc_x", "acc_y", "acc_z")


def test_two_columns_of_one_meaning_are_refused() -> None:
    with pytest.raises(FileRefusedError, match="the columns acc_x, ax have the same meaning"):
        sensor_columns([*columns_of(""), "ax"])
    assert sensor_columns([*columns_of(""), "timestamp", "time_ms"])[0].time == "time_ms"


def test_of_two_times_the_one_is_taken_that_other_files_share() -> None:
    assert sensor_columns([*columns_of(""), "elapsed (s)", "epoc (ms)"])[0].time == "epoc (ms)"
    assert sensor_columns([*columns_of(""), "time_s", "time_ms"])[0].time == "time_s"


def test_a_long_name_keeps_its_end_in_a_sentence() -> None:
    names = [f"MyoMotion system 3000, left lower limb, Accel Sensor {axis} (mG)" for axis in "XY"]
    assert listed(names) == "MyoMotion system 30… Accel Sensor X (mG), MyoMotion system 30… Accel Sensor Y (mG)"
    assert listed(["acc_x"] * 14) == ", ".join(["acc_x"] * 12) + " (+2)"


def test_halves_whose_names_differ_by_words_are_one_sensor() -> None:
    def found(*stems: str) -> list[tuple[str, bool, bool]]:
        names = [f"{stem}_{axis}" for stem in stems for axis in "xyz"]
        return [(one.sensor, bool(one.acc), bool(one.gyr)) for one in half_or_whole(names)]

    assert found("TotalAcceleration", "Gyroscope") == [("", True, True)]
    assert found("left_sensor_acc", "left_gyr", "right_sensor_acc", "right_gyr") == [
        ("left", True, True),
        ("right", True, True),
    ]
    assert found("left_acc", "right_gyr") == [("left", True, False), ("right", False, True)]
    assert found("left_acc", "right_acc") == [("left", True, False), ("right", True, False)]
    with pytest.raises(FileRefusedError, match="left_acc_x, right_acc_x have the same meaning"):
        found("left_acc", "right_acc", "gyr")
    assert found("left_acc", "right_acc", "gyr", "pelvis_acc", "pelvis_gyr") == [("pelvis", True, True)]

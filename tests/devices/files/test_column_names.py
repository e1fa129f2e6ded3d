"""Tests that a column's name is understood as its writer meant it."""

import pytest
from syrupy.assertion import SnapshotAssertion

from devices.files.column_names import SensorColumns, half_columns, listed, meaning_of, sensor_columns
from devices.files.refusal import FileRefusedError


def half_or_whole(names: list[str]) -> tuple[SensorColumns, ...]:
    return sensor_columns(names) or half_columns(names)


UNDERSTOOD = """\
acc_x_m_s2; gyr_z_rad_s; time_s; quat_w; mag_y; Acc_X; ax; accel_x [g]; accelerometer_z_mg; Accelerometer X (g)
Acc Y [m/s²]; acc_ms2_x; gx; wz; Gyro X [°/s]; rotationRateX; angular_velocity.z; gyr_deg_s_y; q0; Quat_q3
orientation.w; t; t_ms; Timestamp (us); Time [s]; PacketCounter; fs; linear_acceleration.x; FreeAcc_X
left_shank_gyro_z_dps; LeftShankAccX; Left Shank Gyroscope X (deg/s); Acc_X_left_shank; left_ax; IMU1_GyroZ
Device_5E3A_Gyro_X_CAL; data.left_shank.gyr"""
# acc_mag may be a magnitude, or a magnetometer
SOMETHING_ELSE = "acc_mag; acc_norm; gyr_x_raw; SampleTimeFine; start_time; knee_angle; A_x; pressure; x; ; ()"


def test_names_and_units_are_understood(snapshot: SnapshotAssertion) -> None:
    found = {}
    for name in UNDERSTOOD.replace("\n", "; ").split("; "):
        meaning = meaning_of(name)
        assert meaning is not None, name
        found[name] = f"{meaning.quantity.name} {meaning.axis} in {meaning.unit!r} of {meaning.sensor!r}"
    assert found == snapshot


def test_what_is_something_else_is_left_alone() -> None:
    for name in [*SOMETHING_ELSE.split("; "), "[" * 300]:
        assert meaning_of(name) is None, name


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

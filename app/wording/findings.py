"""Findings in words: where, what happened, then what to do or what follows.

At most two sentences, numbers with units, no blame. To add a finding's message, add its key to `SENTENCES`: the figures
in braces are those that the finding carries in its `numbers`.
"""

import math

from app.wording.body import name_of, part_of
from app.wording.translation import capitalised, joined, tr
from core.findings import Finding

SENTENCES = {
    # what the reader noticed
    "unknown_key": "The key “{name}” is unknown. It is kept unchanged.",
    "unknown_column": "The column “{name}” is unknown. It is kept unchanged.",
    "file_left_out": (
        "The file “{name}” was not imported, because its sensor position is unknown. Add it to the map to import it."
    ),
    "doubled_stamps": "Some rows ({count}) repeat the previous time. The first of each was used.",
    "rows_cut_short": "The last rows ({count}) are incomplete. They were left out.",
    "stamps_spread": (
        "About {count:g} samples share each time stamp. They were spread evenly; stamps were up to {away_ms:.0f} ms "
        "off, and losses shorter than {loss_ms:.0f} ms go unnoticed."
    ),
    "joined_files": (
        "Acceleration ({acc}, {acc_hz:g} Hz) and angular rate ({gyr}, {gyr_hz:g} Hz) come from two files. They were "
        "joined by time."
    ),
    "stamps_mended": (
        "Some time stamps ({count}) are wrong, the first at sample {first}, off by {off_s:.6g} s. Times were "
        "interpolated between the samples around them; samples left out: {left_out}."
    ),
    "damaged_stretches": "Some segments ({count}) are damaged. They were skipped; their data are missing.",
    "slower_kept": (
        "Angular rate and acceleration have different rates: {kept} samples with both were used, {count} others "
        "excluded. Set one rate for both in MT Manager."
    ),
    "infinite_values": "Some values ({count}) are infinite. They count as missing.",
    "last_line_open": (
        "The last line has no line end; its last value may be cut off. Copy the file again if it matters."
    ),
    "no_sites": "This recording has no sensor data. It cannot be analysed.",
    "rate_from_orientation": (
        "No angular rates were recorded; they were derived from the sensor's orientation. Fast movements appear "
        "smoother than they were."
    ),
    "columns_understood": (
        "The columns were read as acceleration ({acc}, in {acc_unit}), angular rate ({gyr}, in {gyr_unit}) and "
        "time ({time}). Check this once for each program that writes such files."
    ),
    "columns_left_out": "Unknown columns were not read: {names}.",
    "unit_by_size": "The file gives no unit for {names}. From the size of the values, {unit} was assumed.",
    "unit_by_gravity": (
        "The file gives no unit for {names}. Gravity turns with the sensor as it does in {unit}, which was assumed."
    ),
    "time_from_rate": (
        "The file contains no times; samples are assumed to be evenly spaced at {rate_hz:g} Hz. Lost samples go "
        "unnoticed; export times or a counter as well."
    ),
    "packet_numbers": (
        "The packet number also counts other packets, so it is no clock. Samples are assumed to be evenly spaced at "
        "{rate_hz:g} Hz; losses of fewer than {least_loss} samples go unnoticed."
    ),
    "times_straightened": (
        "Packet times, up to {away_ms:.0f} ms early or late, were fitted to a straight line. Losses shorter than "
        "{loss_ms:.0f} ms go unnoticed; send samples with the sensor's own times."
    ),
    "stream_not_ended": (
        "The recording of this stream was not closed, or counted samples are missing. Copy the file again; if "
        "that does not help, they are lost."
    ),
    "clock_not_measured": (
        "The clock of “{host}”, which sent this sensor, was not measured. Its recording starts with the others'; "
        "record again with all computers in one network."
    ),
    "orientation_left_out": (
        "The orientation ({names}) does not turn gravity upwards, so it is not earth from sensor. It was not used."
    ),
    "gravity_from_orientation": (
        "The acceleration was recorded without gravity, which was added back from the sensor's orientation. Where "
        "the orientation is off, the acceleration is too."
    ),
    "gravity_for_acceleration": (
        "No acceleration was recorded; gravity alone is used. Events that need acceleration, such as initial "
        "contact, cannot be detected."
    ),
    "not_synchronised": (
        "This sensor was not synchronised with the others; its start was set to theirs, and joints whose movement "
        "does not show the remaining offset are excluded. Synchronise the sensors before the next recording."
    ),
    "split_clocks": (
        "The recording was split where the clock of one sensor went on from another time. From there on, the sensors "
        "are not synchronised; joints whose movement does not show the remaining offset are excluded."
    ),
    "sensor_changed": (
        "A different sensor was worn in the recording before. The earlier calibration does not apply; record free "
        "motion again."
    ),
    # what the data look like
    "too_few_samples": (
        "This recording has too few samples ({samples}) and cannot be analysed. Record at least three seconds."
    ),
    "all_zero": "Every sample of this sensor is zero. Its joints are excluded; check this sensor.",
    "bridged": "{missing_percent:.1f} % of the samples are missing, in short gaps. The angles continue across them.",
    "gaps": (
        "Samples are missing ({missing_percent:.1f} % in all; gaps: {count}, longest {longest_s:.2f} s). The "
        "angles have gaps there."
    ),
    "many_gaps": (
        "Samples are missing ({missing_percent:.1f} % in all; gaps: {count}, longest {longest_s:.2f} s). Too few "
        "remain for a result; record again, closer to the receiver."
    ),
    "pause": (
        "No sensor recorded anything for {length_s:.1f} s from {from_s:.1f} s on. The strides before and after "
        "this pause are used."
    ),
    "rate_off": (
        "{rate_hz:.1f} samples per second came, {nominal_hz:.1f} were set. Check the sample rate of this sensor, "
        "then record again."
    ),
    "every_second_lost": (
        "Every second sample is missing ({lost_percent:.0f} % lost): {rate_hz:.1f} per second came, "
        "{nominal_hz:.1f} were set. Check the sample rate of this sensor, move the receiver closer, then record "
        "again."
    ),
    "acc_in_g": (
        "The median acceleration is {median_m_s2:.2f} m/s² instead of about 9.81 m/s², as if in g. The sensor's "
        "joints are excluded; convert the file and import it again."
    ),
    "acc_implausible": (
        "The median acceleration is {median_m_s2:.2f} m/s² instead of about 9.81 m/s². The sensor's joints are "
        "excluded; check this sensor."
    ),
    "rate_in_deg_s": (
        "Angular rates reach {p99_rad_s:.0f} rad/s, as if in degrees per second. Convert the file and import it again."
    ),
    "acc_reversed": (
        "Acceleration and angular rate do not match: this sensor turns opposite to the adjacent segment, so its "
        "joints are excluded. Reverse the sign of its accelerations or correct its axis order, then import it "
        "again."
    ),
    "time_in_ms": (
        "The times look like {unit}, not seconds: the step between samples is {step:.1f}. Convert the file and "
        "import it again."
    ),
    "same_data": (
        "Both sensors contain the same data, so their joints are excluded. Find the copied file and import the "
        "right one."
    ),
    "clock_offset": (
        "The sensor's clock differs by {offset_s:.1f} s from the others, too much to correct. Use one receiver "
        "for all sensors, then record again."
    ),
    "clock_jumps": (
        "The sensor's clock jumps forward by {jump_s:.1f} s, {after_s:.1f} s after the start. The sensor's joints "
        "are excluded; split the recording there, then import it again."
    ),
    "impossible_values": (
        "Some samples ({count}) are beyond the range of any sensor. They count as missing; check the sensor and "
        "its file."
    ),
    "stuck": (
        "The sensor repeated the same values for {percent:.1f} % of the time. These count as missing; restart the "
        "sensor before the next recording."
    ),
    "stuck_throughout": (
        "The sensor repeated the same values all the time. Its joints are excluded; restart the sensor."
    ),
    "low_rate": (
        "The sensor sent only {rate_hz:.0f} samples per second; 60 or more are required. Angles are uncertain by "
        "several degrees."
    ),
    "clipped": (
        "{percent:.1f} % of the samples are at the limit of the sensor's range. Peaks are cut off; choose a wider "
        "range."
    ),
    "missing_site": "No sensor was worn here. There are no {joint} angles.",
    "gyro_bias_unknown": (
        "The sensors were never still, so their gyroscope offsets are unknown. Angles may drift; let the patient "
        "stand for three seconds before the next walk."
    ),
    "moved_while_standing": (
        "The patient moved while standing, so there is no standing reference. Repeat standing still."
    ),
    "rate_kind_found": (
        "The file does not state what its angular rates represent; {kind} rates fit the data best. Enter this as "
        "rate_kind in session.toml."
    ),
    # what was found of the joints
    "no_joint": (
        "No joint angle could be computed. Sensors on two adjacent segments, such as thigh and shank, must be "
        "worn and move."
    ),
    "feet_only": "Only the feet have sensors, so there are steps but no joint angles.",
    "too_little_motion": (
        "No joint axis was found: too little movement or too few usable samples. Record ten seconds of free motion."
    ),
    "sign_in_doubt": (
        "Two solutions fit almost equally well (margin {margin:.2f}, 1.5 required). Check the sensor positions, "
        "or record free motion."
    ),
    "clinical_sign_uncertain": (
        "Flexion and extension cannot be distinguished (margin {margin:.2f}), so only range of motion is "
        "reported. Check the curve, then confirm or reverse the sign."
    ),
    "sign_turned": "The sign was reversed by hand. The corrected angle is shown.",
    "sign_confirmed": "The sign was confirmed by hand. It is used as detected.",
    "not_a_hinge": (
        "The joint rotates about more than one axis (residual {hinge_residual_rad_s:.2f} rad/s). The angle is the "
        "rotation about its main axis."
    ),
    "is_a_hinge": "The joint moves like a true hinge. The stricter method was used, and the angle is more certain.",
    "flexion_did_not_dominate": (
        "The detected axis is {elevation_deg:.0f}° from horizontal, so flexion was not the main movement. Repeat "
        "free motion with more flexion of this joint."
    ),
    "turns_contradict": (
        "The feet show {feet} turns in this test, the pelvis {pelvis}. Check which is right before using the turns."
    ),
    "clock_moved": (
        "The distal sensor's clock is {lag_ms:+.0f} ms off here, but not in the other recordings. This was "
        "corrected; one receiver for all sensors avoids it."
    ),
    "clock_drifts": (
        "This sensor's clock runs {drift_percent:+.1f} % faster than the others of its leg. Its samples do not "
        "match theirs in time; check its sample rate, or use one receiver for all sensors, then record the walk "
        "again."
    ),
    "lag_corrected": "The distal sensor's clock was {lag_ms:+.0f} ms off. This was corrected.",
    "not_the_same_joint": (
        "The two sensors do not move like the two sides of one joint. Check which sensor is where, or use one "
        "receiver for all sensors."
    ),
    "centre_unknown": "The joint centre could not be determined from this movement. The angle does not need it.",
    "ankle_axis_from_rates": (
        "This foot shows no soft-tissue vibration; the axis comes directly from foot and shank rotation in walking."
    ),
    "axis_from_walking": (
        "The joint axis comes from walking alone and is less certain. Record ten seconds of free motion."
    ),
    "zero_unknown": (
        "The joint has no standing reference, since no standing was recorded for it. Range of motion and curve "
        "shape are valid, absolute angles are not."
    ),
    "goniometer_without_standing": (
        "The goniometer value was not used, since no standing was recorded. Let the patient stand for three seconds."
    ),
    "joint_left_out": (
        "The joint is excluded, because one of its sensors gave no usable data. The reason is given with that sensor."
    ),
    "no_standing": (
        "No standing was recorded, so there is no standing reference. Range of motion and curve shape are valid, "
        "absolute angles are not."
    ),
    "zero_from_goniometer": (
        "The joint is at {value_deg:.1f}° in standing, as measured with the goniometer. All angles refer to it."
    ),
    "published_sign_unsure": (
        "The published method could not match the directions of the two axes with certainty. Its curve may be mirrored."
    ),
    "events_from_shank": (
        "The foot has no usable sensor, so steps are detected from the shank. Initial contact and toe-off are "
        "known, distances are not."
    ),
    "doubtful_strides": (
        "Some strides ({count}) have a doubtful initial contact. The foot moved in another direction than its "
        "toes point, so averages exclude them."
    ),
    "foot_against_shank": "The foot has no ankle joint. Its angle is the foot relative to the shank.",
    "prosthetic_toe_off": (
        "Toe-off of the prosthetic foot is the first movement of its sole. This was tested on "
        "simulated feet only, so its stance is not assessed."
    ),
    "no_strides": "No complete stride was found. Check that this is a walk, and that sensors are on feet or shanks.",
    "side_without_strides": (
        "No complete stride was found, though the other side has some. Check the sensor position, then record "
        "another walk."
    ),
    "strides_all_left_out": (
        "All detected strides ({count}) were excluded: {reasons}. There are no averages; correct this and record "
        "the walk again."
    ),
    "strides_left_out_by_hand": "Of {of} {side} strides, {count} were excluded by hand.",
    "no_mean": (
        "The {side} has {count} usable strides; a mean needs {wanted}. Record another walk, or assess single "
        "strides only."
    ),
    "angle_without_mean": (
        "Of {used} strides used, {count} have no gaps in this angle; a mean needs {wanted}. Record again, "
        "closer to the receiver."
    ),
    "no_spread": (
        "There are only {left} left and {right} right strides; a standard deviation needs {wanted}. Record "
        "another walk, or continue without a standard deviation."
    ),
    "no_spread_of_side": (
        "There are only {count} {side} strides; a standard deviation needs {wanted}. Record another walk, or "
        "continue without a standard deviation."
    ),
    "no_peak": "No value for {peak} is reported: the angle has no turning point in that phase.",
    "published_differs": (
        "The published method differs by {difference_deg:.1f}° in curve shape. Compare both curves before relying "
        "on it."
    ),
    # what the session is made of
    "recording_discarded": "This recording is excluded. It stays in the folder and is not analysed.",
    "recording_recovered": (
        "The program closed during this recording, which is complete up to the last record on disk. Ending the "
        "program loses at most 0.1 s in 99 of 100 cases; a power cut loses up to 0.5 s and any data not yet on "
        "disk."
    ),
    "recording_changed": (
        "The file no longer matches the recording as it was stopped. Only the verified part was used; restore it "
        "from a backup."
    ),
    "strap_slipped": (
        "The strap moved at about {from_s} s, by about {turn_deg}°. Strides of this leg are excluded from 5 s "
        "before; tighten the strap and repeat free motion."
    ),
    "restrapped": "The sensors were reattached before this recording. Earlier recordings do not calibrate it.",
    "calibration_after_walk": (
        "Calibration comes from a recording made after the walk, as there is none before. This is valid only if "
        "no sensor moved in between."
    ),
    "simulated": "These data are simulated. They come from no patient.",
    "axis_uncertain": "Calibration certainty is only ±{axis_sd_deg:.1f}°. Record free motion, or move longer.",
    "short_recording": "This recording is short. Its angles are less certain.",
    "labels_look_swapped": (
        "These sensors look swapped, as the movement fits better the other way round. Swap them, or keep the positions."
    ),
    "labels_look_mixed": (
        "These sensors look mixed up, as another order fits the movement better. Check the sensor positions."
    ),
}

# what a finding's numbers name by the words of the files, as the sentences say it
NAMES = {
    "side": {"left": "left", "right": "right"},
    "reason": {
        "gap": "with missing samples",
        "doubtful_events": "with doubtful initial contact",
        "pause": "with a pause",
        "turn": "turning",
        "start": "starting",
        "stop": "stopping",
        "outlier": "unlike the others",
        "strap_slipped": "after a strap moved",
        "stairs_up": "up stairs",
        "stairs_down": "down stairs",
        "left_out_by_hand": "excluded by hand",
    },
    "peak": {
        "knee_loading_peak": "peak flexion, loading",
        "knee_stance_minimum": "least flexion, stance",
        "knee_swing_peak": "peak flexion, swing",
        "ankle_loading_plantarflexion": "peak plantarflexion, loading",
        "ankle_stance_dorsiflexion": "peak dorsiflexion, stance",
        "ankle_push_off_plantarflexion": "peak plantarflexion, push-off",
        "ankle_swing_dorsiflexion": "peak dorsiflexion, swing",
    },
}

WHOLE_SESSION = "session"  # what a finding about no part in particular gives as its place


def sentence(finding: Finding) -> str:
    """Give a finding in words: where, what, and what to do; without a sentence, by its key and figures."""
    known = {name: _stated(name, value) for name, value in finding.numbers.items() if _is_known(value)}
    if reasons := _reasons(finding):
        known["reasons"] = reasons
    try:
        stated = tr(SENTENCES[finding.key]).format_map(known)
    except (KeyError, ValueError):  # ValueError: a name where the sentence wants a figure
        figures = ", ".join(f"{name} {value}" for name, value in known.items())
        stated = " ".join(filter(None, [finding.key.replace("_", " "), figures])) + "."
    return capitalised(f"{place(finding.where)}: {stated}" if finding.where not in ("", WHOLE_SESSION) else stated)


def _reasons(finding: Finding) -> str:
    """Say why strides were left out, most of them first, where the finding counts them: "8 turning, 3 stopping"."""
    counts = {name: value for name, value in finding.numbers.items() if name in NAMES["reason"]}
    ordered = sorted(counts, key=lambda name: -float(counts[name]))
    return ", ".join(f"{counts[name]} {tr(NAMES['reason'][name])}" for name in ordered)


def place(where: str) -> str:
    """Put a finding's `where` into words, the part of the body before the recording: "L thigh and L shank, walk 1"."""
    names = [name for name in where.split(", ") if name]
    parts = [name_of(part) for name in names if (part := part_of(name)) is not None]
    others = [name for name in names if part_of(name) is None]
    return ", ".join(filter(None, [joined(parts), *others]))


def _is_known(value: float | int | str) -> bool:
    return isinstance(value, str) or math.isfinite(value)


def _stated(name: str, value: float | int | str) -> float | int | str:
    if not isinstance(value, str):
        return value
    if value in NAMES.get(name, {}):
        return tr(NAMES[name][value])
    part = part_of(value)
    return value if part is None else name_of(part)

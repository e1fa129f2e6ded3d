"""What do we tell the clinician? Every message: what happened, then what to do or what follows.

At most two sentences, the part first and its side before it, numbers with units, no blame. English is the source; other
languages come from the gettext catalogues in `resources/locale`, which `packaging/catalogue.py` gathers from the code:
whatever is shown stands as it is inside `tr` or `tr_n`, or inside `later` where it is written down before it is shown.
To add a finding's message, add its key to `SENTENCES`: the figures in braces are those that the finding carries in its
`numbers`.
"""

import gettext
import math
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from string import Formatter
from typing import Any

from core.body import Joint, Side, Site
from core.findings import Finding

DOMAIN = "gaitwright"
LOCALE = Path(str(files("resources") / "locale"))
_catalogue = gettext.NullTranslations()
_language = "en"
# each in its own words, for who does not understand those in sight
LANGUAGES = {"en": "English", "de": "Deutsch"}
WITH_COMMAS = {"de"}  # languages that write fractions so

SENTENCES = {
    # what the reader noticed
    "unknown_key": "the key “{name}” means nothing here. It is kept as it is.",
    "unknown_column": "the column “{name}” means nothing here. It is kept as it is.",
    "file_left_out": (
        "“{name}” was left out, because nothing says which site it belongs to. Name it in the map to take it in."
    ),
    "doubled_stamps": "rows that repeat the time before them: {count}. The first of each was kept.",
    "stamps_mended": (
        "wrong time stamps: {count}, the first at sample {first}, off by {off_s:.6g} s. Times were interpolated "
        "between the samples around them; samples left out: {left_out}."
    ),
    "damaged_stretches": "stretches that are damaged: {count}. They were passed over; what lay in them is missing.",
    "slower_kept": "angular rate and acceleration came at unequal rates: the {kept} samples with both were kept, "
    "{count} others left out. Set one rate for both in MT Manager.",
    "infinite_values": "infinite values: {count}. They are no measurement and count as missing.",
    "last_line_open": "the last line has no end, so its last value may be cut. Copy the file again if it matters.",
    "no_sites": "no sensor data. Nothing can be computed from this recording.",
    "rate_from_orientation": (
        "no angular rates were recorded, so they come from the sensor's own orientation. Fast movements are "
        "smoother than they were."
    ),
    "columns_understood": (
        "the columns were read as acceleration ({acc}, in {acc_unit}), angular rate ({gyr}, in {gyr_unit}) and time "
        "({time}). Check them once for every program that writes such files."
    ),
    "columns_left_out": "columns that mean nothing here were left out: {names}.",
    "unit_by_size": "the file does not tell the unit of {names}. By their size they are in {unit}.",
    "time_from_rate": (
        "the file tells no times, so its samples are taken to follow each other at {rate_hz:g} Hz. Lost samples do not "
        "show; export times or a counter with them."
    ),
    "times_straightened": (
        "the times are those of packets, up to {away_ms:.0f} ms early or late, and were put on a straight line, so "
        "losses shorter than {loss_ms:.0f} ms do not show. Send samples with the sensor's own times."
    ),
    "stream_not_ended": (
        "the recording of this stream was not ended, or samples that were counted are missing. Copy the file again; if "
        "it stays so, they are lost."
    ),
    "clock_not_measured": (
        "the clock of “{host}”, which sent this sensor, was not measured, so its recording was set to start with the "
        "others'. Record again with all computers in one network."
    ),
    "orientation_left_out": (
        "the orientation ({names}) does not turn gravity upwards, so it is not earth from sensor. It was left out."
    ),
    "gravity_from_orientation": (
        "the acceleration was recorded without gravity, which was added again by the sensor's own orientation. Where "
        "that is off, the acceleration is too."
    ),
    "gravity_for_acceleration": (
        "no acceleration was recorded, so gravity stands in for it. What rests on acceleration, such as the landing of "
        "a foot, cannot be told."
    ),
    "not_synchronised": (
        "this sensor was not synchronised with the others, so its recording was set to start with theirs. Joints of "
        "which the motion cannot tell the rest are left out; synchronise the sensors before the next recording."
    ),
    "sensor_changed": (
        "another sensor was worn than in the recording before. A calibration does not carry over to it; record "
        "free motion again."
    ),
    # what the data look like
    "too_few_samples": "too few samples ({samples}). Nothing can be computed from them; record at least three seconds.",
    "all_zero": "every sample is zero. Check this sensor; its joints are left out.",
    "bridged": "{missing_percent:.1f} % of the samples are missing, one by one. The angles go on across them.",
    "gaps": (
        "samples are missing ({missing_percent:.1f} % in all; gaps: {count}, the longest {longest_s:.2f} s). "
        "The angles have gaps there."
    ),
    "many_gaps": (
        "samples are missing ({missing_percent:.1f} % in all; gaps: {count}, the longest {longest_s:.2f} s). "
        "Too few are left to rely on; record again, nearer to the receiver."
    ),
    "pause": (
        "no sensor recorded anything for {length_s:.1f} s from {from_s:.1f} s on. The strides before and after this "
        "pause are used."
    ),
    "rate_off": (
        "{rate_hz:.1f} samples per second came, {nominal_hz:.1f} were set. Check the sample rate of this sensor, then "
        "record again."
    ),
    "every_second_lost": (
        "every second sample is missing ({lost_percent:.0f} % lost): {rate_hz:.1f} per second came, {nominal_hz:.1f} "
        "were set. Check the sample rate of this sensor, move the receiver nearer, then record again."
    ),
    "acc_in_g": (
        "the median acceleration is {median_m_s2:.2f} m/s² where some 9.81 m/s² are expected, as if in g; its "
        "joints are left out. Convert the file and import it again."
    ),
    "acc_implausible": (
        "the median acceleration is {median_m_s2:.2f} m/s² where some 9.81 m/s² are expected. Check this sensor; "
        "its joints are left out."
    ),
    "rate_in_deg_s": (
        "angular rates reach {p99_rad_s:.0f} rad/s, as if in degrees per second. Convert the file and import it again."
    ),
    "acc_reversed": (
        "accelerations and rates do not belong together: where its neighbour turns left, this sensor turns right. Its "
        "joints are left out; give its accelerations the other sign, or its axes their order, and import it again."
    ),
    "time_in_ms": (
        "the times look like {unit}, not seconds: from one sample to the next they grow by {step:.1f}. Convert the "
        "file and import it again."
    ),
    "same_data": (
        "both hold the same data, so their joints are left out. Find out which file is the copy and import the "
        "right one."
    ),
    "clock_offset": (
        "the clock is {offset_s:.1f} s away from the others', more than can be mended. Use one receiver for all "
        "sensors, then record again."
    ),
    "clock_jumps": (
        "the clock jumps forward by {jump_s:.1f} s, {after_s:.1f} s after it began, so its joints are left out. Split "
        "the recording there, then import it again."
    ),
    "impossible_values": (
        "samples larger than any sensor measures: {count}. They count as missing; check the sensor and its file."
    ),
    "stuck": (
        "the sensor repeated the same values for {percent:.1f} % of the time; they count as missing. Restart it before "
        "the next recording."
    ),
    "stuck_throughout": "the sensor repeated the same values all the time. Restart it; its joints are left out.",
    "low_rate": (
        "only {rate_hz:.0f} samples per second. Angles are uncertain by several degrees; 60 or more are wanted."
    ),
    "clipped": (
        "{percent:.1f} % of the samples are at the end of the sensor's range. Peaks are cut off; choose a wider range."
    ),
    "missing_site": "no sensor was worn here. There are no {joint} angles.",
    "gyro_bias_unknown": (
        "the sensors were never still, so their rates at rest are unknown. Angles may drift; let the patient "
        "stand for three seconds before the next walk."
    ),
    "moved_while_standing": "the patient moved while standing, so this gives no zero. Repeat standing still.",
    "rate_kind_found": (
        "the file does not say what an angular rate stands for; the data fit {kind} rates best. Note it as "
        "rate_kind in session.toml."
    ),
    # what was found of the joints
    "no_joint": (
        "no joint angle could be computed. Two neighbouring sensors, such as thigh and shank, must be worn and move."
    ),
    "feet_only": "only feet carry sensors, so there are steps and no joint angles.",
    "too_little_motion": "no axis was found, for lack of motion or usable samples. Record ten seconds of free motion.",
    "sign_in_doubt": (
        "two solutions fit almost equally well (margin {margin:.2f}, 1.5 wanted). Check which sensor is where, or "
        "record free motion."
    ),
    "clinical_sign_uncertain": (
        "the motion does not tell flexion from extension (margin {margin:.2f}), so only its range is given. Look at "
        "the curve, then confirm or turn the sign."
    ),
    "sign_turned": "the sign was turned by hand. The angle is shown as it was corrected.",
    "sign_confirmed": "the sign was confirmed by hand. It is used as it was found.",
    "not_a_hinge": (
        "turns about more than one axis (residual {hinge_residual_rad_s:.2f} rad/s). The angle is the part about "
        "its main axis."
    ),
    "is_a_hinge": "moves like a true hinge. The stricter method was used and the angle is more certain.",
    "flexion_did_not_dominate": (
        "the axis found lies {elevation_deg:.0f}° from horizontal, so flexion did not dominate the motion. Repeat "
        "free motion and bend this joint more."
    ),
    "turns_contradict": (
        "the feet tell {feet} turns in this test, the pelvis {pelvis}. Look which is right before the turns are used."
    ),
    "clock_moved": (
        "the farther sensor's clock is {lag_ms:+.0f} ms off here and was not in the others. It has been "
        "corrected; with one receiver for all sensors it does not happen."
    ),
    "clock_drifts": (
        "this sensor's clock runs {drift_percent:+.1f} % faster than the others' of its leg, so its samples are paired "
        "with the wrong ones. Check its sample rate, or use one receiver for all sensors, and record the walk again."
    ),
    "lag_corrected": "the farther sensor's clock was {lag_ms:+.0f} ms off. It has been corrected.",
    "not_the_same_joint": (
        "the two sensors do not move like the two sides of one joint. Check which sensor is where, or use one receiver "
        "for all sensors."
    ),
    "centre_unknown": "the joint centre could not be found from this motion. The angle does not need it.",
    "ankle_axis_from_rates": (
        "no tissue rings at this foot, so the axis comes straight from how foot and shank turned in walking."
    ),
    "axis_from_walking": (
        "the joint axis comes from walking alone and is less certain. Record ten seconds of free motion."
    ),
    "zero_unknown": (
        "has no zero, since no standing was recorded for it. Its range and shape hold, absolute angles do not."
    ),
    "goniometer_without_standing": (
        "the goniometer value was not used, since no standing was recorded. Let the patient stand for three seconds."
    ),
    "joint_left_out": (
        "was left out, because a sensor gave nothing usable. What is wrong with it is said beside its name."
    ),
    "no_standing": "no standing recording, so there is no zero. Range and shape hold, absolute angles do not.",
    "zero_from_goniometer": (
        "reads {value_deg:.1f}° in standing, as measured with the goniometer. All angles refer to it."
    ),
    "published_sign_unsure": (
        "the published method could not pair the directions of the two axes with certainty. Its curve may be mirrored."
    ),
    "events_from_shank": (
        "the foot has no usable sensor, so steps come from the shank. Contact and toe-off are known, distances are not."
    ),
    "doubtful_strides": (
        "strides whose landing is in doubt: {count}. The foot went another way than its toes point, so averages leave "
        "them out."
    ),
    "foot_against_shank": "the foot has no ankle joint. Its angle is that of the foot against the shank.",
    "prosthetic_toe_off": (
        "toe-off of a prosthetic foot is timed by when its sole begins to move, tried on simulated feet only. Its "
        "stance is not judged."
    ),
    "no_strides": "no whole stride was found. Check that this is a walk, and that the sensors sit on feet or shanks.",
    "side_without_strides": (
        "no whole stride was found, though the other side has some. Check that the sensor sits where it is said to, "
        "then walk once more."
    ),
    "strides_all_left_out": (
        "all strides found ({count}) were left out: {reasons}. So there are no averages; put that right and record the "
        "walk again."
    ),
    "strides_left_out_by_hand": "{count} of {of} {side} strides left out by hand.",
    "no_mean": (
        "usable strides on the {side}: {count}; {wanted} make a mean. Walk once more, or read single strides only."
    ),
    "angle_without_mean": (
        "strides used: {used}, of them without gaps in this angle: {count}; {wanted} make a mean. Record again, nearer "
        "to the receiver."
    ),
    "no_spread": (
        "only {left} left and {right} right strides, {wanted} make a spread. Walk once more, or go on without a spread."
    ),
    "no_spread_of_side": (
        "only {count} {side} strides, {wanted} make a spread. Walk once more, or go on without a spread."
    ),
    "no_peak": (
        "no {peak}, since the angle only passes through where it is looked for. Nothing is given in its place."
    ),
    "published_differs": (
        "the published method differs by {difference_deg:.1f}° in shape. Compare the two curves before relying on it."
    ),
    # what the session is made of
    "recording_discarded": "this recording was discarded. It is kept in the folder and not analysed.",
    "recording_recovered": (
        "the program was closed while this was recorded. It is kept up to the last record on the disk; ending the "
        "program costs 0.1 s at most in 99 of 100 cases, a power cut up to 0.5 s and what the disk still held back."
    ),
    "recording_changed": (
        "its file is not what it was when the recording was stopped. What is proved in it was used; restore it from "
        "a backup."
    ),
    "strap_slipped": (
        "the strap slipped near {from_s} s, by about {turn_deg}°. Strides of this leg from 5 s before on are left out; "
        "tighten it and repeat the free motion."
    ),
    "restrapped": "the sensors were strapped on anew before this recording. Nothing recorded earlier calibrates it.",
    "calibration_after_walk": (
        "was calibrated with a recording made after the walk, as there is none before. It holds only if no sensor "
        "moved in between."
    ),
    "simulated": "these data are simulated. They come from no patient.",
    "axis_uncertain": "the joint axis is certain to {axis_sd_deg:.1f}° only. Record free motion, or move longer.",
    "short_recording": "a short recording. Its angles are less certain.",
    "labels_look_swapped": (
        "seem swapped, as the motion fits better the other way round. Swap them, or keep them as worn."
    ),
    "labels_look_mixed": (
        "seem to be worn in another order, as the motion fits that better. Check which sensor is where."
    ),
}

# what a finding's numbers name by the words of the files, as the sentences say it
NAMES = {
    "side": {"left": "left", "right": "right"},
    "reason": {
        "gap": "with missing samples",
        "doubtful_events": "with a landing in doubt",
        "pause": "with a pause",
        "turn": "turning",
        "start": "starting",
        "stop": "stopping",
        "outlier": "unlike the others",
        "strap_slipped": "after a strap slipped",
        "stairs_up": "up stairs",
        "stairs_down": "down stairs",
        "left_out_by_hand": "left out by hand",
    },
    "peak": {
        "knee_loading_peak": "loading peak",
        "knee_stance_minimum": "stance minimum",
        "knee_swing_peak": "swing peak",
        "ankle_loading_plantarflexion": "loading plantarflexion",
        "ankle_stance_dorsiflexion": "stance dorsiflexion",
        "ankle_push_off_plantarflexion": "push-off plantarflexion",
        "ankle_swing_dorsiflexion": "swing dorsiflexion",
    },
}

WHOLE_SESSION = "session"  # what a finding about no part in particular says as its place


class _CommaFormatter(Formatter):
    """Gives fractions a decimal comma; what only looks like one, as a version, keeps its point."""

    def format_field(self, value: Any, format_spec: str) -> str:
        text: str = super().format_field(value, format_spec)
        return text.replace(".", ",") if isinstance(value, float) else text


_COMMAS = _CommaFormatter()


class _CommaSentence(str):
    """A sentence of a language that writes fractions with a comma."""

    __slots__ = ()

    def format(self, *args: object, **values: object) -> str:
        return _COMMAS.vformat(self, args, values)

    def format_map(self, values: Mapping[str, object], /) -> str:  # type: ignore[override]  # as the built-in one is called
        return _COMMAS.vformat(self, (), values)


def _spoken(message: str, language: str) -> str:
    return _CommaSentence(message) if language in WITH_COMMAS else message


def use_language(language: str) -> None:
    """Speak `language` from now on, as "de", as far as there is a catalogue of it; else English.

    "pseudo" is no language: it is English made as long as German, which tests show on every page.
    """
    global _catalogue, _language
    _language = language if gettext.find(DOMAIN, LOCALE, languages=[language]) else "en"
    if language == "pseudo":
        from app.wording.pseudo_language import PseudoLanguage

        _catalogue = PseudoLanguage()
    else:
        _catalogue = gettext.translation(DOMAIN, LOCALE, languages=[language], fallback=True)


def languages() -> tuple[str, ...]:
    """Give the languages there are, English first, as "de"."""
    return ("en", *sorted(file.parts[-3] for file in LOCALE.glob(f"*/LC_MESSAGES/{DOMAIN}.mo")))


def spoken_in(language: str) -> Callable[[str], str]:
    """Give what says a message in another language than the user's, as a page for somebody else; else English."""
    catalogue = gettext.translation(DOMAIN, LOCALE, languages=[language], fallback=True)
    return lambda message: _spoken(catalogue.gettext(message), language)


def spoken_language() -> str:
    """Give the language that is spoken now, as "de"."""
    return _language


def tr(message: str) -> str:
    """Give the message in the user's language."""
    return (
        _spoken(_catalogue.gettext(message), _language) if message else ""
    )  # gettext's answer to nothing is the catalogue's head


def tr_n(one: str, many: str, count: int) -> str:
    """Give the message in the user's language, in the form that belongs to `count`, as `{count} strides`."""
    return _spoken(_catalogue.ngettext(one, many, count), _language)


def figure_text(value: float, spec: str, language: str = "") -> str:
    """Write a number by a format of Python's, as ".1f", with the decimal mark of the user's language or of another."""
    text = format(value, spec)
    return text.replace(".", ",") if (language or _language) in WITH_COMMAS else text


def short_figure(value: float, decimals: int) -> str:
    """Write a number without noughts that say nothing: 15, 82.5."""
    written = figure_text(value, f".{decimals}f")
    return written.rstrip("0").rstrip(".,") if decimals else written


def later(message: str) -> str:
    """Tell the catalogue of a message that is written here but shown, through `tr`, later: as a constant is."""
    return message


PURPOSE = later("Research use. Not a medical device.")  # stays on every screen, page and export


def filled(message: str, values: Mapping[str, object]) -> str:
    """Give what was refused elsewhere in the user's language, its braces filled; none are looked for without values."""
    said = tr(message)
    return said.format(**values) if values else said


def sentence(finding: Finding) -> str:
    """Give a finding in words: where, what happened, what to do or what follows.

    A finding whose sentence is missing, or lacks a figure, is still told, by its key and its figures.
    """
    known = {name: _said(name, value) for name, value in finding.numbers.items() if _is_known(value)}
    if reasons := _reasons(finding):
        known["reasons"] = reasons
    try:
        said = tr(SENTENCES[finding.key]).format_map(known)
    except (KeyError, ValueError):  # ValueError: a name where the sentence wants a figure
        figures = ", ".join(f"{name} {value}" for name, value in known.items())
        said = " ".join(filter(None, [finding.key.replace("_", " "), figures])) + "."
    return capitalised(f"{place(finding.where)}: {said}" if finding.where not in ("", WHOLE_SESSION) else said)


def _reasons(finding: Finding) -> str:
    """Say why strides were left out, most of them first, where the finding counts them: "8 turning, 3 stopping"."""
    counts = {name: value for name, value in finding.numbers.items() if name in NAMES["reason"]}
    ordered = sorted(counts, key=lambda name: -float(counts[name]))
    return ", ".join(f"{counts[name]} {tr(NAMES['reason'][name])}" for name in ordered)


def name_of(part: Site | Joint) -> str:
    """Name a site or joint as the screen does: "L thigh", "left knee"."""
    names = {
        Site.LEFT_THIGH: tr("L thigh"),
        Site.LEFT_SHANK: tr("L shank"),
        Site.LEFT_FOOT: tr("L foot"),
        Site.RIGHT_THIGH: tr("R thigh"),
        Site.RIGHT_SHANK: tr("R shank"),
        Site.RIGHT_FOOT: tr("R foot"),
        Site.PELVIS: tr("pelvis"),
        Joint.LEFT_KNEE: tr("left knee"),
        Joint.LEFT_ANKLE: tr("left ankle"),
        Joint.RIGHT_KNEE: tr("right knee"),
        Joint.RIGHT_ANKLE: tr("right ankle"),
        Joint.LEFT_HIP: tr("left hip"),
        Joint.RIGHT_HIP: tr("right hip"),
    }
    return names[part]


def side_name(side: Side) -> str:
    """Name a side inside a sentence: "left"."""
    return tr("left") if side is Side.LEFT else tr("right")


def place(where: str) -> str:
    """Put a finding's `where` into words, the part of the body before the recording: "L thigh and L shank, walk 1"."""
    names = [name for name in where.split(", ") if name]
    parts = [name_of(part) for name in names if (part := _part(name)) is not None]
    others = [name for name in names if _part(name) is None]
    return ", ".join(filter(None, [joined(parts), *others]))


def capitalised(text: str) -> str:
    """Begin as a sentence begins; the rest keeps its letters, as a sensor's name must."""
    return text[:1].upper() + text[1:]


def within_sentence(name: str) -> str:
    """Give a name that begins with a capital as it stands inside a sentence; German nouns keep theirs."""
    return name if _language == "de" else name[:1].lower() + name[1:]


def joined(names: Sequence[str]) -> str:
    """Put names into a row as a sentence has them: "L thigh, L shank and R foot"."""
    if len(names) < 2:
        return "".join(names)
    return tr("{first} and {last}").format(first=", ".join(names[:-1]), last=names[-1])


def _is_known(value: float | int | str) -> bool:
    return isinstance(value, str) or math.isfinite(value)


def _said(name: str, value: float | int | str) -> float | int | str:
    if not isinstance(value, str):
        return value
    if value in NAMES.get(name, {}):
        return tr(NAMES[name][value])
    part = _part(value)
    return value if part is None else name_of(part)


def _part(name: str) -> Site | Joint | None:
    if name in set(Site):
        return Site(name)
    return Joint(name) if name in set(Joint) else None

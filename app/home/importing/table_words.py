"""What is stated about a table that nobody knows, and whether it can be read so."""

import re
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from app.wording.translation import capitalised, figure_text, filled, later, tr, tr_n
from core.findings import Finding
from core.samples import FloatArray
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import CLOCK, COUNT, SEPARATORS, PreviewedSensor, TablePreview
from devices.files.table_header import UNNAMED
from devices.files.text_files import UTF_8, UTF_16, WINDOWS

OPTIONS = re.compile(r" \(--[^()]*\)")
LINE = re.compile(r", line (\d+)$")
NAMELESS = re.compile(rf"\b{UNNAMED} (\d+)\b")
STILL = 8.5, 11.0  # m/s²: what the middle of a recording is near to
ENCODING_WORDS: Mapping[str, str] = {UTF_8: "UTF-8", UTF_16: "UTF-16", WINDOWS: "Windows-1252"}
SEPARATOR_WORDS: Mapping[str, str] = {
    SEPARATORS["comma"]: later("comma"),
    SEPARATORS["semicolon"]: later("semicolon"),
    SEPARATORS["tab"]: later("tab"),
    SEPARATORS["bar"]: later("vertical bar"),
    SEPARATORS["space"]: later("spaces"),
}
DECIMAL_WORDS: Mapping[str, str] = {".": later("point"), ",": later("comma")}
TIME_UNIT_WORDS: Mapping[str, str] = {
    "s": later("seconds"),
    "ms": later("milliseconds"),
    "us": later("microseconds"),
    "ns": later("nanoseconds"),
    "min": later("minutes"),
    "h": later("hours"),
    "d": later("days"),
    COUNT: later("samples counted"),
    CLOCK: later("time of day or date"),
}
ACC_UNIT_WORDS: Mapping[str, str] = {"m/s2": "m/s²", "g": "g", "mg": "mg"}
GYR_UNIT_WORDS: Mapping[str, str] = {"rad/s": "rad/s", "deg/s": "deg/s", "mdeg/s": "mdeg/s"}


class TableStatement(NamedTuple):
    """`what` and `then`: two sentences. `may_be_read`: whether the table can be read so."""

    what: str
    then: str
    may_be_read: bool
    is_caution: bool


def stated_of(preview: TablePreview) -> TableStatement:
    """Whether a table can be read as it is shown, and what to look at."""
    if preview.refusal is not None:
        return TableStatement(*refused(preview.refusal), may_be_read=False, is_caution=True)
    if not preview.sensors:
        return TableStatement(
            tr("No sensor was found in this table."),
            tr("Choose the columns of acceleration and angular rate."),
            may_be_read=False,
            is_caution=True,
        )
    what = " · ".join(filter(None, _facts(preview)))
    then, is_caution = _to_look_at(preview)
    return TableStatement(what, then, may_be_read=True, is_caution=is_caution)


def refused(refusal: FileRefusedError) -> tuple[str, str]:
    """Two sentences: what is wrong, in which line, and what to do."""
    what = capitalised(filled(refusal.what, refusal.values))
    line = LINE.search(refusal.where)
    if line is not None:
        what = tr("Line {number}: {what}").format(number=line[1], what=filled(refusal.what, refusal.values))
    return f"{what}.", f"{_remedy(refusal)}."


def why_shown(why: FileRefusedError | None, preview: TablePreview) -> str:
    """Why a table was not recognised, where that is not what is wrong with it anyway; what to do is below it."""
    if why is None or (preview.refusal is not None and preview.refusal.what == why.what):
        return ""
    return refused(why)[0]


def column_words(text: str) -> str:
    """A text with the columns that have no name in the user's language."""
    return NAMELESS.sub(lambda found: tr("column {number}").format(number=found[1]), text)


def refused_line(refusal: FileRefusedError) -> str:
    """Where, what is wrong, and what to do in one line: one of several that could not be read."""
    return f"{refusal.where}: {filled(refusal.what, refusal.values)}. {_remedy(refusal)}."


def _remedy(refusal: FileRefusedError) -> str:
    """What to do, without the options of the command line."""
    return OPTIONS.sub("", filled(refusal.remedy, refusal.values))


def findings_of(preview: TablePreview) -> tuple[Finding, ...]:
    """What was noticed in the sensors; what the choices show already is left out."""
    found = (one for sensor in preview.sensors for one in sensor.findings)
    return tuple(
        {(one.key, tuple(one.numbers.items())): one for one in found if one.key != "columns_understood"}.values()
    )


def _facts(preview: TablePreview) -> list[str]:
    sensors = preview.sensors
    rates_hz = sorted({round(one.rate_hz, 1) for one in sensors if one.rate_hz})
    rates = " / ".join(figure_text(rate_hz, "g") for rate_hz in rates_hz)
    length = tr("{length} s").format(length=figure_text(max(one.length_s for one in sensors), ".1f"))
    felt = _gravity(sensors)
    return [
        tr_n("{count} sensor", "{count} sensors", len(sensors)).format(count=len(sensors)),
        tr("at least {length}").format(length=length) if preview.is_cut else length,
        tr("{rates} Hz").format(rates=rates) if rates else "",
        tr("gravity {felt} m/s²").format(felt=figure_text(felt, ".1f")) if np.isfinite(felt) else "",
    ]


def _to_look_at(preview: TablePreview) -> tuple[str, bool]:
    """What to do before the table is read, and whether it is worth a caution."""
    acc = all(_is_there(one.acc_m_s2) for one in preview.sensors)
    gyr = all(_is_there(one.gyr_rad_s) for one in preview.sensors)
    felt = _gravity(preview.sensors)
    if not gyr:
        return tr("This file has no angular rates; they must be in a second file of this sensor."), True
    if not acc:
        return tr("This file has no acceleration; it must be in a second file of this sensor."), True
    if not STILL[0] < felt < STILL[1]:
        return tr("Gravity should be about 9.8 m/s². Check the columns and unit of acceleration."), True
    if preview.unread:
        return tr("Other sensors in this table cannot be read. The reasons are below the curves."), True
    if preview.is_by_values:
        return tr("The columns were found by their values alone. Check them."), True
    return tr("Compare the curves with what you know of the recording."), False


def _is_there(vectors: FloatArray) -> bool:
    return bool(np.isfinite(vectors).any())


def _gravity(sensors: tuple[PreviewedSensor, ...]) -> float:
    felt = np.concatenate([np.linalg.norm(one.acc_m_s2, axis=1) for one in sensors])
    known = felt[np.isfinite(felt)]
    return float(np.median(known)) if len(known) else float("nan")

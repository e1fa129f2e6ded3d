"""What is stated about recordings of another program before they are taken in."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.plots.thinning import thin
from app.wording.translation import figure_text, later, tr, tr_n
from core.body import Site
from core.samples import FloatArray, ImuBlock
from core.session import RecordingKind
from core.signal.clock_events import ClockEventKind, ClockView
from core.signal.clock_jumps import LONGER_THAN_LOSS_S
from core.signal.tracks import MAX_REPORTED_GAP_S
from devices.files.trial import PROGRAMS

if TYPE_CHECKING:
    from app.importing.import_drafts import DraftSensor, Origin
    from devices.files.trial import ImportedTrial

KIND_WORDS = {
    RecordingKind.STANDING: later("Standing"),
    RecordingKind.FREE_MOTION: later("Free motion"),
    RecordingKind.WALKING: later("Walk"),
}
SITE_WORDS = {
    Site.LEFT_THIGH: later("Left thigh"),
    Site.LEFT_SHANK: later("Left shank"),
    Site.LEFT_FOOT: later("Left foot"),
    Site.RIGHT_THIGH: later("Right thigh"),
    Site.RIGHT_SHANK: later("Right shank"),
    Site.RIGHT_FOOT: later("Right foot"),
    Site.PELVIS: later("Pelvis"),
}
GRAVITY_WORDS = {  # by the finding that reports it
    "gravity_from_orientation": later("gravity added from orientation"),
    "gravity_for_acceleration": later("no acceleration: gravity used instead"),
}
FEWEST_COLUMNS = 80  # of a small curve


def facts(trial: "ImportedTrial", clocks: ClockView) -> str:
    """Sensors, length, rates, gravity, gaps and clock of a recording in one line."""
    blocks = [sensor.block for sensor in trial.sensors]
    filled = [block for block in blocks if len(block)]
    has_jump = any(one.kind is ClockEventKind.JUMP for one in clocks.events)
    count = len(blocks)
    keys = {finding.key for sensor in trial.sensors for finding in sensor.findings}
    parts = [
        tr_n("{count} sensor", "{count} sensors", count).format(count=count),
        tr("{length} s").format(length=figure_text(clocks.length_s, ".1f")),
        _rates(trial),
        _gravity(filled),
        *(tr(words) for key, words in GRAVITY_WORDS.items() if key in keys),
        "" if has_jump else _gaps(filled),  # a jump looks like one
        _clock(trial),
        tr("angular rates derived from orientation") if any(block.is_rate_derived for block in blocks) else "",
    ]
    return " · ".join(filter(None, parts))


def sensor_name(sensor: "DraftSensor") -> str:
    """As its program calls it, and its number where that is not in it: "Left Foot (6570)"."""
    name = Path(sensor.name).stem if "." in sensor.name else sensor.name
    return sensor.key if sensor.key in name else f"{name} ({sensor.key})"


def breakable(name: str) -> str:
    """A file's name that may go on in another line after what joins its parts."""
    return re.sub(r"([_.-])", "\\1\N{ZERO WIDTH SPACE}", name)


def origin_words(origin: "Origin") -> str:
    """Where a site that was proposed comes from."""
    return {"name": tr("from its name"), "motion": tr("from movement"), "nothing": ""}[origin.value]


def kind_origin_words(origin: "Origin") -> str:
    """Where the kind of a recording comes from."""
    return {
        "name": tr("by its name"),
        "motion": tr("detected: almost no movement"),
        "nothing": tr("assumed to be a walk: unclear from its name"),
    }[origin.value]


def liveliness(blocks: Sequence[ImuBlock]) -> tuple[FloatArray, FloatArray]:
    """Times and the size of the angular rate of the first of `blocks` that has samples, thinned for a small curve."""
    block = next((block for block in blocks if len(block)), None)
    if block is None:
        return np.empty(0), np.empty(0)
    steps_s = np.diff(block.time_s, prepend=block.time_s[:1])
    steps_s[steps_s > LONGER_THAN_LOSS_S] = 0.0  # else a clock that jumped would leave the curve no room
    return thin(np.cumsum(steps_s), np.linalg.norm(block.gyr_rad_s, axis=1), FEWEST_COLUMNS)


def _rates(trial: "ImportedTrial") -> str:
    rates_hz = sorted({round(sensor.info.rate_hz, 1) for sensor in trial.sensors if sensor.info.rate_hz})
    return (
        tr("{rates} Hz").format(rates=" / ".join(figure_text(rate_hz, "g") for rate_hz in rates_hz)) if rates_hz else ""
    )


def _gaps(blocks: Sequence[ImuBlock]) -> str:
    """Steps that are longer than any output bridges, and than two usual ones."""
    steps = [np.diff(block.time_s) for block in blocks if len(block) > 1]
    gaps_s = [step[step > max(MAX_REPORTED_GAP_S, 2.5 * float(np.median(step)))] for step in steps]
    count, lost_s = sum(map(len, gaps_s)), float(sum(gap.sum() for gap in gaps_s))
    if not count:
        return tr("no gaps")
    stated = tr_n("{count} gap of {lost} s", "{count} gaps of {lost} s in total", count)
    return stated.format(count=count, lost=figure_text(lost_s, ".1f"))


def _gravity(blocks: Sequence[ImuBlock]) -> str:
    """What the sensors feel in the middle: whoever reads it sees whether the unit was understood."""
    felt = np.concatenate([np.linalg.norm(block.acc_m_s2, axis=1) for block in blocks]) if blocks else np.empty(0)
    known = felt[np.isfinite(felt)]
    return tr("gravity {felt} m/s²").format(felt=figure_text(np.median(known), ".1f")) if len(known) else ""


def _clock(trial: "ImportedTrial") -> str:
    clocks = {sensor.info.clock for sensor in trial.sensors}
    return tr("each sensor has its own clock") if len(clocks) > 1 else ""


def program_name(key: str) -> str:
    """A program whose files can be read, and what these files are."""
    words = {
        "movella-dot": tr("Movella DOT (files of its app)"),
        "xsens-mti": tr("Xsens MTi (raw bytes)"),
        "ximu3": tr("x-IMU3 (bytes or CSV)"),
        "ximu": tr("x-IMU (CSV)"),
        "shimmer": tr("Shimmer (card or Consensys)"),
        "apdm": tr("APDM (Moveo, Mobility Lab or Motion Studio)"),
        "opensim": tr("OpenSim (orientations)"),
        "xdf": tr("LabRecorder (XDF files)"),
        "matlab": tr("any program (MATLAB, named variables)"),
        "parquet": tr("any program (Parquet, named columns)"),
        "csv": tr("any program (CSV, named columns)"),
    }
    return words.get(key) or PROGRAMS.get(key, key)  # a format of another package has its name alone

"""The programs whose files can be read, each recognised by what is in a file, never by its name."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from devices.files.apdm import apdm_trial, is_apdm
from devices.files.bids_motion import bids_motion_trial, bids_recording, is_bids_motion
from devices.files.clock_repair import RESTARTED, restart_refusal, restarts_continued
from devices.files.csv_tables import choices_for, csv_recording, csv_trial, is_csv, why_no_csv
from devices.files.file_format import FileFormat
from devices.files.matlab_tables import matlab_trial
from devices.files.matlab_variables import is_matlab
from devices.files.movella_dot import dot_recording, is_movella_dot, movella_dot_trial
from devices.files.mti_streams import is_mti_stream, mti_trial
from devices.files.mvnx import is_mvnx, mvnx_trial
from devices.files.opensim_orientations import is_opensim_orientations, opensim_trial
from devices.files.other_formats import other_formats
from devices.files.parquet_tables import is_parquet, parquet_trial
from devices.files.refusal import FileRefusedError
from devices.files.sensor_mapping import read_mapping, with_names, without_mappings
from devices.files.session_toml import FILE_NAME
from devices.files.shimmer_tables import is_shimmer, shimmer_trial
from devices.files.table_choices import NOTHING_STATED, StatedChoices
from devices.files.text_files import as_utf8
from devices.files.trial import SIMULATED_MARK, ClockRestart, ImportedSensor, ImportedTrial
from devices.files.xdf import is_xdf, xdf_trial
from devices.files.ximu3_files import is_ximu3, ximu3_recording, ximu3_trial
from devices.files.ximu_files import is_ximu, ximu_recording, ximu_trial
from devices.files.xsens_mtmanager import is_mtmanager, mtmanager_trial

HEAD_BYTES = 65_536  # heads of many sensors are long


FORMATS: Mapping[str, FileFormat] = {
    "xsens-mtmanager": FileFormat(is_mtmanager, mtmanager_trial, is_one_sensor=True),
    "movella-dot": FileFormat(is_movella_dot, movella_dot_trial, is_one_sensor=True, trial_name=dot_recording),
    "xsens-mti": FileFormat(is_mti_stream, mti_trial, is_one_sensor=True),
    "ximu3": FileFormat(is_ximu3, ximu3_trial, is_one_sensor=True, trial_name=ximu3_recording),
    "ximu": FileFormat(is_ximu, ximu_trial, is_one_sensor=True, trial_name=ximu_recording),
    "shimmer": FileFormat(is_shimmer, shimmer_trial, is_one_sensor=True),
    "mvnx": FileFormat(is_mvnx, mvnx_trial),
    "apdm": FileFormat(is_apdm, apdm_trial),
    "opensim": FileFormat(is_opensim_orientations, opensim_trial),
    "bids-motion": FileFormat(is_bids_motion, bids_motion_trial, trial_name=bids_recording),
    "xdf": FileFormat(is_xdf, xdf_trial),
    "matlab": FileFormat(is_matlab, matlab_trial, is_one_sensor=True),
    "parquet": FileFormat(is_parquet, parquet_trial, is_one_sensor=True),
    "csv": FileFormat(is_csv, csv_trial, is_one_sensor=True, trial_name=csv_recording),  # the last that is asked
}


def read_trial(
    name: str,
    files: Sequence[Path],
    rate_hz: float | None,
    choices: StatedChoices = NOTHING_STATED,
    *,
    splits: bool = False,
) -> ImportedTrial:
    """Read one trial's files, of the recognised format where `name` is empty; raises FileRefusedError or OSError.

    `choices`: what somebody states of tables, whose format it takes the place of. `splits`: clocks that begin again
    are continued and stated (`ImportedSensor.restarts`), for whoever splits the recording there; else they are refused.
    """
    if splits:
        with restarts_continued() as met:
            try:
                return _with_restarts(read_trial(name, files, rate_hz, choices), met)
            except FileRefusedError as refusal:
                raise (met[0] if met else refusal) from refusal  # what follows may be due to it
    for path in files:
        _refuse_missing(path)
    every, mappings = without_mappings(list({path.resolve(): path for path in files}.values()))
    if not every:
        raise FileRefusedError(
            files[0].name,
            "the file names sensors and holds no recording",
            "Choose the recordings together with this file",
        )
    if any(choices_for(path, choices) is not None for path in every):
        found = csv_trial(every, rate_hz, choices)
    else:
        found = known_format(name or recognised(every)).trial(every, rate_hz)
    for path in mappings:
        found = with_names(found, read_mapping(path))
    return replace(found, is_simulated=found.is_simulated or any(map(_is_of_simulated_session, every)))


def _with_restarts(trial: ImportedTrial, met: Sequence[FileRefusedError]) -> ImportedTrial:
    """The trial with its clocks' restarts in place of their findings; raises FileRefusedError for one that is lost."""
    sensors = tuple(map(_with_its_restarts, trial.sensors))
    stated = {str(one.refusal) for sensor in sensors for one in sensor.restarts}
    for refusal in met:
        if str(refusal) not in stated:
            raise refusal  # its reader lost it
    return replace(trial, sensors=sensors)


def _with_its_restarts(sensor: ImportedSensor) -> ImportedSensor:
    restarts = []
    time_s = sensor.block.time_s
    for finding in sensor.findings:
        if finding.key != RESTARTED:
            continue
        of = finding.numbers
        at = int(of["samples"])
        if of["of"] != len(time_s):  # samples were left out since
            at = int(np.searchsorted(time_s, time_s[:1].sum() + float(of["after_s"]), side="right"))
        if 0 < at < len(time_s):
            restarts.append(ClockRestart(at, float(of["shift_s"]), restart_refusal(finding)))
    others = tuple(finding for finding in sensor.findings if finding.key != RESTARTED)
    return replace(sensor, findings=others, restarts=tuple(restarts))


def known_format(name: str) -> FileFormat:
    """Give the format of this name, ours or another package's; raises FileRefusedError where there is none."""
    found = FORMATS.get(name) or other_formats().get(name)
    if found is None:
        raise FileRefusedError(
            name, "the package that reads this format cannot be used", "gaitwright devices states the reason"
        )
    return found


def recognised(files: Sequence[Path]) -> str:
    """Give the format of one trial's files; raises FileRefusedError for an unknown or a mixed one, or OSError."""
    found: dict[str, Path] = {}
    for path in files:
        _refuse_missing(path)
        name = format_of(path, with_others=True)
        if name is None:
            raise why_not_recognised(path)
        found.setdefault(name, path)
    if len(found) > 1:
        (one, first), (other, second), *_ = found.items()
        raise FileRefusedError(
            second.name,
            "this file comes from {other}, but {first} from {one}",
            "Import the files of one program at a time",
            other=other,
            first=first.name,
            one=one,
        )
    return next(iter(found))


def why_not_recognised(path: Path) -> FileRefusedError:
    """Why a file or folder is of no format; raises OSError where it cannot be read."""
    reason = why_no_csv(path) if path.is_file() else None  # of the others a few bytes decide
    return reason or FileRefusedError(
        path.name,
        "the file format is not recognised",
        "Supported formats: {formats}. If the file has one of these formats, give the format with --as",
        formats=", ".join(FORMATS),
    )


def format_of(path: Path, *, with_others: bool = False) -> str | None:
    """Give the format of a file or folder; None for none; raises OSError where it cannot be read.

    `with_others`: a file that is none of ours is shown to those of other packages. A folder is not: ours may lie in it.
    """
    head = b""
    if path.is_file():
        with path.open("rb") as file:
            head = as_utf8(file.read(HEAD_BYTES))
    ours = next((name for name, one in FORMATS.items() if one.is_it(path, head)), None)
    if ours is not None or not with_others or path.is_dir():
        return ours
    return next((name for name, one in other_formats().items() if one.is_it(path, head)), None)


def _is_of_simulated_session(path: Path) -> bool:
    """Whether a file lies in a recording of a session folder of which nobody was measured, or beside the mark of it."""
    if (path.resolve().parent / SIMULATED_MARK).is_file():
        return True
    beside = path.resolve().parent.parent / FILE_NAME
    try:
        return bool(tomllib.loads(beside.read_text(encoding="utf-8"))["session"]["simulated"] is True)
    except (OSError, ValueError, LookupError, TypeError):
        return False


def _refuse_missing(path: Path) -> None:
    if not path.exists():
        raise FileRefusedError(str(path), "this file does not exist", "Check the file's name")

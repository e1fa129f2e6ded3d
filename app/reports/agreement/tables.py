"""The figures of an agreement as JSON and CSV, in degrees, and the columns' meaning."""

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from app.reports.agreement.study import AgreementStudy, AngleKind, ComparedWalk, UsedSamples
from app.system.tables import figure_cell, typed_cell, write_table
from core.agreement.events import EventAgreement, joined
from core.agreement.figures import NAMED_PHASES, STANCE, Agreement
from core.body import Joint
from core.gait.phases import PHASES, Phase
from core.results import JointAngle

FORMAT = "gaitwright-agreement/1"
SUMMARY, TABLE, EVENT_TABLE, LENGTHS, CURVES, MEANINGS = (
    "agreement.json",
    "agreement.csv",
    "event_agreement.csv",
    "stride_lengths.csv",
    "curves.csv",
    "columns.csv",
)
OVER_WALKS = "over walks"
DEGREES = {  # columns of agreement.csv and the figure behind each
    "z_rmse_deg": "z_rad",
    "m_rmse_deg": "m_rad",
    "bias_deg": "bias_rad",
    "sd_deg": "sd_rad",
    "limits_low_deg": "low_rad",
    "limits_high_deg": "high_rad",
    "range_error_deg": "range_error_rad",
    "range_error_sd_deg": "range_error_sd_rad",
}
SHARES = {"within_1_sd": "within_1_sd", "within_2_sd": "within_2_sd"}
PLACE = ("recording", "joint", "angle")
CLOCK = ("sign", "offset_s", "offset_sd_s", "clock_rate_ppm", "clock_rate_sd_ppm", "rate_likeness", "rate_gain")
STATUS = ("shape_status", "height_status")
USED = ("recorded", "outside_reference", "in_gaps", "after_slip")
SOURCE = "reference_source"
MEANING = {
    "recording": "the walk, or over walks",
    "joint": "left_knee, left_ankle, right_knee or right_ankle",
    "angle": "result; published (eq 15); orientation (eq 10)",
    "walks": "walks behind the row",
    "samples": "samples that both systems have",
    "z_rmse_deg": "root mean square error as measured; empty without a zero",
    "z_rmse_sd_deg": "standard deviation (n - 1) of it between walks",
    "m_rmse_deg": "root mean square error, its mean removed",
    "m_rmse_sd_deg": "standard deviation (n - 1) of it between walks",
    "bias_deg": "mean of measured less reference; empty without a zero",
    "sd_deg": "standard deviation (n - 1) of measured less reference; over walks with that of the biases",
    "limits_low_deg": "lower limit of agreement: bias less 1.96 sd",
    "limits_high_deg": "upper limit of agreement: bias plus 1.96 sd",
    "range_error_deg": "range measured less range of the reference, mean over strides",
    "range_error_sd_deg": "standard deviation (n - 1) of it between strides",
    "ranges": "strides behind it; 1 and no gait: the whole recording",
    "correlation": "of both curves; over walks the mean",
    "within_1_sd": "share of errors, their mean removed, inside one stated standard deviation",
    "within_2_sd": "share of errors, their mean removed, inside two stated standard deviations",
    "sign": "-1: the reference counts the other way and was turned",
    "offset_s": "what the reference's clock shows more at the middle of the walk",
    "offset_sd_s": "its standard deviation",
    "clock_rate_ppm": "by how much the reference's clock runs fast, one for all walks",
    "clock_rate_sd_ppm": "its standard deviation",
    "rate_likeness": "correlation of the rates of both angles",
    "rate_gain": "measured rates over those of the reference",
    "shape_status": "read, care, withheld or not_measured: the data quality of range and shape",
    "height_status": "read, care, withheld or not_measured: the data quality of absolute angles",
    "recorded": "samples of the walk; those that are not in `samples` are in one of the next three",
    "outside_reference": "samples before or after every trial of the reference",
    "in_gaps": "samples inside of a trial that one of both systems has not",
    "after_slip": "samples after a strap of this leg slipped",
    "reference_source": "angles, or markers: the reference holds no joint angles, which were computed from them",
}


OF_TABLES = {  # the other tables; of curves.csv as the left knee has them
    CURVES: {
        "time_s": "on the recording's clock",
        "left_knee_deg": "the result",
        "left_knee_reference_deg": "the reference, at this instant and in this sign",
        "left_knee_error_deg": "the first less the second",
        "left_knee_sd_deg": "stated standard deviation of the result",
        "left_knee_published_deg": "the published fusion (eq 15)",
        "left_phase": "loading, foot_flat, pre_swing or swing; empty when unknown",
    },
    EVENT_TABLE: {
        "recording": MEANING["recording"],
        "side": "left, right or both",
        "event": "initial_contact, full_contact, heel_rise or toe_off",
        "in_reference": "events of the reference",
        "found": "of these",
        "more": "found between the reference's first and last event, and not in it",
        "bias_ms": "mean lateness",
        "sd_ms": "standard deviation (n - 1) of the lateness",
    },
    LENGTHS: {
        "recording": "the walk",
        "side": "left or right",
        "stride_length_m": "of a stride that counts for averages",
        "reference_m": "of the stride of the reference that holds its swing",
        "error_m": "the first less the second",
    },
}


def write_study(study: AgreementStudy, folder: Path) -> None:
    """Write every table of an agreement into the existing `folder`; raises OSError."""
    write_table(*agreement_table(study), folder / TABLE)
    if any(walk.events for walk in study.walks):
        write_table(*event_table(study), folder / EVENT_TABLE)
    if any(len(pairs) for walk in study.walks for pairs in walk.lengths_m.values()):
        write_table(*length_table(study), folder / LENGTHS)
    for walk in study.with_angles:
        (folder / walk.recording.folder).mkdir(parents=True, exist_ok=True)
        write_table(*curve_table(walk), folder / walk.recording.folder / CURVES)
    write_table(("file", "column", "definition"), _meanings(), folder / MEANINGS)
    text = json.dumps(summary_of(study), indent=1, ensure_ascii=False, allow_nan=False)
    (folder / SUMMARY).write_text(text + "\n", encoding="utf-8")


def agreement_header() -> list[str]:
    phases = [f"{phase}_{what}" for phase in (*NAMED_PHASES, "stance") for what in ("rmse_deg", "bias_deg")]
    figures: list[str] = []
    for name in DEGREES:
        figures += [name, f"{name.removesuffix('_deg')}_sd_deg"] if name in ("z_rmse_deg", "m_rmse_deg") else [name]
    return [
        *PLACE,
        "walks",
        "samples",
        *figures,
        "ranges",
        "correlation",
        *SHARES,
        *phases,
        *CLOCK,
        *STATUS,
        *USED,
        SOURCE,
    ]


def agreement_table(study: AgreementStudy) -> tuple[list[str], Iterator[list[str]]]:
    """One row per walk, joint and angle, and for each joint and angle one over walks."""
    return agreement_header(), _rows(study)


def _rows(study: AgreementStudy) -> Iterator[list[str]]:
    for kind in AngleKind:
        for joint in study.joints:
            for walk in study.walks:
                if (joint, kind) not in walk.figures:
                    continue
                verdicts = walk.recording.verdicts.joint(joint)
                status = [str(verdicts.shape.verdict), str(verdicts.height.verdict)]
                place = [typed_cell(walk.recording.name), str(joint), str(kind)]
                used = _used_cells([walk.used[joint]])
                figures, source = _figures(walk.figures[joint, kind]), _source([walk])
                yield [*place, "1", *figures, *_clock(walk, joint), *status, *used, source]
            over = study.over_walks(joint, kind)
            if over is not None:
                figures = _figures(over.whole, over.z_sd_rad, over.m_sd_rad)
                place = [OVER_WALKS, str(joint), str(kind), str(over.walks)]
                walks = [walk for walk in study.walks if (joint, kind) in walk.figures]
                used = _used_cells([walk.used[joint] for walk in walks])
                yield [*place, *figures, *[""] * (len(CLOCK) + len(STATUS)), *used, _source(walks)]


def _figures(found: Agreement, z_sd_rad: float = math.nan, m_sd_rad: float = math.nan) -> list[str]:
    cells = [str(found.samples)]
    between = {"z_rmse_deg": z_sd_rad, "m_rmse_deg": m_sd_rad}
    for name, figure in DEGREES.items():
        cells.append(figure_cell(math.degrees(getattr(found, figure))))
        if name in between:
            cells.append(figure_cell(math.degrees(between[name])))
    cells += [
        str(found.ranges),
        figure_cell(found.correlation),
        *(figure_cell(getattr(found, name)) for name in SHARES.values()),
    ]
    for phases in (*((phase,) for phase in NAMED_PHASES), STANCE):
        error = found.in_phases(phases)
        cells += [figure_cell(math.degrees(error.rms_rad)), figure_cell(math.degrees(error.bias_rad))]
    return cells


def _clock(walk: ComparedWalk, joint: Joint) -> list[str]:
    found = walk.alignment
    if found is None:
        return [""] * len(CLOCK)
    numbers = (
        found.clock.offset_s,
        found.offset_sd_s,
        1e6 * found.clock.rate,
        1e6 * found.rate_sd,
        found.likeness.get(joint, math.nan),
        found.gain.get(joint, math.nan),
    )
    return [str(found.sign.get(joint, "")), *map(figure_cell, numbers)]


def _used_cells(walks: Sequence[UsedSamples]) -> list[str]:
    counts = [(one.recorded, one.outside, one.in_gaps, one.after_slip) for one in walks]
    return [str(sum(column)) for column in zip(*counts, strict=True)]


def _source(walks: Sequence[ComparedWalk]) -> str:
    """How the reference's angles came about: angles or markers, or both."""
    return " ".join(sorted({trial.source for walk in walks for trial, _ in walk.trials}))


def curve_table(walk: ComparedWalk) -> tuple[list[str], Iterator[list[str]]]:
    """Both angles at every instant of the walk, what they differ by, and the phases of both feet."""
    joints = [joint for joint in Joint if joint in walk.reference_rad]
    header, columns = ["time_s"], [walk.recording.time_s]
    for joint in joints:
        ours, reference = walk.recording.measured[joint], walk.reference_rad[joint]
        kinds = {"": ours.angle_rad, "_reference": reference, "_error": ours.angle_rad - reference, "_sd": ours.sd_rad}
        if isinstance(ours, JointAngle):
            kinds["_published"] = ours.published_rad
        header += [f"{joint}{kind}_deg" for kind in kinds]
        columns += [np.rad2deg(values) for values in kinds.values()]
    phases = {side: gait.phase for side, gait in walk.recording.gait.items()}
    header += [f"{side}_phase" for side in phases]

    def rows() -> Iterator[list[str]]:
        table = np.column_stack(columns)
        for k, row in enumerate(table.tolist()):
            yield [*map(figure_cell, row), *(str(PHASES[phase[k]]) for phase in phases.values())]

    return header, rows()


def event_table(study: AgreementStudy) -> tuple[list[str], list[list[str]]]:
    """Of each kind of event and foot: how many were found, how late, and how much that varies."""
    header = ["recording", "side", "event", "in_reference", "found", "more", "bias_ms", "sd_ms"]
    rows = [
        [typed_cell(walk.recording.name), str(side), event, *_event_cells(found)]
        for walk in study.walks
        for (side, event), found in walk.events.items()
    ]
    for event, found in events_together(study).items():
        rows.append([OVER_WALKS, "both", event, *_event_cells(found)])
    return header, rows


def events_together(study: AgreementStudy) -> dict[str, EventAgreement]:
    """Each kind of event, both feet and all walks."""
    kinds = dict.fromkeys(event for walk in study.walks for _, event in walk.events)
    return {
        kind: joined([found for walk in study.walks for (_, event), found in walk.events.items() if event == kind])
        for kind in kinds
    }


def _event_cells(found: EventAgreement) -> list[str]:
    return [
        str(found.count),
        str(found.found),
        str(found.more),
        figure_cell(1e3 * found.bias_s),
        figure_cell(1e3 * found.sd_s),
    ]


def length_table(study: AgreementStudy) -> tuple[list[str], list[list[str]]]:
    """Every stride used with its length by both systems."""
    rows = [
        [typed_cell(walk.recording.name), str(side), figure_cell(ours), figure_cell(theirs), figure_cell(ours - theirs)]
        for walk in study.walks
        for side, pairs in walk.lengths_m.items()
        for ours, theirs in pairs.tolist()
    ]
    return ["recording", "side", "stride_length_m", "reference_m", "error_m"], rows


def lengths_together(study: AgreementStudy) -> np.ndarray:
    """Lengths (k, 2) of all strides, measured and of the reference, metres."""
    parts = [pairs for walk in study.walks for pairs in walk.lengths_m.values()]
    return np.concatenate(parts) if parts else np.empty((0, 2))


def summary_of(study: AgreementStudy) -> dict[str, object]:
    """The same for programs; a figure that is not known is null."""
    header, rows = agreement_table(study)
    lengths = lengths_together(study)
    error = lengths[:, 0] - lengths[:, 1]
    return {
        "format": FORMAT,
        "simulated": study.is_simulated,
        "references": list(dict.fromkeys(walk.reference.file for walk in study.walks if walk.reference is not None)),
        "agreement": [_typed(header, row) for row in rows],
        "events": {
            kind: {"in_reference": e.count, "found": e.found, "more": e.more, **_json(bias_s=e.bias_s, sd_s=e.sd_s)}
            for kind, e in events_together(study).items()
        },
        "stride_length": {
            "strides": len(lengths),
            **_json(
                bias_percent=100 * error.mean() / lengths[:, 1].mean() if len(lengths) else math.nan,
                sd_m=float(np.std(error, ddof=1)) if len(lengths) > 1 else math.nan,
            ),
        },
        "left_over": list(study.left_over),
        "doubtful_offsets": [
            w.recording.name for w in study.walks if w.alignment and not w.alignment.is_offset_certain
        ],
    }


def _typed(header: list[str], row: list[str]) -> dict[str, object]:
    words = {*PLACE, *STATUS, SOURCE}
    return {
        name: cell if name in words else (None if cell == "" else json.loads(cell))
        for name, cell in zip(header, row, strict=True)
    }


def _json(**numbers: float) -> dict[str, float | None]:
    return {name: round(float(value), 7) if math.isfinite(value) else None for name, value in numbers.items()}


def _meanings() -> Iterator[tuple[str, str, str]]:
    for name in agreement_header():
        phase = next((p for p in (*NAMED_PHASES, "stance") if name.startswith(f"{p}_") and name not in MEANING), None)
        what = "root mean square" if name.endswith("rmse_deg") else "mean"
        stated = MEANING.get(name, f"{what} of the errors in {_phase_words(phase)}, the walk's mean removed")
        yield TABLE, name, stated
    for file, columns in OF_TABLES.items():
        for name, stated in columns.items():
            yield file, name, stated


def _phase_words(phase: Phase | str | None) -> str:
    return str(phase or "").replace("_", " ")

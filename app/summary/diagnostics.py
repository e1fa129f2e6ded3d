"""Numbers behind "How was this found". The same figures for the page and for the files."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.system.tables import figure_cell, write_table
from app.wording.body import segment_name
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, tr
from core.body import Joint
from core.samples import ComplexArray, FloatArray
from core.verdicts.diagnostics import JointDiagnostics

AXIS_COST, PROJECTED_RATES, TWO_WAYS, FIGURES = "axis_cost", "projected_rates", "two_ways", "figures"
SIMULATED = "simulated_"  # before the name of a file, where it cannot be lost
MARGIN_BEYOND = 100.0  # a margin larger than this adds nothing
SENSORS = ("proximal", "distal")
UNIT_WORDS = {"deg_s": "°/s", "deg": "°", "mm": "mm", "ms": "ms", "s": "s", "percent": "%", "": ""}


@dataclass(frozen=True, slots=True)
class FoundFigure:
    """One figure: `column` names it in the file with its unit at the end, `name` on the page; NaN is not known."""

    column: str
    name: str
    value: float
    unit: str
    decimals: int

    @property
    def in_words(self) -> str:
        if not math.isfinite(self.value):
            return tr("over {most}").format(most=f"{MARGIN_BEYOND:.0f}") if self.value > 0 else tr("not known")
        if self.column == "pairing_margin" and self.value > MARGIN_BEYOND:
            return tr("over {most}").format(most=f"{MARGIN_BEYOND:.0f}")
        number = figure_text(self.value, f".{self.decimals}f").replace("-", MINUS)
        unit = UNIT_WORDS[self.unit]
        return f"{number}{unit}" if unit == "°" else f"{number} {unit}".strip()


def figures_of(found: JointDiagnostics) -> dict[str, FoundFigure]:
    """All figures of one joint by their column, in the order of reading."""
    calibration, ways, shown = found.calibration, found.ways, found.projected
    unknown = math.nan
    joint = found.joint
    near, far = segment_name(joint.proximal.segment), segment_name(joint.distal.segment)
    residual, best = calibration.hinge_residual_rad_s, tr("Angle between axis in use and best fit, {segment}")
    rows = [
        ("data_sets", tr("Data sets, 10 per second"), float(found.excitation.sets), "", 0),
        ("moving_s", tr("Movement used"), found.excitation.moving_s, "s", 1),
        ("about_axis_deg_s", tr("Rotation about the axis"), _deg(found.excitation.about_rad_s), "deg_s", 0),
        ("across_axis_deg_s", tr("Rotation across the axis"), _deg(found.excitation.across_rad_s), "deg_s", 0),
        ("axis_sd_deg", tr("Calibration uncertainty, 1 SD"), _deg(calibration.axis_sd_rad), "deg", 1),
        *(
            (f"lowest_{sensor}_apart_deg", best.format(segment=segment), _deg(cost.apart_rad), "deg", 1)
            for sensor, segment, cost in zip(SENSORS, (near, far), found.costs, strict=True)
        ),
        ("published_apart_deg", tr("Angle, axis in use to published axis"), _deg(found.published_apart_rad), "deg", 1),
        ("hinge_residual_deg_s", tr("Hinge residual (eq 3)"), _deg(residual), "deg_s", 1),
        ("off_axis_deg_s", tr("Off-axis rotation, this recording"), _deg(found.off_axis_rate_rad_s), "deg_s", 1),
        (
            "congruence_percent",
            tr("Agreement, as paired"),
            100 * shown.congruence if shown else unknown,
            "percent",
            0,
        ),
        (
            "reversed_congruence_percent",
            tr("Agreement, one axis reversed"),
            100 * shown.reversed_congruence if shown else unknown,
            "percent",
            0,
        ),
        ("pairing_margin", tr("Misfit of the next best solution, factor"), _or_nan(calibration.sign_margin), "", 1),
        *_centre_rows(found, near, far),
        ("lag_ms", tr("Clock lag of the distal sensor"), 1000 * calibration.lag_s, "ms", 1),
        ("lag_sd_ms", tr("Clock lag uncertainty, 1 SD"), 1000 * _or_nan(calibration.lag_sd_s), "ms", 1),
        ("lag_cost_ratio", tr("Misfit without lag correction, factor"), _or_nan(found.lag_cost_ratio), "", 2),
        ("drift_deg_s", tr("Drift if only gyroscopes are used"), abs(_deg(ways.drift_rad_s)), "deg_s", 2),
        (
            "bias_drift_deg_s",
            tr("Drift, offset from standing not removed"),
            abs(_deg(found.bias_drift_rad_s)),
            "deg_s",
            2,
        ),
        ("scatter_deg", tr("Scatter, accelerometers alone"), _deg(ways.scatter_rad), "deg", 1),
    ]
    return {row[0]: FoundFigure(*row) for row in rows}


def _centre_rows(found: JointDiagnostics, near: str, far: str) -> list[tuple[str, str, float, str, int]]:
    calibration = found.calibration
    centres = (calibration.centre_proximal_m, calibration.centre_distal_m)
    rows = [
        (
            f"centre_{sensor}_mm",
            tr("Joint centre to sensor, {segment}").format(segment=segment),
            math.nan if centre is None else 1000 * float(np.linalg.norm(centre)),
            "mm",
            0,
        )
        for sensor, segment, centre in zip(SENSORS, (near, far), centres, strict=True)
    ]
    centre_sd_mm = 1000 * _or_nan(calibration.centre_sd_m)
    return [*rows, ("centre_sd_mm", tr("Joint centre uncertainty, 1 SD"), centre_sd_mm, "mm", 0)]


def names_of_files(joint: Joint, is_simulated: bool) -> dict[str, str]:
    """The files of one joint by what they hold."""
    first = SIMULATED if is_simulated else ""
    return {what: f"{first}{joint}_{what}.csv" for what in (AXIS_COST, PROJECTED_RATES, TWO_WAYS, FIGURES)}


def write_diagnostics(found: JointDiagnostics, is_simulated: bool, folder: Path) -> list[Path]:
    """Write every number that the page shows to files in `folder`, created if missing; raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = {what: folder / name for what, name in names_of_files(found.joint, is_simulated).items()}
    _write_costs(found, paths[AXIS_COST])
    _write_projected(found, paths[PROJECTED_RATES])
    ways = found.ways
    angles = [np.rad2deg(found.clinical(v)) for v in (ways.from_rates_rad, ways.from_accelerations_rad, ways.fused_rad)]
    _write_columns(
        ("time_s", "from_rates_deg", "from_accelerations_deg", "fused_deg"), [ways.time_s, *angles], paths[TWO_WAYS]
    )
    texts = [
        ("joint", str(found.joint), ""),
        ("recording", found.walk, ""),
        ("identified_from", "; ".join(found.from_recordings), ""),
        ("is_simulated", str(is_simulated).lower(), ""),
    ]
    numbers = [(one.column, figure_cell(one.value), one.unit) for one in figures_of(found).values()]
    write_table(("figure", "value", "unit"), [*texts, *numbers], paths[FIGURES])
    return list(paths.values())


def _write_costs(found: JointDiagnostics, path: Path) -> None:
    header = ("sensor", "what", "x", "y", "z", "rms_deg_s")
    rows: list[Sequence[str]] = []
    for sensor, cost in zip(SENSORS, found.costs, strict=True):
        rows += [
            [sensor, "axis_in_use", *map(figure_cell, cost.axis), ""],
            [sensor, "best_fit", *map(figure_cell, cost.lowest), ""],
        ]
        values = np.rad2deg(cost.rms_rad_s)
        for direction, value in zip(cost.direction.reshape(-1, 3).tolist(), values.ravel().tolist(), strict=True):
            rows.append([sensor, "direction", *map(figure_cell, direction), figure_cell(value)])
    write_table(header, rows, path)


def _write_projected(found: JointDiagnostics, path: Path) -> None:
    shown = found.projected
    curves = [] if shown is None else [shown.proximal, shown.distal, shown.reversed_distal]
    columns = [] if shown is None else [shown.time_s, *(part for z in curves for part in parts_deg_s(z))]
    names = [f"{name}_{part}_deg_s" for name in ("proximal", "distal", "reversed_distal") for part in "xy"]
    _write_columns(("time_s", *names), columns, path)


def parts_deg_s(z: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Both coordinates (k,) of a projected rate, degrees per second."""
    return np.rad2deg(np.real(z)), np.rad2deg(np.imag(z))


def _write_columns(header: Sequence[str], columns: Sequence[FloatArray], path: Path) -> None:
    rows = zip(*(column.tolist() for column in columns), strict=True)
    write_table(header, ([figure_cell(value) for value in row] for row in rows if math.isfinite(row[0])), path)


def _deg(value_rad: float | None) -> float:
    return math.nan if value_rad is None else math.degrees(value_rad)


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value

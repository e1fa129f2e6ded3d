"""Check that the live prediction is honest.

Calibrations are stopped at random times, and their true errors compared with the predicted ones.

    python -m tests.benchmarks.excitation [--sessions 500] [--first 0] [--picture excitation.png]

Each session is one leg of the project's patient: rigid or with soft tissue, moved richly or poorly, with good or biased
sensors, on one clock or up to 30 ms apart, stopped after 3 to 25 s. The live excitation sees the samples as they come;
the true error is that of the calibration which the offline analysis makes of the same samples. Printed: how often the
error lies within twice the predicted standard deviation, floors included, how often a gauge closed, and whether the
calibration then reported what the gauge had promised.
"""

import os
import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.body import Joint, Site
from core.calibration.identified import identify
from core.calibration.rest import rest_of
from core.calibration.validity import basis_of
from core.live.excitation import HUMAN, Excitation, ExcitationState
from core.live.orientation import LiveOrientation, OrientedSamples
from core.live.streams import EvenStream
from core.results import Method
from core.samples import FloatArray, RateKind
from core.session import Session
from core.signal.sensors import SensorTracks
from devices.simulation.walker import (
    FreeMotion,
    JointTruth,
    Motion,
    SensorErrors,
    Standing,
    Tissue,
    WalkerSettings,
    simulate,
)
from tests.benchmarks.scoring import line_error_deg
from tests.driver import options

KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
LEG = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
MOTIONS = (Motion.FULL, Motion.FULL, Motion.WEAK, Motion.SAGITTAL, Motion.KNEE_ONLY, Motion.SIDE_LYING)
BAD_SENSORS = SensorErrors(gyro_bias_sd_rad_s=np.deg2rad(1.5), acc_bias_sd_m_s2=0.1)
MAX_LATE_S = 0.03
FREE_MOTION_S = 25.5
QUANTITIES = ("knee axis, deg", "knee centre, mm", "ankle centre, mm")


@dataclass(frozen=True, slots=True)
class Stopped:
    """One quantity of one calibration: its true error, twice the predicted sd, the gauge, all deg or mm.

    `is_reported`: the calibration calls it known.
    """

    quantity: str
    seed: int
    stop_s: float
    conditions: tuple[str, ...]
    error: float
    predicted: float
    gauge: float
    is_closed: bool
    is_reported: bool

    @property
    def is_covered(self) -> bool:
        return self.error <= self.predicted


def stopped_calibrations(seed: int) -> Iterator[Stopped]:
    """One session, one stop: axis and centre of the knee, centre of the ankle."""
    rng = np.random.default_rng([seed, 77])
    motion = MOTIONS[rng.integers(len(MOTIONS))]
    tissue = (Tissue.RIGID, Tissue.SOFT)[rng.integers(2)]
    is_biased, is_late = rng.random(2) < 0.5
    late_s = {site: float(rng.uniform(-MAX_LATE_S, MAX_LATE_S)) for site in LEG[1:]} if is_late else {}
    stop_s = float(rng.uniform(3.0, 25.0))
    settings = WalkerSettings(
        seed=seed,
        sites=LEG,
        recordings=(Standing(), FreeMotion(duration_s=FREE_MOTION_S, motion=motion)),
        tissue=tissue,
        errors=BAD_SENSORS if is_biased else SensorErrors(),
        clock_late_s=late_s,
    )
    conditions = (
        motion.value,
        tissue.value,
        "biased sensors" if is_biased else "good sensors",
        "clocks apart" if is_late else "same clock",
        "3-10 s" if stop_s < 10 else "10-25 s",
    )
    simulated = simulate(settings)
    session = _until(simulated.session, stop_s)
    tracks = SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    live = {site: _as_they_come(session, site) for site in LEG}
    for joint in (KNEE, ANKLE):
        state = Excitation(joint).update(live[joint.proximal], live[joint.distal])
        basis = basis_of(tracks.span, session.recordings[1], joint, tracks.is_usable)
        found = identify(tracks, basis, Method.ROBUST, tau_s=2.0)
        if found is None or found.robust is None:
            continue  # too little movement: nothing is claimed
        truth = simulated.truth.recordings[session.recordings[1].name].joints[joint]
        centre = found.robust.centre
        error_m = _centre_error_m(centre.proximal_m, centre.distal_m, truth, joint.is_knee)
        axes = found.geometry.axis_1, found.geometry.axis_2
        yield from _reported(seed, stop_s, conditions, joint, state, axes, truth, error_m, found.is_centre_known)


def _reported(
    seed: int,
    stop_s: float,
    conditions: tuple[str, ...],
    joint: Joint,
    state: ExcitationState,
    axes: tuple[FloatArray, FloatArray],
    truth: JointTruth,
    error_m: float,
    is_centre_reported: bool,
) -> Iterator[Stopped]:
    stated = seed, stop_s, conditions
    if joint.is_knee:
        true = truth.functional_proximal, truth.functional_distal
        error_deg = max(line_error_deg(own, other) for own, other in zip(axes, true, strict=True))
        predicted, gauge = 2 * state.axis_sd_with_floor_rad, state.axis_sd_rad
        is_closed = gauge <= HUMAN.axis_rad
        yield Stopped(
            "knee axis, deg",
            *stated,
            error_deg,
            float(np.rad2deg(predicted)),
            float(np.rad2deg(gauge)),
            is_closed,
            True,
        )
    quantity = "knee centre, mm" if joint.is_knee else "ankle centre, mm"
    predicted, gauge = 2 * state.centre_sd_with_floor_m, state.centre_sd_m
    is_closed = gauge <= HUMAN.centre_m
    yield Stopped(quantity, *stated, 1000 * error_m, 1000 * predicted, 1000 * gauge, is_closed, is_centre_reported)


def _centre_error_m(o1: FloatArray, o2: FloatArray, truth: JointTruth, is_knee: bool) -> float:
    """The larger of both sensors' errors; of a knee across its axis, along which nothing shows."""
    errors = []
    for found, true, axis in (
        (o1, truth.centre_proximal_m, truth.axis_proximal),
        (o2, truth.centre_distal_m, truth.axis_distal),
    ):
        error = found - true
        errors.append(float(np.linalg.norm(error - axis * (axis @ error) if is_knee else error)))
    return max(errors)


def _until(session: Session, stop_s: float) -> Session:
    standing, free = session.recordings
    imu = {}
    for site, block in free.imu.items():
        n = int(np.searchsorted(block.time_s, stop_s))
        imu[site] = replace(block, time_s=block.time_s[:n], gyr_rad_s=block.gyr_rad_s[:n], acc_m_s2=block.acc_m_s2[:n])
    return replace(session, recordings=(standing, replace(free, imu=imu)))


def _as_they_come(session: Session, site: Site) -> OrientedSamples:
    """The samples of one sensor on the live road: even, free of the bias that standing showed, oriented causally."""
    standing, free = session.recordings
    rest = rest_of(standing.imu[site])
    assert rest is not None
    stream = EvenStream(100.0)
    stream.feed(free.imu[site])
    return LiveOrientation(rest.gyr_rad_s, RateKind.INSTANTANEOUS, stream.step_s).update(stream.take())


def table(reported: list[Stopped]) -> str:
    """Coverage per quantity and condition."""
    lines = []
    for quantity in QUANTITIES:
        mine = [one for one in reported if one.quantity == quantity]
        lines.append(f"\n{quantity}: {_line(mine)}")
        groups: dict[str, list[Stopped]] = defaultdict(list)
        for one in mine:
            for condition in one.conditions:
                groups[condition].append(one)
        lines += [f"  {condition:16s} {_line(groups[condition])}" for condition in sorted(groups)]
        closed = [one for one in mine if one.is_closed]
        lines.append(f"  {'gauge closed':16s} {_line(closed)}   told {sum(one.is_reported for one in closed)}")
    return "\n".join(lines)


def _line(reported: list[Stopped]) -> str:
    if not reported:
        return "none"
    error, predicted = np.array([one.error for one in reported]), np.array([one.predicted for one in reported])
    covered = np.mean([one.is_covered for one in reported])
    return (
        f"{100 * covered:5.1f} % of {len(reported):4d} within 2 sd   error p50 {np.median(error):6.1f} "
        f"p90 {np.quantile(error, 0.9):6.1f}   2 sd p50 {np.median(predicted):6.1f}   "
        f"gauge p50 {np.median([one.gauge for one in reported]):6.1f}"
    )


def draw(reported: list[Stopped], path: Path) -> None:
    """Predicted against true on logarithmic scales, one panel per quantity; below the line is covered."""
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from PySide6.QtCore import QPointF, QRectF, Qt
    from PySide6.QtGui import QColor, QGuiApplication, QImage, QPainter, QPen

    application = QGuiApplication.instance() or QGuiApplication(sys.argv[:1])
    side, margin = 420, 60
    image = QImage((side + margin) * len(QUANTITIES) + margin, side + 2 * margin, QImage.Format.Format_RGB32)
    image.fill(Qt.GlobalColor.white)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    ranges = {"knee axis, deg": (0.05, 200.0), "knee centre, mm": (0.5, 2000.0), "ankle centre, mm": (0.5, 2000.0)}
    for panel, quantity in enumerate(QUANTITIES):
        low, high = np.log10(ranges[quantity])
        left, top = margin + panel * (side + margin), margin
        frame = QRectF(left, top, side, side)

        def place(
            predicted: float, error: float, frame: QRectF = frame, low: float = low, high: float = high
        ) -> QPointF:
            x, y = (np.clip((np.log10(v) - low) / (high - low), 0.0, 1.0) for v in (predicted, error))
            return QPointF(frame.left() + x * frame.width(), frame.bottom() - y * frame.height())

        painter.setPen(QPen(QColor("#888888")))
        painter.drawRect(frame)
        painter.drawLine(frame.bottomLeft(), frame.topRight())
        for decade in range(int(np.ceil(low)), int(np.floor(high)) + 1):
            at = place(10.0**decade, 10.0**decade)
            painter.drawText(QPointF(at.x() - 8, frame.bottom() + 16), f"{10.0**decade:g}")
            painter.drawText(QPointF(frame.left() - 34, at.y() + 4), f"{10.0**decade:g}")
        painter.drawText(QPointF(left, top - 12), f"{quantity}: true error (up) against twice the predicted sd (right)")
        painter.setPen(Qt.PenStyle.NoPen)
        for one in reported:
            if one.quantity == quantity:
                colour = QColor("#D55E00" if Tissue.SOFT.value in one.conditions else "#0072B2")
                colour.setAlpha(150)
                painter.setBrush(colour)
                painter.drawEllipse(place(one.predicted, one.error), 3.0, 3.0)
        painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor("#333333")))
    painter.drawText(
        QPointF(margin, side + 2 * margin - 12), "blue: rigid; orange: soft tissue; under the diagonal: covered"
    )
    painter.end()
    image.save(str(path))
    del application


def main() -> None:
    arguments = options(
        __doc__,
        sessions=500,
        first=0,
        picture={"type": Path},
        misses=(False, "print every calibration that is not covered"),
    )
    reported = [
        one
        for seed in range(arguments.first, arguments.first + arguments.sessions)
        for one in stopped_calibrations(seed)
    ]
    print(table(reported))
    for one in reported if arguments.misses else ():
        if not one.is_covered:
            figures = f"{one.stop_s:5.1f} s  error {one.error:6.1f}  2 sd {one.predicted:6.1f}"
            print(f"{one.quantity:17s} seed {one.seed:4d} {figures}  {', '.join(one.conditions)}")
    if arguments.picture:
        draw(reported, arguments.picture)


if __name__ == "__main__":
    main()

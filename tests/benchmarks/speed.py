"""Speed and accuracy of Gaitwright beside qmt and VQF, in one run, on the same recordings.

    python -m tests.benchmarks.speed [--seeds 3] [--repeats 5]

CPU seconds of one core. The methods take turns on every recording; ratios are taken turn by turn, then their median.
The result is printed and kept in tests/benchmarks/README.md.
"""

import os
import platform
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import date
from functools import partial
from importlib.metadata import version
from pathlib import Path

import numpy as np

from core.analysis import analyse
from core.body import Joint
from core.calibration.identify import moving_data
from core.published.angles import published_angle
from core.published.identify import identify_as_published
from core.published.joint_centre import shifted_to_sensors
from core.results import Method
from core.samples import FloatArray
from core.signal.pair import OrientedTrack, pair_up
from core.signal.tracks import Track
from tests.benchmarks.peers import vqf_angle
from tests.benchmarks.peers.qmt_axes import QmtAxes
from tests.benchmarks.scoring import Estimate, Score, score
from tests.benchmarks.trials import Trial, hinge_trials, simulated_trials
from tests.driver import options

ONE_CORE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
LONG_MINUTES = 6.0
KNEE_ONLY = (Joint.LEFT_KNEE,)
README = Path(__file__).with_name("README.md")
LAST = "## The last comparison\n"

Run = Callable[[Trial], Estimate]

OURS = "Gaitwright robust, whole analysis"
PUBLISHED = "Gaitwright as published, its stages"
NONE = np.full(3, np.nan)
NO_ANGLE = np.empty(0)


def analysed(method: Method, trial: Trial) -> Estimate:
    """All that `analyse` does: quality, identification, both angles, sign, zero, certainty, findings."""
    start_s = time.process_time()
    found = analyse(trial.session, method)
    cpu_s = time.process_time() - start_s
    calibration = found.calibrations[0].joints[trial.joint]
    (recording,) = (r for r in found.recordings if r.name == trial.recording)
    sign = calibration.clinical_sign
    axes = sign * calibration.axis_proximal, sign * calibration.axis_distal
    return Estimate(*axes, recording.time_s, recording.joints[trial.joint].angle_rad, cpu_s)


def published_stages(trial: Trial) -> Estimate:
    """The paper alone: angular accelerations, axes, signs, centres, and the angle of eq 15. Its zero is not scored."""
    start_s = time.process_time()
    n = len(trial.g1)
    unturned = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))  # the paper needs no orientation
    everywhere = np.ones(n, dtype=bool)
    one = Track(0.0, trial.step_s, trial.g1, trial.a1, None, None, everywhere)
    two = replace(one, gyr_rad_s=trial.g2, acc_m_s2=trial.a2)
    pair = pair_up(OrientedTrack(one, unturned), OrientedTrack(two, unturned), 0.0)
    assert pair is not None
    data = moving_data((pair,))
    assert data is not None
    found = identify_as_published(data, data)
    j1, j2 = found.axis_1, found.axis_2
    centres = found.centre_1_m, found.centre_2_m
    if trial.joint.is_knee:
        centres = shifted_to_sensors(*centres, j1, j2)
    angle = -published_angle(pair, j1, j2, *centres)
    return Estimate(j1, j2, _stamps(trial), angle, time.process_time() - start_s)


def qmt_axes(qmt: QmtAxes, trial: Trial) -> Estimate:
    axis_1, axis_2, cpu_s = qmt.find(trial)
    return Estimate(axis_1, axis_2, NO_ANGLE, NO_ANGLE, cpu_s)


def qmt_and_vqf(qmt: QmtAxes, trial: Trial) -> Estimate:
    """The peers' whole road: qmt's axes, then the angle of offline VQF about them."""
    axis_1, axis_2, axes_s = qmt.find(trial)
    found = _vqf(vqf_angle.offline, trial, axis_1, axis_2)
    return replace(found, cpu_s=axes_s + found.cpu_s)


def vqf_known(run: vqf_angle.Filter, trial: Trial) -> Estimate:
    """The axes are reported, so only the angle is scored."""
    return _vqf(run, trial, trial.truth.axis_1, trial.truth.axis_2)


def vqf_twice(trial: Trial) -> Estimate:
    """Two orientations and nothing else."""
    start_s = time.process_time()
    vqf_angle.orientations(trial, vqf_angle.offline)
    return Estimate(NONE, NONE, NO_ANGLE, NO_ANGLE, time.process_time() - start_s)


def _vqf(run: vqf_angle.Filter, trial: Trial, axis_1: FloatArray, axis_2: FloatArray) -> Estimate:
    start_s = time.process_time()
    angle = vqf_angle.angle(trial, run, axis_1, axis_2)
    return Estimate(axis_1, axis_2, _stamps(trial), angle, time.process_time() - start_s)


def _stamps(trial: Trial) -> FloatArray:
    return trial.step_s * np.arange(len(trial.g1))


@dataclass(frozen=True, slots=True)
class Contender:
    """A method and what of it is scored."""

    run: Run
    has_axes: bool = True
    has_angle: bool = True
    has_zero: bool = True


def contenders(qmt: QmtAxes) -> dict[str, Contender]:
    return {
        OURS: Contender(partial(analysed, Method.ROBUST)),
        "Gaitwright published, whole analysis": Contender(partial(analysed, Method.PUBLISHED)),
        PUBLISHED: Contender(published_stages, has_zero=False),
        "qmt, axes alone": Contender(partial(qmt_axes, qmt), has_angle=False, has_zero=False),
        "qmt axes, offline VQF x2, heading": Contender(partial(qmt_and_vqf, qmt)),
        "VQF x2, heading, axes told": Contender(partial(vqf_known, vqf_angle.online), has_axes=False),
        "offline VQF x2, heading, axes told": Contender(partial(vqf_known, vqf_angle.offline), has_axes=False),
        "offline VQF x2 alone": Contender(vqf_twice, has_axes=False, has_angle=False, has_zero=False),
    }


@dataclass(frozen=True, slots=True)
class Outcome:
    """One method on one trial: CPU seconds per turn, and its score."""

    cpu_s: FloatArray
    score: Score


def compete(trials: Sequence[Trial], methods: dict[str, Contender], repeats: int) -> dict[str, list[Outcome]]:
    """Every method on every trial, by turns; outcomes by method, in the order of the trials."""
    outcomes: dict[str, list[Outcome]] = defaultdict(list)
    for trial in trials:
        turns = [{name: method.run(trial) for name, method in methods.items()} for _ in range(repeats)]
        for name in methods:
            cpu_s = np.array([turn[name].cpu_s for turn in turns])
            outcomes[name].append(Outcome(cpu_s, score(turns[0][name], trial.truth)))
    return outcomes


def speed_table(
    minutes: dict[str, list[Outcome]], base: dict[str, list[Outcome]], long: dict[str, list[Outcome]]
) -> Iterator[str]:
    """CPU of every minute there is; and of a further one, from `base` to the same motions made longer."""
    yield "| method | one minute, ms | of robust | of published | further minute, ms |"
    yield "|---|---|---|---|---|"
    for name, outcomes in minutes.items():
        first_ms = 1000 * _median(o.cpu_s for o in outcomes)
        ratios = [_median(_ratios(outcomes, minutes[other])) for other in (OURS, PUBLISHED)]
        more = (b.cpu_s - a.cpu_s for a, b in zip(base[name], long[name], strict=True))
        further_ms = 1000 * _median(more) / (LONG_MINUTES - 1)
        yield f"| {name} | {first_ms:.1f} | {ratios[0]:.2f} | {ratios[1]:.2f} | {further_ms:.1f} |"


def accuracy_table(
    trials: Sequence[Trial], outcomes: dict[str, list[Outcome]], methods: dict[str, Contender]
) -> Iterator[str]:
    yield "| recordings | joint | method | CPU, ms | of robust | axis, deg | paired wrong | M, deg | Z, deg |"
    yield "|---|---|---|---|---|---|---|---|---|"
    groups = dict.fromkeys((trial.kind, trial.group) for trial in trials)
    for kind, group in sorted(groups, key=lambda g: g[0] != "knee"):
        mine = [k for k, trial in enumerate(trials) if (trial.kind, trial.group) == (kind, group)]
        ours = [outcomes[OURS][k] for k in mine]
        for name, method in methods.items():
            if method.has_axes or method.has_angle:
                cells = " | ".join(_cells([outcomes[name][k] for k in mine], ours, method))
                yield f"| {group} ({len(mine)}) | {kind} | {name} | {cells} |"


def _cells(outcomes: list[Outcome], ours: list[Outcome], method: Contender) -> Iterator[str]:
    scores = [o.score for o in outcomes]
    yield f"{1000 * _median(o.cpu_s for o in outcomes):.1f}"
    yield f"{_median(_ratios(outcomes, ours)):.2f}"
    axes = f"{_middle(s.axis_1_deg for s in scores)} / {_middle(s.axis_2_deg for s in scores)}"
    yield axes if method.has_axes else "told"
    yield f"{sum(not s.is_paired for s in scores)}" if method.has_axes else "told"
    yield _middle(s.m_deg for s in scores) if method.has_angle else ""
    yield _middle(s.z_deg for s in scores) if method.has_zero else ""


def _ratios(outcomes: Sequence[Outcome], others: Sequence[Outcome]) -> Iterator[FloatArray]:
    return (one.cpu_s / other.cpu_s for one, other in zip(outcomes, others, strict=True))


def _median(parts: Iterator[FloatArray]) -> float:
    return float(np.median(np.concatenate(list(parts))))


def _middle(values: Iterator[float]) -> str:
    """The median over recordings, empty where nothing is known."""
    middle = float(np.median(list(values)))
    return f"{middle:.2f}" if np.isfinite(middle) else ""


def machine() -> str:
    """Processor, system and versions, in one line."""
    processor = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.is_file():
        named = [line for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        processor = named[0].split(":")[1].strip() if named else processor
    parts = " ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "vqf"))
    system = f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
    return f"{date.today()}, {processor}, {os.cpu_count()} cores, one used, {system}, {parts}"


def main() -> None:
    required = options(
        __doc__, seeds=(3, "simulated sessions per condition"), repeats=(5, "turns of every method on every recording")
    )
    trials = [*simulated_trials(range(required.seeds)), *hinge_trials()]
    if all(trial.truth.is_clock_shared for trial in trials):
        print("GAITWRIGHT_TEST_DATA is not set: the mechanical hinge is excluded.", file=sys.stderr)
    base, long = (list(simulated_trials(range(1), minutes, KNEE_ONLY)) for minutes in (1.0, LONG_MINUTES))
    with QmtAxes() as qmt:
        methods = contenders(qmt)
        compete(base[:1], methods, 1)  # imports and first calls
        outcomes, base_outcomes, long_outcomes = (compete(t, methods, required.repeats) for t in (trials, base, long))
    simulated = [k for k, trial in enumerate(trials) if trial.truth.is_clock_shared]
    minutes = {name: [found[k] for k in simulated] for name, found in outcomes.items()}
    command = f"python -m tests.benchmarks.speed --seeds {required.seeds} --repeats {required.repeats}"
    lines = [
        f"Made by `{command}` on {machine()}.",
        "",
        "One joint, one minute, 100 Hz, two sensors:",
        "",
        *speed_table(minutes, base_outcomes, long_outcomes),
        "",
        "Medians over recordings (their number in brackets):",
        "",
        *accuracy_table(trials, outcomes, methods),
    ]
    print("\n".join(lines))
    before, _, rest = README.read_text(encoding="utf-8").partition(LAST)
    _, next_title, after = rest.partition("\n## ")
    README.write_text("\n".join([f"{before}{LAST}", *lines, f"{next_title}{after}"]), encoding="utf-8")


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in ONE_CORE):  # NumPy reads these when it is imported
        again = [sys.executable, "-m", "tests.benchmarks.speed", *sys.argv[1:]]
        os.execve(sys.executable, again, {**os.environ, **ONE_CORE})
    main()

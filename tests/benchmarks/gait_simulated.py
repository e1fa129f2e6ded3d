"""Check that events, phases, time and distance of the project's own patient reach what is asked of them.

    python -m tests.benchmarks.gait_simulated [--seeds 2] [--rates 50 60 100 200] [--gaits ordinary toes]

One line for each gait, tissue, speed and sampling rate. Events (IC initial contact, FC full contact, HR heel rise, TO
toe-off) and phases: error in ms, mean and standard deviation. The first swing, out of standing, and the last, into it,
count as found or not; their errors stand apart, as the worst of all ("ends"). Time and distance: mean over the strides
used less the mean of the true ones, in percent of it. What misses its target carries an asterisk.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from core.body import Side, Site
from core.calibration.rest import rest_of
from core.gait.events import FootEvents, gait_of
from core.gait.spatiotemporal import both_feet, parameters_of
from core.gait.strides import Strides, strides_of
from core.samples import FloatArray
from core.signal.pair import OrientedTrack
from devices.simulation.walker import FootTruth, Manner, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.core.gait.feet import foot_of
from tests.driver import options

FEET = {Side.LEFT: Site.LEFT_FOOT, Side.RIGHT: Site.RIGHT_FOOT}
EVENTS = {"IC": "initial_contact_s", "FC": "full_contact_s", "HR": "heel_rise_s", "TO": "toe_off_s"}
PHASES = ("loading", "foot flat", "pre-swing", "swing")
TIMES = ("stride_time_s", "step_time_s", "stance_percent", "swing_percent", "double_support_percent")
LENGTH = "stride_length_m"
SPEEDS_M_S = (0.3, 0.5, 0.8, 1.19, 1.6, 2.0)
RATES_HZ = (50.0, 60.0, 100.0, 200.0)
SAME_S = 0.15  # an event further than this from every true one is invented
EVENT_SD_S, TIME_PERCENT, LENGTH_PERCENT = 0.010, 1.0, 2.0  # the targets
GAITS: Mapping[str, tuple[WalkerSettings, Walk]] = {
    "ordinary": (WalkerSettings(), Walk()),
    "prosthesis": (WalkerSettings(prosthetic_side=Side.LEFT), Walk()),
    "stiff knee": (WalkerSettings(stiff_knee_side=Side.LEFT), Walk()),
    "shuffling": (WalkerSettings(), Walk(manner=Manner.SHUFFLING)),
    "toes": (WalkerSettings(), Walk(manner=Manner.TOES)),
    "flat": (WalkerSettings(), Walk(manner=Manner.FLAT)),
    "stiff foot": (WalkerSettings(), Walk(manner=Manner.STIFF)),
    "dragging": (WalkerSettings(), Walk(manner=Manner.DRAGGING)),
    "toe first": (WalkerSettings(), Walk(manner=Manner.TOE_FIRST)),
}


@dataclass(slots=True)
class Score:
    """Over some walks: swings counted; errors of events and phases in seconds, of parameters in percent."""

    rate_hz: float
    expected: int = 0
    found: int = 0
    invented: int = 0
    used: int = 0
    ends_s: float = 0.0
    errors_s: dict[str, list[FloatArray]] = field(default_factory=lambda: defaultdict(list))
    percent: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))

    def mean_and_sd_s(self, name: str) -> tuple[float, float]:
        errors = np.concatenate([np.empty(0), *self.errors_s[name]])
        return float(np.mean(errors)), float(np.std(errors))

    def mean_percent(self, name: str) -> float:
        return float(np.mean(self.percent[name])) if self.percent[name] else float("nan")

    def missed(self) -> list[str]:
        """The names of what falls short of its target."""
        phase_mean_s, phase_sd_s = (0.010, 0.015) if self.rate_hz > 60.0 else (0.020, 0.025)
        short = [] if self.found == self.expected else ["found"]
        short += ["invented"] if self.invented else []
        short += [name for name in EVENTS if not self.mean_and_sd_s(name)[1] <= EVENT_SD_S]
        for name in PHASES:
            mean_s, sd_s = self.mean_and_sd_s(name)
            short += [] if abs(mean_s) <= phase_mean_s and sd_s <= phase_sd_s else [name]
        short += [name for name in TIMES if not abs(self.mean_percent(name)) <= TIME_PERCENT]
        return short + ([] if abs(self.mean_percent(LENGTH)) <= LENGTH_PERCENT else [LENGTH])


def walks_of(settings: WalkerSettings) -> dict[Side, tuple[OrientedTrack, FootTruth]]:
    """Both feet of the walk that follows a standing."""
    made = simulate(replace(settings, sites=tuple(FEET.values())))
    standing, walk = made.session.recordings
    feet = {}
    for side, site in FEET.items():
        rest = rest_of(standing.imu[site])
        assert rest is not None
        feet[side] = foot_of(walk.imu[site], rest.gyr_rad_s), made.truth.recordings[walk.name].feet[side]
    return feet


def true_events(truth: FootTruth) -> FootEvents:
    reported = truth.events
    nothing = np.full(len(reported.toe_off_s), np.nan)
    certain = np.ones(len(reported.toe_off_s), dtype=bool)
    return FootEvents(
        heel_rise_s=reported.heel_rise_s,
        toe_off_s=reported.toe_off_s,
        initial_contact_s=reported.initial_contact_s,
        full_contact_s=reported.full_contact_s,
        length_m=truth.stride_lengths_m,
        height_m=nothing,
        climb_m=np.zeros_like(nothing),
        turn_rad=np.zeros_like(nothing),
        is_certain=certain,
        is_measured=certain,
        source=np.zeros((len(certain), 4), dtype=np.int64),
        sd_s=np.zeros((len(certain), 4)),
    )


def phases_of(events: FootEvents) -> list[FloatArray]:
    """Durations of loading, foot flat, pre-swing and swing, as in PHASES, of each but the first and the last swing."""
    return [
        (events.full_contact_s - events.initial_contact_s)[1:-1],
        events.heel_rise_s[2:] - events.full_contact_s[1:-1],
        (events.toe_off_s - events.heel_rise_s)[1:-1],
        (events.initial_contact_s - events.toe_off_s)[1:-1],
    ]


def add_walk(score: Score, feet: Mapping[Side, tuple[OrientedTrack, FootTruth]]) -> None:
    """Score one walk of both feet; a foot with a swing too many or too few is counted, and timed no further."""
    ours, true = {}, {}
    for side, (foot, truth) in feet.items():
        found, expected = gait_of(foot), true_events(truth)
        far_s = np.abs(found.initial_contact_s[:, None] - expected.initial_contact_s)
        score.expected += len(expected)
        score.found += int(np.sum(far_s.min(axis=0, initial=np.inf) < SAME_S))
        score.invented += int(np.sum(far_s.min(axis=1, initial=np.inf) >= SAME_S))
        if len(found) != len(expected):
            continue
        ours[side], true[side] = strides_of([found]), strides_of([expected])
        for name, column in EVENTS.items():
            error_s = getattr(found, column) - getattr(expected, column)
            score.errors_s[name].append(error_s[1:-1])
            score.ends_s = max(score.ends_s, float(np.max(np.abs(error_s[[0, -1]]))))
        for name, here, there in zip(PHASES, phases_of(found), phases_of(expected), strict=True):
            score.errors_s[name].append(here - there)
    if len(ours) == len(Side):
        _add_parameters(score, ours, true)


def _add_parameters(score: Score, ours: Mapping[Side, Strides], true: Mapping[Side, Strides]) -> None:
    """Over the same strides: those which we use, if both feet have any."""
    if any(len(ours[side]) != len(true[side]) or not ours[side].is_used.any() for side in Side):
        return
    true = {side: replace(true[side], reason=ours[side].reason) for side in Side}
    score.used += sum(int(np.sum(strides.is_used)) for strides in ours.values())
    ours_mean, true_mean = (_means(strides) for strides in (ours, true))
    for name, mean in ours_mean.items():
        score.percent[name].append(100.0 * (mean / true_mean[name] - 1.0))


def _means(strides: Mapping[Side, Strides]) -> dict[str, float]:
    left, right = strides[Side.LEFT], strides[Side.RIGHT]
    both = [(parameters_of(a, b), a.is_used) for a, b in ((left, right), (right, left))]
    means = {
        name: float(np.nanmean(np.concatenate([reported[name][is_used] for reported, is_used in both])))
        for name in (*TIMES, LENGTH)
        if name != "double_support_percent"
    }
    return {**means, "double_support_percent": both_feet(left, right).double_support_percent}


def score_walks(settings: WalkerSettings, walk: Walk, seeds: Iterable[int]) -> Score:
    score = Score(settings.rate_hz)
    for seed in seeds:
        add_walk(score, walks_of(replace(settings, seed=seed, recordings=(Standing(), walk))))
    return score


def line(score: Score) -> str:
    short = score.missed()

    def reported(name: str, text: str) -> str:
        return text + ("*" if name in short else " ")

    figures = [reported("found", f"{score.found}/{score.expected}") + reported("invented", f"+{score.invented}")]
    for name in (*EVENTS, *PHASES):
        mean_s, sd_s = score.mean_and_sd_s(name)
        figures.append(reported(name, f"{1000.0 * mean_s:4.0f} {1000.0 * sd_s:3.0f}"))
    figures.append(f"{1000.0 * score.ends_s:4.0f}")
    figures += [reported(name, f"{score.mean_percent(name):5.2f}") for name in (*TIMES, LENGTH)]
    return " | ".join(figures)


HEADER = " | ".join(
    [
        *("gait", "tissue", "m/s", "Hz", "found", *EVENTS, *PHASES, "ends"),
        *("stride", "step", "stance", "swing", "double support", "length"),
    ]
)


def main() -> None:
    asked = options(
        __doc__,
        seeds=2,
        gaits={"nargs": "+", "default": list(GAITS), "choices": GAITS},
        tissues={"nargs": "+", "default": list(Tissue), "type": Tissue},
        speeds={"nargs": "+", "default": SPEEDS_M_S, "type": float},
        rates={"nargs": "+", "default": RATES_HZ, "type": float},
    )
    print(HEADER)
    for gait in asked.gaits:
        for tissue in asked.tissues:
            for speed_m_s in asked.speeds:
                for rate_hz in asked.rates:
                    settings, walk = GAITS[gait]
                    settings = replace(settings, tissue=tissue, rate_hz=rate_hz)
                    score = score_walks(settings, replace(walk, speed_m_s=speed_m_s), range(asked.seeds))
                    print(f"{gait} | {tissue:5s} | {speed_m_s:4.2f} | {rate_hz:3.0f} | {line(score)}", flush=True)


if __name__ == "__main__":
    main()

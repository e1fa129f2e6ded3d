"""Count how often each finding comes where it must, and where it must not.

    python -m tests.benchmarks.warnings_table [--sessions 500] [--workers 2] [--results FILE] [--only KEY ...]

Sessions of many kinds of people, sensors and clocks are simulated; each knows which findings are true of it, and any
other is a false alarm. One session per finding is made in which it must come (`warning_cases`). The real recordings
that GAITWRIGHT_TEST_DATA names are analysed beside, without saying what is true of them. With --results each session
is added to the file as it is done, and what the file holds is not done again.
"""

import json
import os
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from core.analysis import analyse
from core.body import LEG_SITES, Segment, Side, Site
from core.samples import ImuBlock, RateKind
from core.session import Recording, RecordingKind, Session
from devices.files.session_folder import read_session
from devices.simulation.walker import (
    COARSE,
    PEOPLE,
    VERY_COARSE,
    FreeMotion,
    Manner,
    SensorErrors,
    Standing,
    Tissue,
    Variation,
    Walk,
    WalkerSettings,
    simulate,
)
from tests.benchmarks.warning_cases import CASES
from tests.driver import options

Value = TypeVar("Value")
MAX_FALSE_PERCENT = 2.0
KINDS: tuple[str, ...] = ("seed", "must", "real")  # what a row of the results is about
MANNERS = (*(Manner.ORDINARY,) * 6, Manner.SHUFFLING, Manner.FLAT, Manner.STIFF, Manner.DRAGGING, Manner.TOE_FIRST)
LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
WORN = (*(LEG_SITES,) * 5, LEFT, tuple(s for s in LEG_SITES if s.segment is not Segment.THIGH))
# true of any session here: what kind of joint was found, and whether a method's angle or a centre can be reported
ALWAYS = {"simulated", "is_a_hinge", "not_a_hinge", "centre_unknown", "published_differs"}


@dataclass(frozen=True, slots=True)
class Drawn:
    """One simulated session and the findings that are true of it."""

    settings: WalkerSettings
    true: frozenset[str]


def draw(seed: int) -> Drawn:
    """Any person, any sensors: healthy, prosthetic, after a stroke, coarse or fine, standing or not."""
    rng = np.random.default_rng([seed, 815])

    def chance(share: float) -> bool:
        return bool(rng.random() < share)

    def one_of(values: Sequence[Value]) -> Value:
        return values[int(rng.integers(len(values)))]

    manner, one_side = one_of(MANNERS), chance(0.5)
    side = one_of(tuple(Side))
    walk = Walk(
        speed_m_s=float(rng.uniform(0.4, 1.4) if manner is Manner.ORDINARY else rng.uniform(0.4, 0.8)),
        strides=int(rng.integers(14, 20)),
        standing_before_s=1.0,
        standing_after_s=1.0,
        turn_rad=np.pi * chance(0.15),
        manner=Manner.ORDINARY if one_side else manner,
        manner_of_side={side: manner} if one_side else {},
    )
    has_standing, has_free_motion = chance(0.8), chance(0.6)
    recordings: list[Standing | FreeMotion | Walk] = [walk]
    if has_free_motion:
        recordings.insert(0, FreeMotion(duration_s=8.0))
    if has_standing:
        recordings.insert(0, Standing())
    late, has_loss, has_prosthesis, has_stiff_knee = chance(0.15), chance(0.1), chance(0.15), chance(0.08)
    sites = one_of(WORN)
    settings = WalkerSettings(
        seed=seed,
        recordings=tuple(recordings),
        sites=sites,
        tissue=one_of(tuple(Tissue)),
        prosthetic_side=side if has_prosthesis else None,
        stiff_knee_side=side if has_stiff_knee and not has_prosthesis else None,
        rate_hz=float(one_of((50, 60, 100, 100, 128, 200))),
        rate_kind=one_of(tuple(RateKind)),
        clock_late_s={one_of(sites): 0.03} if late else {},
        loss_fraction=0.01 if has_loss else 0.0,
        stamp_jitter_s=0.001 if chance(0.2) else 0.0,
        errors=one_of((SensorErrors(), COARSE, VERY_COARSE)),
        tissue_gain=0.09,
        tissue_gain_sd=0.04,
        variation=PEOPLE if chance(0.5) else Variation(),
    )
    return Drawn(settings, frozenset(_true_of(settings, walk, manner)))


def _true_of(settings: WalkerSettings, walk: Walk, manner: Manner) -> Iterator[str]:
    yield from ALWAYS
    kinds = {type(recording) for recording in settings.recordings}
    if Standing not in kinds:
        # the walks' own second of standing may report the bias or not
        yield from ("no_standing", "gyro_bias_unknown")
    if FreeMotion not in kinds:
        yield "axis_from_walking"
    if settings.clock_late_s:
        yield "lag_corrected"
    if settings.tissue is not Tissue.REAL or settings.prosthetic_side:
        # nothing rings on a rigid foot, and hardly anything on the tissue that only follows the muscles
        yield "ankle_axis_from_rates"
    if settings.loss_fraction:
        # an angle has a gap in a stride or two, which are not used
        yield from ("bridged", "gaps", "no_spread", "no_spread_of_side")
    if settings.prosthetic_side:
        yield "prosthetic_toe_off"
    if not {site for site in settings.sites if site.segment is Segment.THIGH}:
        yield "missing_site"
    if manner is not Manner.ORDINARY or settings.prosthetic_side or settings.stiff_knee_side:
        yield "no_peak"
    if walk.turn_rad:
        # strides that turn are left out, and few may be left
        yield from ("no_spread", "no_spread_of_side")
    if manner is Manner.STIFF or settings.prosthetic_side or settings.stiff_knee_side:
        # such a joint hardly flexes
        yield from ("clinical_sign_uncertain", "axis_uncertain", "flexion_did_not_dominate")


def reported_by(session: Session) -> list[tuple[str, str]]:
    return [(found.key, found.where) for found in analyse(session).findings]


def simulated_row(seed: int) -> dict[str, object]:
    drawn = draw(seed)
    reported = reported_by(simulate(drawn.settings).session)
    return {"seed": seed, "true": sorted(drawn.true), "told": reported}


def must_row(key: str) -> dict[str, object]:
    return {"must": key, "is_told": key in {found.key for found in CASES[key].findings()}}


def real_sessions(data: Path) -> Iterator[tuple[str, Session]]:
    for folder in sorted((data / "stroke_treadmill").glob("stroke*")):
        yield folder.name, read_session(folder)
    names = {Segment.THIGH: "upper_leg", Segment.SHANK: "lower_leg", Segment.FOOT: "foot"}
    with np.load(data / "full_body_free_motion/legs_arms.npz") as held:
        imu = {}
        for site in LEG_SITES:
            name = f"{names[site.segment]}_{site.side}"
            imu[site] = ImuBlock(str(site), held["t"], held[f"{name}_gyr"], held[f"{name}_acc"])
    yield "full body", Session((Recording("motion", RecordingKind.FREE_MOTION, "motion", imu),))
    for name in ("1D_02", "1D_03"):
        with np.load(data / f"hinge_mechanical/{name}.npz") as held:
            time_s = np.arange(len(held["acc1"])) / float(held["fs"])
            pair = {
                site: ImuBlock(str(site), time_s, held[f"gyr{k}"], held[f"acc{k}"])
                for k, site in ((1, Site.LEFT_THIGH), (2, Site.LEFT_SHANK))
            }
        yield f"hinge {name}", Session((Recording("hinge", RecordingKind.FREE_MOTION, "hinge", pair),))


def real_row(named: tuple[str, Session]) -> dict[str, object]:
    name, session = named
    return {"real": name, "told": reported_by(session)}


def table(rows: Sequence[Mapping[str, object]]) -> str:
    """The results as a table in Markdown, findings by their name."""
    must = {str(row["must"]): bool(row["is_told"]) for row in rows if "must" in row}
    simulated = [row for row in rows if "seed" in row]
    real = [row for row in rows if "real" in row]
    wrong, right, asked, lately = Counter[str](), Counter[str](), Counter[str](), defaultdict[str, list[int]](list)
    for row in simulated:
        true, reported = set(_texts(row["true"])), _keys(row)
        for key in {*CASES, *reported}:
            if key in true:
                right[key] += key in reported
            else:
                asked[key] += 1
                wrong[key] += key in reported
                if key in reported:
                    lately[key].append(int(str(row["seed"])))
    on_people = Counter(key for row in real for key in _keys(row))
    lines = [
        f"{len(simulated)} simulated sessions, {len(real)} real recordings",
        "",
        "| finding | where it must | false alarms | where it may | real recordings | seeds of false alarms |",
        "|---|---|---|---|---|---|",
    ]
    for key in sorted({*CASES, *wrong, *right, *on_people}):
        share = f"{100 * wrong[key] / asked[key]:.1f} % ({wrong[key]}/{asked[key]})" if asked[key] else "-"
        mark = " **" if asked[key] and 100 * wrong[key] > MAX_FALSE_PERCENT * asked[key] else ""
        came = {True: "comes", False: "MISSING", None: "-"}[must.get(key)]
        seeds = " ".join(map(str, lately[key][:5]))
        lines.append(f"| {key}{mark} | {came} | {share} | {right[key]} | {on_people[key]}/{len(real)} | {seeds} |")
    return "\n".join(lines)


def _texts(value: object) -> list[str]:
    return [str(v) for v in value] if isinstance(value, list) else []


def _keys(row: Mapping[str, object]) -> set[str]:
    reported = row["told"]
    return {str(one[0]) for one in reported} if isinstance(reported, list) else set()


def main() -> None:
    reported = options(
        "How often does each finding come where it must not?",
        sessions=500,
        first=0,
        workers=2,
        results={"type": Path},
        table_only=(False, "print what the results hold"),
    )
    rows: list[dict[str, object]] = []
    if reported.results and reported.results.exists():
        rows = [json.loads(line) for line in reported.results.read_text(encoding="utf-8").splitlines()]
    done: set[tuple[str, str]] = {
        (kind, str(row[kind])) for row in rows for kind in ("seed", "must", "real") if kind in row
    }
    if not reported.table_only:
        for row in _missing_rows(reported.first, reported.sessions, reported.workers, done):
            rows.append(row)
            if reported.results:
                with reported.results.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
    print(table(rows))


def _missing_rows(first: int, sessions: int, workers: int, done: set[tuple[str, str]]) -> Iterator[dict[str, object]]:
    seeds = [seed for seed in range(first, first + sessions) if ("seed", str(seed)) not in done]
    musts = [key for key in CASES if ("must", key) not in done]
    data = os.environ.get("GAITWRIGHT_TEST_DATA")
    if data is None:
        print("GAITWRIGHT_TEST_DATA is not set: the real recordings are left out.", file=sys.stderr)
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(must_row, musts)
        for named in real_sessions(Path(data)) if data else ():
            if ("real", named[0]) not in done:
                yield real_row(named)
        yield from pool.map(simulated_row, seeds)


if __name__ == "__main__":
    main()

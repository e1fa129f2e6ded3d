"""Accuracy on recordings with references and in the paper's experiment. One command, one page.

    python -m tests.validation [--people 10] [--write]

Public recordings are made into session folders in a temporary folder and go through `gaitwright agree`; they are left
out where GAITWRIGHT_TEST_DATA does not name the shared data. `--write` puts the tables into the manual's page Accuracy
and into the site's page Validation.
"""

import contextlib
import io
import json
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from app.cli.main import main as gaitwright
from core.body import Joint, Side
from devices.files.session_folder import write_session
from devices.simulation.walker import Tissue
from tests.benchmarks.foot_scoring import FoundStrides, Stretch, StrideScore, score_strides
from tests.benchmarks.gait import NO_BIAS, optical_foot, recorded_foot
from tests.core.gait.feet import foot_of
from tests.driver import options
from tests.validation.paper_experiment import PROSTHESIS, against_bones, experiment
from tests.validation.recordings_with_references import HINGES, recordings_with_references

ROOT = Path(__file__).parents[2]
ACCURACY = ROOT / "resources" / "help" / "accuracy.md"
SIMULATED = ROOT / "packaging" / "site" / "pages" / "en" / "validation.md"
RECORDINGS, EXPERIMENT, WHY = (
    "## Public recordings",
    "## The experiment of the paper, simulated",
    "## Why the sides differ",
)
PAPER = {  # Table 1 of Seel, Raisch and Schauer 2014: mean and sigma as printed
    (True, True): (0.71, 0.19),
    (True, False): (3.30, 1.20),
    (False, True): (0.81, 0.16),
    (False, False): (1.62, 0.57),
}
ROWS = [(is_knee, is_prosthesis) for is_knee in (True, False) for is_prosthesis in (True, False)]

Summary = Mapping[str, Any]


def agreed(session: Path, references: Sequence[Path], out: Path) -> Summary:
    """What `gaitwright agree` writes as JSON; what it states goes nowhere."""
    arguments = ["agree", str(session), "--out", str(out), "--no-report"]
    arguments += [argument for file in references for argument in ("--reference", str(file))]
    stated, progress = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(stated), contextlib.redirect_stderr(progress):
        code = gaitwright(arguments)
    if code:
        raise RuntimeError(f"{session}: {progress.getvalue().splitlines()[-1]}")
    found: Summary = json.loads((out / "agreement.json").read_text(encoding="utf-8"))
    return found


def row_of(found: Summary, recording: str, joint: str) -> Summary:
    (row,) = [
        one
        for one in found["agreement"]
        if (one["recording"], one["joint"], one["angle"]) == (recording, joint, "result")
    ]
    return dict(row)


def recordings_table(data: Path) -> Iterator[str]:
    """One row for each figure: what was found, and the target that it has."""
    yield "| Recording | Quantity | Found | Target |"
    yield "|---|---|---|---|"
    with tempfile.TemporaryDirectory(prefix="gaitwright-validation-") as folder:
        for one in recordings_with_references(data, Path(folder)):
            found = agreed(one.session, one.references, Path(folder) / f"{one.session.parent.name}-out")
            yield from _of_hinge(one.name, found) if one.name.endswith(HINGES) else _of_feet(found)
    pitch_deg, count = foot_pitch(data)
    yield f"| feet | pitch of the foot over {count} strides, RMSE, mean removed | {pitch_deg:.2f}° | - |"


def _of_hinge(name: str, found: Summary) -> Iterator[str]:
    row = row_of(found, "hinge", "left_knee")
    seconds = row["samples"] / 50.0
    yield f"| {name} | angle over {seconds:.0f} s, RMSE, mean removed (M) | {row['m_rmse_deg']:.2f}° | 0.7° |"
    yield f"| {name} | samples inside 1 and 2 stated SD | {_share(row, 1)}, {_share(row, 2)} | -, 90 % |"
    yield f"| {name} | clock of the optics | {row['clock_rate_ppm']:+.0f} ppm | - |"


def _share(row: Summary, sds: int) -> str:
    return f"{100 * row[f'within_{sds}_sd']:.0f} %"


def _of_feet(found: Summary) -> Iterator[str]:
    for kind, target in (("initial_contact", "all, SD 10 ms"), ("toe_off", "all, SD 10 ms")):
        events = found["events"][kind]
        late, sd = 1e3 * events["bias_s"], 1e3 * events["sd_s"]
        counts = f"{events['found']} of {events['in_reference']}, {events['more']}"
        name = f"{'toe-off' if kind == 'toe_off' else 'initial contact'}: found, more, late, SD"
        yield f"| feet | {name} | {counts}, {late:.1f} ms, {sd:.1f} ms | {target} |"
    length = found["stride_length"]
    yield (
        f"| feet | stride length of {length['strides']} strides, bias, SD | {length['bias_percent']:+.2f} %, "
        f"{100 * length['sd_m']:.1f} cm | 1 %, 3 cm |"
    )


def foot_pitch(data: Path) -> tuple[float, int]:
    """RMSE of the foot's pitch against optics, degrees, and of how many strides; not by `agree`, which has joints."""
    scores = []
    for side in Side:
        foot = foot_of(recorded_foot(data, side), NO_BIAS)
        turned = Stretch(foot.track.time_s, Rotation.from_quat(foot.q_earth_from_sensor, scalar_first=True))
        optical = optical_foot(data, side)
        contacts = np.array([stride.initial_contact_s for stride in optical.strides])
        scores.append(score_strides(FoundStrides(contacts, np.full(len(contacts), np.nan), (turned,)), optical))
    score = StrideScore.joined(scores)
    pitch_rad, _ = score.pooled_pitch_rad(score.has_pitch)
    return float(np.rad2deg(pitch_rad)), int(np.sum(score.has_pitch))


def experiment_table(people: int) -> Iterator[str]:
    """The paper's averages beside those of simulated people, and the walks of the first of them."""
    found = []
    with tempfile.TemporaryDirectory(prefix="gaitwright-validation-") as folder:
        for seed in range(1, people + 1):
            place = Path(folder) / str(seed)
            place.mkdir()
            session, optics = experiment(seed, place)
            write_session(session, place / "session")
            found.append(agreed(place / "session", [optics], place / "out"))
            print(f"person {seed} of {people}", file=sys.stderr)
    walks = [f"walk {k}" for k in range(1, 7)]
    yield f"| Joint | Side | Paper | {people} people: median (range) | The first: walks 1 to 6, mean ± SD |"
    yield "|---|---|---|---|---|"
    for is_knee, is_prosthesis in ROWS:
        side = PROSTHESIS if is_prosthesis else PROSTHESIS.other
        joint = Joint(f"{side}_{'knee' if is_knee else 'ankle'}")
        means = [row_of(one, "over walks", joint)["m_rmse_deg"] for one in found]
        first = [row_of(found[0], walk, joint)["m_rmse_deg"] for walk in walks]
        over = row_of(found[0], "over walks", joint)
        mean, sd = PAPER[is_knee, is_prosthesis]
        names = f"| {'knee' if is_knee else 'ankle'} | {'prosthesis' if is_prosthesis else 'sound'} "
        of_all = f"{np.median(means):.2f}° ({min(means):.2f} to {max(means):.2f})"
        of_first = (
            f"{' '.join(f'{value:.2f}' for value in first)}: {over['m_rmse_deg']:.2f}° ± {over['m_rmse_sd_deg']:.2f}"
        )
        yield f"{names}| {mean:.2f}° ± {sd:.2f} | {of_all} | {of_first} |"


def why_table(people: int) -> Iterator[str]:
    """The sound knee against the bones, which only a simulation knows."""
    yield "| Skin | Sensors vs bones | Markers vs bones | Sensors vs markers |"
    yield "|---|---|---|---|"
    for tissue, words in ((Tissue.REAL, "as of people who walk"), (Tissue.SOFT, "a third to a fifth of it")):
        with tempfile.TemporaryDirectory(prefix="gaitwright-validation-") as folder:
            found = np.array([against_bones(seed, tissue, Path(folder)) for seed in range(1, people + 1)])
        cells = (f"{np.median(one):.1f}° ({one.min():.1f} to {one.max():.1f})" for one in found.T)
        yield f"| {words} | {' | '.join(cells)} |"


def with_table(page: str, title: str, table: Sequence[str]) -> str:
    """The page with another table under a heading of this title."""
    before, heading, after = page.partition(f"{title}\n")
    if not heading:
        raise ValueError(f"there is no {title!r}")
    return before + heading + re.sub(r"(?m)(^\|.*\n)+", "\n".join(table) + "\n", after, count=1)


def main() -> None:
    required = options(
        __doc__,
        people=(10, "simulated people in the paper's experiment"),
        write=(False, f"put the tables into {ACCURACY.name} and {SIMULATED.name}"),
    )
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    tables = {EXPERIMENT: list(experiment_table(required.people)), WHY: list(why_table(min(5, required.people)))}
    if reported:
        tables[RECORDINGS] = list(recordings_table(Path(reported)))
    else:
        print("GAITWRIGHT_TEST_DATA is not set: the public recordings are left out.", file=sys.stderr)
    for title, table in tables.items():
        print(title, "", *table, "", sep="\n")
        if required.write:
            place = ACCURACY if title == RECORDINGS else SIMULATED
            place.write_text(with_table(place.read_text(encoding="utf-8"), title, table), encoding="utf-8")


if __name__ == "__main__":
    main()

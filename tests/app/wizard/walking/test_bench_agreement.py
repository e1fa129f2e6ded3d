"""Sentence, table and curves of the bench agree on simulated fittings: same numbers, same direction, same mark.

Only what is shown is read: the texts, the cells as they are copied, and the curves as they are drawn. Which row and
which curve a sentence is about is known from its words alone.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot

from app.wizard.visit import Visit
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.bench_view import BenchView
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import JointKind, Side
from core.samples import FloatArray
from core.session import RecordingKind
from devices.simulation.fitted_prosthesis import BUILT, SPEED_M_S
from devices.simulation.walker import DEMONSTRATION, PEOPLE, FreeMotion, Standing, Walk
from devices.simulation.walker_prosthesis import ProsthesisSetting
from tests.app.wizard.walking.bench_material import state_of
from tests.simulated import analysis_of, session_of

FITTINGS = 20
IN_EVERY_RUN = 3
OF_SENTENCE = {  # what its words are about: the row of the table
    r"knee flexes .* from stance to swing": "Knee flexion, stance to swing",
    r"knee flexes .* in loading response": "Knee flexion, loading response",
    r"knee has .* range of motion": "Knee range of motion",
    r"ankle dorsiflexes .* in stance": "Ankle dorsiflexion, stance",
    r"ankle plantarflexes .* at push-off": "Ankle plantarflexion, push-off",
    r"ankle has .* range of motion": "Ankle range of motion",
    r": heel rise is ": "Heel rise",
    r": foot angle at contact is ": "Foot angle at contact",
    r": stride length is ": "Stride length, m",
    r": foot flat is ": "Foot flat (% gait cycle)",
    r": shank forward tilt, foot flat is ": "Shank forward tilt, foot flat",
    r": knee extended before contact is ": "Knee extended before contact (% gait cycle)",
    r": least knee flexion, late swing is ": "Least knee flexion, late swing",
    r": foot-to-shank angle, swing is ": "Foot-to-shank angle, swing",
}
NUMBER = re.compile(r"[−+]?\d+(?:\.\d+)?")
ROW = re.compile(r"^(?P<mark>[○●] )?(?P<change>[−+]?[\d.]+)°?(?: ±(?P<error>[\d.]+)°?†?)?$")
WINDOW = 12  # percent around a marked point, within which the other curve has its own


def number(text: str) -> float:
    return float(text.replace("−", "-"))


def decimals(text: str) -> int:
    return len(text.partition(".")[2])


def agree(one: str, other: str) -> bool:
    """Whether two numbers may be one that was rounded twice."""
    apart = 0.5 * (10.0 ** -decimals(one) + 10.0 ** -decimals(other))
    is_same = decimals(one) == decimals(other)
    return abs(number(one) - number(other)) <= (1e-9 if is_same else apart + 1e-9)


@dataclass(frozen=True)
class Shown:
    """The page as it is read: both sentences, the table's rows by name, and the knee's and the ankle's frame."""

    first: str
    then: str
    has_arrows: bool
    rows: dict[str, str]
    frames: tuple[SimpleNamespace, ...]


def drawn_setting(seed: int) -> ProsthesisSetting:
    """A setting as somebody may turn a prosthesis to, in half of all hardly another than it was."""
    draw = np.random.default_rng(seed)
    size = draw.choice([0.05, 0.05, 0.4, 1.0])
    return replace(
        BUILT,
        plantar_deg=size * draw.uniform(-5.0, 5.0),
        back_mm=size * draw.uniform(-10.0, 10.0),
        height_mm=size * draw.uniform(-10.0, 10.0),
        stop_deg=size * draw.uniform(0.0, 6.0),
        swing_flexion_deg=BUILT.swing_flexion_deg + size * draw.uniform(-12.0, 12.0),
    )


@cache
def fitted(seed: int) -> SimpleNamespace:
    """A visit with two alignments, A as it is built and B as drawn, each walked once."""
    side = list(Side)[seed % 2]
    walks: list[Standing | FreeMotion | Walk] = [
        Walk(f"walk {k}", speed_m_s=SPEED_M_S, strides=14, standing_before_s=1.0, prosthesis=setting)
        for k, setting in enumerate((BUILT, drawn_setting(seed)), start=1)
    ]
    first = (Standing(duration_s=4.0), FreeMotion(duration_s=6.0))
    settings = replace(DEMONSTRATION, seed=seed, prosthetic_side=side, variation=PEOPLE, recordings=(*first, *walks))
    session = session_of(settings)
    changed = AlignmentChange("Alignment A", (PartChange(ProsthesisPart.KNEE_UNIT, turns=1.0),))
    reported = {"walk 1": ("Alignment A", None), "walk 2": ("Alignment B", changed)}
    named = tuple(
        replace(one, condition=reported[one.name][0], alignment=reported[one.name][1]) if one.name in reported else one
        for one in session.recordings
    )
    session = replace(session, recordings=named)
    every = [SimpleNamespace(details=one, read_back=None) for one in named]
    return SimpleNamespace(
        prosthetic_sides=frozenset({side}),
        prosthetic_joints=frozenset(kind.of(side) for kind in (JointKind.KNEE, JointKind.ANKLE)),
        recordings=SimpleNamespace(
            every=every, walks=[one for one in every if one.details.kind is RecordingKind.WALKING]
        ),
        evaluation=SimpleNamespace(analysis=analysis_of(session), session=session, is_busy=False, has_failed=False),
    )


def shown(qtbot: QtBot, seed: int) -> Shown:
    bench = Bench(cast(Visit, fitted(seed)))
    view = BenchView(bench.entry)
    qtbot.addWidget(view)
    view.fit(1400)
    view.show_state(state_of(bench))
    view.resize(1400, 620)
    view.show()
    model = view.differences.table.model()
    rows: dict[str, str] = {}
    is_own = True
    for row in range(model.rowCount()):
        name, value = (model.index(row, column).data(Qt.ItemDataRole.DisplayRole) for column in (0, 1))
        is_own = name != "R Sound-side response" and name != "L Sound-side response" and (is_own or not value)
        if value and is_own:
            rows[name] = value
    frames = tuple(SimpleNamespace(curves=f.chart.curves, marks=f.chart.deviations) for f in view.frames)
    return Shown(view.first.text(), view.then.text(), view.is_marked, rows, frames)


def row_of(sentence: str, rows: dict[str, str]) -> str:
    """The name of the row that a sentence is about."""
    if " is similar " in sentence:
        named = sentence.partition(" is similar ")[0].partition(": ")[2]
        return next(name for name in rows if name.lower().startswith(named.lower()))
    return next(name for words, name in OF_SENTENCE.items() if re.search(words, sentence))


def check_sentence_and_table(page: Shown) -> tuple[str, re.Match[str]]:
    """Give the row's name and its figures: the sentence's numbers, its direction and whether it is beyond the error."""
    name = row_of(page.first, page.rows)
    figures = ROW.match(page.rows[name])
    assert figures is not None, page.rows[name]
    change, error = figures["change"], figures["error"]
    is_change = " than with A" in page.first
    sentences = re.split(r"(?<=\.) ", page.then)
    of_error = next(one for one in sentences if one.startswith("Likely between " if is_change else "Difference "))
    assert bool(figures["mark"]) is is_change is page.has_arrows
    if is_change:
        value, size, *others = NUMBER.findall(page.first)
        assert re.search(r"with B, .* (more|less) than with A( \(|\.$)", page.first)
        signed = size if " more than " in page.first else f"−{size}"
        assert number(change) * number(signed) > 0
    else:
        other, value = NUMBER.findall(page.first)
        others = [other]
        (size,) = NUMBER.findall(of_error)[:1]
        signed = f"{number(value) - number(other):.{decimals(value)}f}"
        assert agree(signed.lstrip("-"), size)
    assert agree(change, signed), (change, signed)
    for other in others:  # stated where, rounded, it is as far away as stated
        assert round(number(value) - number(other), decimals(value)) == pytest.approx(number(signed), abs=1e-6)
    assert (abs(number(change)) > number(error)) is is_change or agree(change.lstrip("+−"), error)
    low, high = sorted((number(change) - number(error), number(change) + number(error)), key=abs)
    edges = NUMBER.findall(of_error)[:2] if is_change else NUMBER.findall(of_error)[1:3]
    if not is_change:
        low, high = number(change) - number(error), number(change) + number(error)
    for edge, expected in zip(edges, (low, high), strict=True):
        expected = abs(expected) if is_change else expected
        assert number(edge) == pytest.approx(
            expected, abs=0.5 * 10.0 ** -decimals(edge) + 0.11 * 10.0 ** (1 - decimals(change))
        )
    return name, figures


def extent(curve: FloatArray, marks: tuple[float, float]) -> float:
    """From the least angle around one marked percent to the greatest around the other."""
    low, high = (curve[max(0, round(mark) - WINDOW) : round(mark) + WINDOW + 1] for mark in marks)
    return float(np.max(high) - np.min(low))


def check_curves(page: Shown, name: str) -> None:
    """Each mark is of a row that has one, on the curve of B, and of a movement that A has less, or more, of."""
    marked = {row for row, value in page.rows.items() if value.startswith(("○", "●"))}
    kinds = {kind for kind in ("Knee", "Ankle") if any(row.startswith(kind) for row in marked)}
    drawn = dict(zip(("Knee", "Ankle"), page.frames, strict=True))
    for kind, frame in drawn.items():
        assert [curve.letter for curve in frame.curves] == ["A", "B"]
        if not frame.marks:
            assert not any(row.startswith(kind) and "late swing" not in row and "before" not in row for row in marked)
            continue
        (mark,) = frame.marks
        assert kind in kinds
        value, size = NUMBER.findall(mark.words)[-1], NUMBER.findall(mark.more)[0]
        assert (mark.words[0], mark.more[-1]) == ("B", "A")
        ways = {row: -1 if page.rows[row][2] == "−" else 1 for row in marked if row.startswith(kind)}
        way = 1 if " more than " in mark.more else -1
        own = [row for row in ways if agree(NUMBER.findall(page.rows[row])[0].lstrip("+−"), size) and ways[row] == way]
        assert own, (mark.more, page.rows)
        if name.startswith(kind):
            assert name in own
            assert agree(NUMBER.findall(page.first)[0], value)
        places = mark.first.percent, mark.second.percent
        curve_of = {curve.letter: curve.angle_deg for curve in frame.curves}
        for point in (mark.first, mark.second):
            assert curve_of["B"][round(point.percent)] == pytest.approx(point.angle_deg, abs=1e-6)
        drawn_change = extent(curve_of["B"], places) - extent(curve_of["A"], places)
        assert drawn_change * way > 0
        assert abs(drawn_change) == pytest.approx(number(size), abs=2.0)
        assert mark.second.angle_deg - mark.first.angle_deg == pytest.approx(number(value), abs=2.0)


def check(page: Shown) -> None:
    name, _ = check_sentence_and_table(page)
    check_curves(page, name)


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(seed, marks=[] if seed < IN_EVERY_RUN else [pytest.mark.endurance], id=f"fitting {seed + 1}")
        for seed in range(FITTINGS)
    ],
)
def test_sentence_table_and_curves_agree(qtbot: QtBot, seed: int) -> None:
    page = shown(qtbot, seed)
    check(page)


@pytest.mark.endurance
def test_the_fittings_drawn_are_of_both_kinds(qtbot: QtBot) -> None:
    pages = [shown(qtbot, seed) for seed in range(FITTINGS)]
    changed = [page for page in pages if page.has_arrows]
    assert 3 <= len(changed) <= FITTINGS - 3
    assert {bool(frame.marks) for page in changed for frame in page.frames} == {True, False}


@pytest.mark.parametrize(
    "altered",
    [
        lambda page: replace(page, first=page.first.replace(" more than ", " less than ")),
        lambda page: replace(page, first=re.sub(r"(\d+\.\d+)°? more", lambda m: m[0].replace(m[1], "1.0"), page.first)),
        lambda page: replace(page, has_arrows=not page.has_arrows),
        lambda page: replace(page, rows={name: value.replace("○ ", "") for name, value in page.rows.items()}),
        lambda page: replace(page, rows={name: value.replace("+", "−") for name, value in page.rows.items()}),
        lambda page: replace(page, frames=tuple(SimpleNamespace(curves=f.curves, marks=()) for f in page.frames)),
        lambda page: replace(
            page, frames=tuple(SimpleNamespace(curves=f.curves[::-1], marks=f.marks) for f in page.frames)
        ),
    ],
)
def test_the_check_finds_what_does_not_agree(qtbot: QtBot, altered: Callable[[Shown], Shown]) -> None:
    page = next(page for seed in range(IN_EVERY_RUN) if " more than " in (page := shown(qtbot, seed)).first)
    check(page)
    with pytest.raises((AssertionError, StopIteration)):
        check(altered(page))

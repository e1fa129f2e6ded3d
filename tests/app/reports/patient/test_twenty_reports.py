"""Every report that the script makes is whole, and what its sentences say is in a file; strangers are the script's."""

import os

import pytest

from tests.app.wizard.report.test_page import png
from tests.safety.twenty_reports import contradictions, ink_heights, sessions, tried, unknown_numbers

pytestmark = pytest.mark.endurance


def test_reports_are_whole_and_their_sentences_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(os.environ, "GAITWRIGHT_TEST_DATA", raising=False)
    trials = {name: tried(name, request) for name, request in sessions()}
    assert len(trials) >= 17
    assert min(trial.count["sentences"] for trial in trials.values()) >= 2
    assert {name: trial.faults for name, trial in trials.items() if trial.faults} == {}


def test_a_number_that_no_file_holds_is_found() -> None:
    stated = "The knee bends 20.3° less: 41.7° vs 62.0°, on 23 November 2026."
    assert unknown_numbers(stated, {20.31, 41.68, 62.04}) == []
    assert unknown_numbers(stated, {20.31, 41.68}) == ["62.0"]
    assert unknown_numbers("Sie gehen 1,2 Meter.", {1.18}) == []
    assert unknown_numbers("Sie gehen 1,2 Meter.", {1.3}) == ["1,2"]


def test_an_empty_page_is_found() -> None:
    assert ink_heights([png(40)]) == [0.0]


def test_two_figures_for_one_measure_are_found() -> None:
    def page(tile: str) -> dict[str, object]:
        return {
            "summary": {"first": "Left knee flexes 53° from stance to swing, up 18° since 1 July."},
            "tiles": [{"name": "Knee, stance to swing", "values": [{"text": tile, "chip": {"alt": "left"}}]}],
            "table": {"rows": [{"name": "Knee flexion, stance to swing", "values": ["52.6°", "57.3°"]}]},
        }

    assert list(contradictions(page("53°"))) == []
    assert list(contradictions(page("54°"))) == ["Knee flexion, stance to swing, L: 53 and 54"]

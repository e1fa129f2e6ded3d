"""Tests that lost samples are stated with their counts, and that nothing is where all is well."""

from dataclasses import replace

import pytest
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.wizard.walk_messages import lossy_message
from app.wizard.walking.page import WalkingPage
from app.wizard.walking.received_card import MOST_ROWS, ReceivedCard, ReceivedRow
from app.wizard.walking.walk_list import WalkRow, WalkState
from app.wording.received import received_clause
from core.body import LEG_SITES, Site
from core.signal.received import SamplesReceived
from tests.app.wizard.walking.test_page import one_page, page

__all__ = ["one_page", "page"]

WELL = SamplesReceived(1800, 1800, 0.0)
LOSSY = SamplesReceived(1811, 1511, 3.01)
WALK = WalkRow("1", "A", "barefoot", WalkState.KEPT)


def test_samples_that_were_lost_are_stated_after_and_while_it_happens(snapshot: SnapshotAssertion) -> None:
    left, right, shank = Site.LEFT_FOOT, Site.RIGHT_FOOT, Site.RIGHT_SHANK
    nearly, scattered = SamplesReceived(1000, 996, 0.0), replace(LOSSY, longest_gap_s=0.0)
    assert {
        "all came": received_clause({left: WELL, right: WELL}),
        "nearly all came": received_clause({left: WELL, right: nearly}),
        "no sensors": received_clause({}),
        "sensors that lost samples are named": received_clause({left: WELL, right: LOSSY, shank: LOSSY}),
        "meanwhile": lossy_message({left: WELL, right: scattered}),
        "meanwhile all came": lossy_message({left: WELL}),
        "meanwhile nearly all came": lossy_message({left: SamplesReceived(1000, 995, 0.0)}),
        "meanwhile no sensors": lossy_message({}),
    } == snapshot


def test_the_table_has_expected_received_and_the_longest_gap(qtbot: QtBot) -> None:
    card = ReceivedCard()
    qtbot.addWidget(card)
    card.show_rows([ReceivedRow("A barefoot", Site.RIGHT_FOOT, LOSSY)])
    (row,) = card.table.cells.rows
    assert [cell.words for cell in row.cells] == ["A barefoot", "R foot", "1811", "1511", "16.6 %", "3.01 s"]
    card.show_rows([ReceivedRow("A barefoot", Site.RIGHT_FOOT, SamplesReceived(1000, 900, 0.0))])
    assert card.table.cells.rows[0].cells[-1].words == "under 0.05 s"
    card.show_rows([ReceivedRow("A barefoot", Site.RIGHT_FOOT, LOSSY)])
    assert "R foot 1811 1511 16.6 % 3.01 s" in card.accessibleName()


def test_the_worst_of_many_are_shown_in_their_order(qtbot: QtBot) -> None:
    card = ReceivedCard()
    qtbot.addWidget(card)
    rows = [
        ReceivedRow(f"walk {walk}", site, SamplesReceived(1000, 950 - 10 * walk, 0.1))
        for walk in (1, 2)
        for site in LEG_SITES
    ]
    card.show_rows(rows)
    assert [row.cells[0].words for row in card.table.cells.rows] == ["walk 2"] * MOST_ROWS


@pytest.mark.parametrize("state", [WalkState.KEPT, WalkState.ASKING])
def test_the_card_is_there_between_walks_and_only_where_samples_were_lost(page: WalkingPage, state: WalkState) -> None:
    page.show_walks((replace(WALK, state=state),))
    page.show_received([])
    assert page.received.isHidden()
    page.show_received([ReceivedRow("A barefoot", Site.RIGHT_FOOT, LOSSY)])
    assert not page.received.isHidden()
    page.show_walks((replace(WALK, state=WalkState.RECORDING),))
    assert page.received.isHidden()
    page.show_walks((WALK,))
    page.show_received([])
    assert page.received.isHidden()

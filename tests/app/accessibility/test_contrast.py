"""Contrast by WCAG 2.2 AA: 4.5 for text, 3 for edges of controls, icons, focus, curves and what cannot be used.

The pairs are those that the application paints. What lies under a token is read off the code that paints it; a token
that no pair names must be named with its reason in `FREE`.
"""

from dataclasses import fields, replace

import pytest
from PySide6.QtGui import QColor

from app.theme.colours import DARK, LIGHT, PAPER, Colours
from app.theme.theme import Theme
from core.body import Side
from tests.app.accessibility.contrast import contrast, over

TEXT, GRAPHIC = 4.5, 3.0  # success criteria 1.4.3 and 1.4.11
SCHEMES = {"light": LIGHT, "dark": DARK}
PAGES = ("ground", "surface", "sunken")
# text, and the grounds it is on
TEXTS: dict[str, tuple[str, ...]] = {
    "ink": (*PAGES, "track", "left_pale", "right_pale", "left_soft", "right_soft", "band_1sd", "band_2sd"),
    "ink2": (*PAGES, "track", "band_2sd"),
    "ink3": PAGES,
    "inv_ink": ("inv",),
    "inv_ink2": ("inv",),
    "inv": ("inv_ink",),  # the filled button on the bar of a recording
    "caution_ink": ("caution",),
    "caution_mark_ink": ("caution_mark",),
    "left_text": PAGES,  # letters, and figures of a leg
    "right_text": PAGES,
    "ground": (),
}
# edges, icons, focus and curves, and what lies beside them
GRAPHICS: dict[str, tuple[str, ...]] = {
    "ink": (*PAGES, "track", "left_pale", "right_pale"),  # icons, what is chosen, the ring of the focus, a cursor
    "inv": PAGES,  # a filled button
    "inv_ink": ("inv",),  # the ring of the focus on the bar of a recording
    "inv_ink2": ("inv",),  # the edge of a button there
    "control": (*PAGES, "left_pale", "right_pale", "band_2sd"),  # edges of controls, scroll bars, axes
    "caution_edge": ("surface", "ground", "caution"),
    "caution_ink": ("caution",),  # icons
    "caution_mark_ink": ("caution_mark",),
    "left": ("surface", "ground", "left_pale", "right_pale", "track", "band_2sd"),
    "right": ("surface", "ground", "left_pale", "right_pale", "track", "band_2sd"),
    "left_text": PAGES,  # the frame of the leg's letter
    "right_text": PAGES,
    # WCAG leaves out what cannot be used; its words are to be read all the same
    "disabled": (*PAGES, "track", "inv", "caution"),
}
FREE = {
    "line": "hairlines between rows and round cards: no control is known by them alone",
    "band_1sd": "the reference group: every figure of it stands in a table, and a curve over it wears a casing",
    "band_2sd": "likewise, and the zone of measurement error, which filled and hollow marks tell as well",
    "left_soft": "a fill that an edge of 3 or the next phase bounds",
    "right_soft": "likewise",
}


def pairs(required: dict[str, tuple[str, ...]]) -> list[tuple[str, str]]:
    return [(one, ground) for one, grounds in required.items() for ground in grounds]


def too_faint(colours: Colours, required: dict[str, tuple[str, ...]], least: float) -> list[str]:
    found = [(*pair, contrast(*(getattr(colours, name) for name in pair))) for pair in pairs(required)]
    return [f"{one} on {ground}: {ratio:.2f}" for one, ground, ratio in found if ratio < least]


def test_the_ratio_is_that_of_the_definition() -> None:
    assert contrast("#000000", "#FFFFFF") == pytest.approx(21.0)
    assert contrast("#777777", "#FFFFFF") == pytest.approx(4.48, abs=0.005)
    assert contrast("#767676", "#FFFFFF") == pytest.approx(4.54, abs=0.005)
    assert over("#000000", "#FFFFFF", 0.5) == "#808080"


@pytest.mark.parametrize("scheme", SCHEMES)
def test_text_is_read_on_every_ground_it_is_on(scheme: str) -> None:
    assert too_faint(SCHEMES[scheme], TEXTS, TEXT) == []


@pytest.mark.parametrize("scheme", SCHEMES)
def test_edges_icons_focus_and_curves_are_seen_on_what_lies_beside_them(scheme: str) -> None:
    assert too_faint(SCHEMES[scheme], GRAPHICS, GRAPHIC) == []


def test_a_pair_that_is_too_faint_is_named() -> None:
    """The edge of a caution as it was before."""
    assert too_faint(replace(LIGHT, caution_edge="#B58A00"), GRAPHICS, GRAPHIC) == [
        "caution_edge on ground: 2.94",
        "caution_edge on caution: 2.81",
    ]
    assert too_faint(replace(DARK, ink3="#6A7883"), TEXTS, TEXT) != []
    assert "disabled on track: 2.07" in too_faint(replace(LIGHT, disabled="#9AA6B1"), GRAPHICS, GRAPHIC)


def test_every_colour_has_a_pair_or_a_reason() -> None:
    named = {name for required in (TEXTS, GRAPHICS) for one, grounds in required.items() for name in (one, *grounds)}
    assert {one.name for one in fields(Colours)} - named - set(FREE) == set()


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("side", Side)
def test_a_curve_is_seen_on_the_band_of_its_own_and_of_the_other_leg(scheme: str, side: Side) -> None:
    theme = Theme(SCHEMES[scheme])
    for of_band in Side:
        band = theme.band(of_band)
        ground = over(QColor(band).name(), theme.colours.surface, band.alphaF())
        assert contrast(theme.curve(side).name(), ground) >= GRAPHIC


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_word_under_the_mouse_is_read_too(scheme: str) -> None:
    theme = Theme(SCHEMES[scheme])
    veil = theme.veil(is_pressed=True)
    for ground in PAGES:
        under = over(veil.name(), getattr(theme.colours, ground), veil.alphaF())
        assert contrast(theme.colours.ink2, under) >= TEXT


def test_the_report_is_read_on_paper() -> None:
    assert min(contrast(one, PAPER.paper) for one in (PAPER.ink, PAPER.note)) >= TEXT
    seen = (PAPER.left, PAPER.right, PAPER.band_1sd_edge, PAPER.band_mean)
    assert min(contrast(one, PAPER.paper) for one in seen) >= GRAPHIC

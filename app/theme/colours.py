"""Frozen colour tokens of both schemes, usable without a screen; no other file names a colour."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Colours:
    """The tokens of one scheme. `left_*` and `right_*` belong to the legs, `caution_*` to what needs a look,
    `band_*` to the reference group."""

    ground: str
    surface: str
    sunken: str
    track: str
    line: str
    control: str
    ink: str
    ink2: str
    ink3: str
    inv: str
    inv_ink: str
    inv_ink2: str
    caution: str
    caution_ink: str
    caution_edge: str
    caution_mark: str
    caution_mark_ink: str
    left: str
    left_text: str
    left_pale: str
    left_soft: str
    right: str
    right_text: str
    right_pale: str
    right_soft: str
    band_1sd: str
    band_2sd: str
    disabled: str


LIGHT = Colours(
    ground="#F4F6F8",
    surface="#FFFFFF",
    sunken="#E7EBEF",
    track="#E7EBEF",
    line="#D5DCE2",
    control="#74828F",
    ink="#14202B",
    ink2="#43525F",
    ink3="#586775",
    inv="#14202B",
    inv_ink="#FFFFFF",
    inv_ink2="#BCC7D0",
    caution="#FFF1B8",
    caution_ink="#14202B",
    caution_edge="#AE8400",
    caution_mark="#F5C400",
    caution_mark_ink="#14202B",
    left="#D55E00",
    left_text="#A94A00",
    left_pale="#FCEBDF",
    left_soft="#F3BF9B",
    right="#0072B2",
    right_text="#00629A",
    right_pale="#E0EEF7",
    right_soft="#A3CCE5",
    band_1sd="#C3CBD3",
    band_2sd="#E3E8EC",
    disabled="#7B8792",
)

DARK = Colours(
    ground="#10161B",
    surface="#192128",
    sunken="#0B1014",
    track="#2C3741",
    line="#303B45",
    control="#7A8996",
    ink="#EDF1F4",
    ink2="#B7C2CC",
    ink3="#93A1AD",
    inv="#EDF1F4",
    inv_ink="#10161B",
    inv_ink2="#43525F",
    caution="#3B3206",
    caution_ink="#FBF6DF",
    caution_edge="#E2C340",
    caution_mark="#F5D442",
    caution_mark_ink="#14202B",
    left="#F07A2B",
    left_text="#FF9A57",
    left_pale="#3A2415",
    left_soft="#7A431C",
    right="#3B9EDE",
    right_text="#67B6EC",
    right_pale="#11293A",
    right_soft="#1D5275",
    band_1sd="#414D58",
    band_2sd="#29333C",
    disabled="#738290",
)


@dataclass(frozen=True, slots=True)
class PaperColours:
    """What the report is printed in: the band's edges survive a photocopier, its fills alone do not."""

    ink: str
    paper: str
    note: str
    grid: str
    band_1sd: str
    band_1sd_edge: str
    band_2sd: str
    band_2sd_edge: str
    band_mean: str
    left: str
    right: str
    left_soft: str
    earlier: str
    track: str
    way: str


PAPER = PaperColours(
    ink="#000000",
    paper="#FFFFFF",
    note="#4A4A4A",
    grid="#B8B8B8",
    band_1sd="#CECECE",
    band_1sd_edge="#8C8C8C",
    band_2sd="#EAEAEA",
    band_2sd_edge="#B4B4B4",
    band_mean="#6E6E6E",
    left=LIGHT.left,
    right=LIGHT.right,
    left_soft="#F3BE9B",
    earlier="#EEF2F5",
    track="#E6EAED",
    way="#C9D1D8",
)

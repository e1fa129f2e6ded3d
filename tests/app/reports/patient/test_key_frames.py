"""Key frames in the report: the pictures as they were taken, where they were asked for, and what is beneath them."""

import io
import re
from dataclasses import replace

import pikepdf
import pypdf
import pytest

from app.reports.patient.document import make_report, report_data
from app.reports.patient.key_frames_page import key_frames_page
from app.summary.request import ReportRequest
from core.body import Side
from core.video.key_frames import KeyFrame, KeyMoment
from tests.app.drawn_clips import plain_clip

PERCENTS = (0.0, 30.4, 60.8, 80.4)


def frames(*sides: Side) -> tuple[KeyFrame, ...]:
    """Every picture is another."""
    jpegs = plain_clip()
    return tuple(
        KeyFrame(jpegs.pictures.jpeg(4 * k + n + 1), 320, 180, moment, side, PERCENTS[n], 20.4 + n, -5.0)
        for k, side in enumerate(sides)
        for n, moment in enumerate(KeyMoment)
    )


def pictures_in(pdf: bytes) -> list[bytes]:
    with pikepdf.open(io.BytesIO(pdf)) as document:
        return [
            bytes(one.read_raw_bytes())
            for one in document.objects
            if isinstance(one, pikepdf.Stream) and str(one.get("/Filter")) == "/DCTDecode"
        ]


def words(pdf: bytes) -> str:
    pages = [page.extract_text() for page in pypdf.PdfReader(io.BytesIO(pdf)).pages]
    return re.sub(r"\s+", " ", " ".join(pages))


def test_each_picture_is_in_the_report_as_it_was_taken_and_described(demo: ReportRequest) -> None:
    shown = frames(*Side)
    pdf = make_report(replace(demo, key_frames=shown))
    assert sorted(pictures_in(pdf)) == sorted(one.jpeg for one in shown)
    found = words(pdf)
    for part in ("Key frames of the video", "Mid-stance", "30 %", "knee 20°, ankle −5°", "Faces can be recognised."):
        assert part in found
    assert pdf == make_report(replace(demo, key_frames=shown))


def test_without_being_asked_for_there_is_none(demo_report: bytes) -> None:
    assert pictures_in(demo_report) == []
    assert "Key frames" not in words(demo_report)
    assert "Faces" not in words(demo_report)


def test_one_leg_has_one_row_and_an_angle_that_is_not_reported_has_no_figure() -> None:
    assert key_frames_page(()) == []
    shown = tuple(replace(one, knee_deg=None, ankle_deg=None) for one in frames(Side.RIGHT))
    page = key_frames_page(shown)
    assert [block["said"] for block in page if block["kind"] == "heading"] == ["Key frames of the video", "Right"]
    (row,) = [block["pictures"] for block in page if block["kind"] == "figures"]
    assert isinstance(row, list)
    assert row[0]["alt"] == "Video, right leg, Initial contact: not reported."
    assert not any("°" in one["svg"].partition(">")[2].partition("base64")[0] for one in row)


@pytest.mark.endurance
def test_the_pages_are_the_same_length_with_pictures_of_any_shape(demo: ReportRequest, demo_report: bytes) -> None:
    """An upright clip: eight high pictures take a page and no more."""
    upright = tuple(replace(one, width=180, height=320) for one in frames(*Side))
    reports = (demo_report, make_report(replace(demo, key_frames=upright)))
    plain, with_them = (len(pypdf.PdfReader(io.BytesIO(one)).pages) for one in reports)
    assert with_them == plain + 1


def test_the_page_of_the_method_stays_where_the_preview_expects_it(demo: ReportRequest) -> None:
    data = report_data(replace(demo, key_frames=frames(Side.LEFT)))
    before = report_data(demo)
    assert data["pages"][data["pages_of_walk"]] == before["pages"][before["pages_of_walk"]]

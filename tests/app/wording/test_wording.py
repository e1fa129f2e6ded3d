"""Each finding has its sentence, and the sentences keep the rules of the house."""

import ast
import math
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from string import Formatter

import pytest

from app.wording.body import name_of
from app.wording.findings import NAMES, SENTENCES, place, sentence
from core.body import LEG_JOINTS, LEG_SITES, Side
from core.findings import Finding, Severity
from core.gait.strides import Reason
from core.parameters import ANKLE_WINDOWS, KNEE_WINDOWS

ROOT = Path(__file__).parents[3]
FORBIDDEN = re.compile(r"\b(errors?|fail(s|ed|ure)?|invalid|please|disconnected|wrong sensor|you)\b|!", re.IGNORECASE)
SAMPLES = {"name": "battery_percent", "kind": "averaged", "joint": "left ankle"}


def sample(key: str, where: str = "walk 1, left_knee") -> Finding:
    fields = [field for _, field, _, _ in Formatter().parse(SENTENCES[key]) if field]
    return Finding(key, Severity.WARNING, where, {field: SAMPLES.get(field, 12) for field in fields})


@pytest.mark.parametrize("key", SENTENCES)
def test_a_sentence_states_where_and_carries_its_numbers(key: str) -> None:
    finding = sample(key)
    text = sentence(finding)
    assert text.startswith("Left knee, walk 1: ")
    clause = text.removeprefix("Left knee, walk 1: ")
    assert clause[0] == clause[0].upper()  # a whole sentence, with a subject of its own
    assert "{" not in text
    for number in finding.numbers.values():
        assert str(number) in text


@pytest.mark.parametrize("key", SENTENCES)
def test_a_sentence_is_at_most_two_and_blames_nobody(key: str) -> None:
    text = sentence(sample(key, where=""))
    assert text[0] == text[0].upper()
    assert text.endswith(".")
    assert len(re.findall(r"[.?](?=\s|$)", text)) <= 2
    assert FORBIDDEN.search(text) is None


@pytest.mark.parametrize("key", SENTENCES)
def test_a_figure_in_a_sentence_is_followed_by_its_unit(key: str) -> None:
    units = {"_percent": " %", "_s": " s", "_ms": " ms", "_deg": "°", "_rad_s": " rad/s", "_m_s2": " m/s²"}
    pieces = list(Formatter().parse(SENTENCES[key]))
    for (_, field, _, _), (after, _, _, _) in zip(pieces, [*pieces[1:], ("", None, None, None)], strict=True):
        for ending in sorted(units, key=len, reverse=True):
            if field and field.endswith(ending):
                assert after.startswith(units[ending])
                break


def keys_used() -> Iterator[tuple[str, str]]:
    """Find every text that is before a severity, as findings and what becomes one are written."""
    for package in ("core", "devices", "app"):
        for file in (ROOT / package).rglob("*.py"):
            text = file.read_text(encoding="utf-8")
            if "severity" not in text.lower():  # looked for first: taking a file apart takes long
                continue
            for node in ast.walk(ast.parse(text)):
                parts = node.args if isinstance(node, ast.Call) else node.elts if isinstance(node, ast.Tuple) else []
                if len(parts) > 1 and "severity" in ast.unparse(parts[1]).lower():
                    looked_up = {id(part.slice) for part in ast.walk(parts[0]) if isinstance(part, ast.Subscript)}
                    for part in ast.walk(parts[0]):
                        if isinstance(part, ast.Constant) and isinstance(part.value, str) and id(part) not in looked_up:
                            yield part.value, file.name


def test_every_finding_in_the_code_has_a_sentence() -> None:
    used = list(keys_used())
    assert len(used) > 30
    assert [(key, file) for key, file in used if key not in SENTENCES] == []


def test_what_concerns_the_whole_session_names_no_place() -> None:
    assert sentence(Finding("simulated", Severity.INFO, "session")).startswith("These data are simulated.")


def test_a_joint_among_the_numbers_is_put_into_words() -> None:
    reported = sentence(Finding("missing_site", Severity.INFO, "left_foot", {"joint": "left_ankle"}))
    assert reported == "L foot: No sensor was worn here. There are no left ankle angles."


def test_a_finding_without_a_sentence_is_still_reported_with_its_figures() -> None:
    reported = sentence(Finding("strap_slipped", Severity.GRAVE, "right_shank", {"at_s": 41.0}))
    assert reported == "R shank: strap slipped at_s 41.0."


def test_a_sentence_that_lacks_its_figure_is_reported_by_its_key() -> None:
    assert sentence(Finding("gaps", Severity.INFO, "", {"count": 2})) == "Gaps count 2."
    assert sentence(Finding("clipped", Severity.INFO, "", {"percent": "many"})) == "Clipped percent many."
    assert sentence(Finding("clipped", Severity.INFO, "", {"percent": math.nan})) == "Clipped."


def test_the_part_of_the_body_comes_before_the_recording() -> None:
    assert place("walk 1, left_thigh") == "L thigh, walk 1"
    assert place("left_thigh, left_shank, right_foot, walk 1") == "L thigh, L shank and R foot, walk 1"
    assert place("") == ""


def test_every_part_is_named_side_first() -> None:
    for site in LEG_SITES:
        assert name_of(site) == f"{site.leg_side[0].upper()} {site.segment}"
    for joint in LEG_JOINTS:
        assert name_of(joint) == joint.value.replace("_", " ")


def test_wording_needs_no_screen() -> None:
    program = "import sys, app.wording.translation; sys.exit(any(name.startswith('PySide6') for name in sys.modules))"
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False).returncode == 0


def test_every_reason_and_every_peak_has_its_words() -> None:
    assert set(NAMES["reason"]) == {str(reason) for reason in Reason if reason is not Reason.USED}
    assert set(NAMES["peak"]) == {window.name for window in (*KNEE_WINDOWS, *ANKLE_WINDOWS)}
    assert set(NAMES["side"]) == set(Side)


def test_a_column_that_is_named_as_a_reason_keeps_its_name() -> None:
    assert "“stop”" in sentence(Finding("unknown_column", Severity.INFO, "", {"name": "stop"}))


@pytest.mark.parametrize(
    ("key", "numbers", "stated"),
    [
        (
            "no_spread",
            {"left": 4, "right": 9, "wanted": 10},
            "Walk 1: There are only 4 left and 9 right strides; a standard deviation needs 10. "
            "Record another walk, or continue without a standard deviation.",
        ),
        (
            "strides_all_left_out",
            {"count": 11, "stop": 3, "turn": 8},
            "Walk 1: All detected strides (11) were excluded: 8 turning, 3 stopping. "
            "There are no averages; correct this and record the walk again.",
        ),
        (
            "no_peak",
            {"peak": "ankle_push_off_plantarflexion"},
            "Walk 1: No value for peak plantarflexion, push-off is reported: "
            "the angle has no turning point in that phase.",
        ),
    ],
)
def test_what_a_walk_lacks_is_stated_in_words(key: str, numbers: dict[str, int | str], stated: str) -> None:
    assert sentence(Finding(key, Severity.INFO, "walk 1", numbers)) == stated

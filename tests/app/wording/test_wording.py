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
from syrupy.assertion import SnapshotAssertion

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


def test_a_finding_is_stated_with_its_figures_whatever_they_are(snapshot: SnapshotAssertion) -> None:
    at_s, strides = {"at_s": 41.0}, {"left": 4, "right": 9, "wanted": 10}
    info, walk = Severity.INFO, "walk 1"
    findings = {
        "a joint among the numbers": Finding("missing_site", info, "left_foot", {"joint": "left_ankle"}),
        "no sentence: its key and its figures": Finding("strap_slipped", Severity.GRAVE, "right_shank", at_s),
        "a figure is missing": Finding("gaps", info, "", {"count": 2}),
        "a figure is none": Finding("clipped", info, "", {"percent": "many"}),
        "a figure is unknown": Finding("clipped", info, "", {"percent": math.nan}),
        "a column that is named as a reason": Finding("unknown_column", info, "", {"name": "stop"}),
        "too few strides for a spread": Finding("no_spread", info, walk, strides),
        "no stride is used": Finding("strides_all_left_out", info, walk, {"count": 11, "stop": 3, "turn": 8}),
        "no peak": Finding("no_peak", info, walk, {"peak": "ankle_push_off_plantarflexion"}),
    }
    assert {case: sentence(finding) for case, finding in findings.items()} == snapshot


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

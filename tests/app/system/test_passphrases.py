"""How long a passphrase holds: what is tried first is refused and reported why, and times are on the cautious side."""

import subprocess
import sys

import pytest

from app.system.passphrases import Strength, held_for_s, refusal_of_passphrase, strength_in_words, strength_of

SHORTEST = 10


@pytest.mark.parametrize(
    ("passphrase", "expected"),
    [
        ("", Strength.NONE),
        ("short", Strength.TOO_SHORT),
        ("aaaaaaaaaa", Strength.WEAK),
        ("1234567890", Strength.WEAK),
        ("Passwort2024", Strength.WEAK),
        ("aaaaaaaaaaaaaaaaaaaa", Strength.WEAK),
        ("12345678901234567890", Strength.WEAK),
        ("secret secret secret secret", Strength.WEAK),
        ("Tr0ub4dor&3", Strength.WEAK),
        ("a" * 500, Strength.WEAK),
        ("x9f2kq7zt4mw", Strength.FAIR),
        ("lamp river onion seventeen cloud", Strength.STRONG),
        ("Qk7#vT!m2Zx@9pLw4Rb$", Strength.STRONG),
    ],
)
def test_passphrases_are_judged_by_how_long_they_hold(passphrase: str, expected: Strength) -> None:
    assert strength_of(passphrase, SHORTEST) is expected


@pytest.mark.parametrize(
    ("passphrase", "why"),
    [
        ("aaaaaaaaaa", "contains repeats"),
        ("1234567890", "a common password"),
        ("Passwort2024", "a common password"),
        ("hijklmnopqrstu", "letters or digits in sequence"),
        ("zse45rdxcvgy7", "side by side"),
        ("24.12.1968", "a date or a year"),
        ("q9x vv zt b", "The passphrase is too short for the characters it uses"),
    ],
)
def test_a_refusal_states_why_and_what_to_do(passphrase: str, why: str) -> None:
    what, remedy = refusal_of_passphrase(passphrase, SHORTEST)
    assert why in what
    assert "could guess it within" in what
    assert remedy.startswith("Use four or five unrelated words")
    assert strength_in_words(passphrase, SHORTEST) == f"{what}. {remedy}."


def test_a_long_random_phrase_is_reported_no_fault() -> None:
    stated = strength_in_words("lamp river onion seventeen cloud", SHORTEST)
    assert stated == "Strong: guessing this passphrase would take longer than anyone would wait."


def test_what_anybody_knows_of_an_operator_is_worth_little() -> None:
    known = ("ehk", "Enrica Hürlimann-Kägi", "Gehlabor Wollishofen")
    for passphrase in ("Hürlimann-Wollishofen", "gehlabor enrica"):
        assert strength_of(passphrase, SHORTEST) is not Strength.WEAK
        assert strength_of(passphrase, SHORTEST, known) is Strength.WEAK
        assert "contains a name or code: yours" in strength_in_words(passphrase, SHORTEST, known)
    assert strength_of("lamp river onion seventeen cloud", SHORTEST, known) is Strength.STRONG


def test_what_is_too_short_is_reported_so() -> None:
    assert "At least 10 characters" in strength_in_words("short", SHORTEST)
    assert held_for_s("") == 0.0


def test_the_lists_of_words_are_loaded_by_the_first_passphrase_only() -> None:
    loaded = "print('zxcvbn' in sys.modules)"
    code = f"import sys, app.system.passphrases as p; {loaded}; p.strength_in_words('', 10); {loaded}"
    code += f"; p.strength_in_words('lamp river onion', 10); {loaded}"
    ran = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert ran.stdout.split() == ["False", "False", "True"]

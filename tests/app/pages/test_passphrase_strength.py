"""How long a passphrase holds: what repeats is worth nothing, and words say times that are on the cautious side."""

import pytest

from app.pages.passphrase_strength import Strength, bits_of, held_for_s, strength_in_words, strength_of

SHORTEST = 10


@pytest.mark.parametrize(
    ("passphrase", "expected"),
    [
        ("", Strength.NONE),
        ("short", Strength.TOO_SHORT),
        ("aaaaaaaaaaaaaaaaaaaa", Strength.WEAK),
        ("12345678901234567890", Strength.WEAK),
        ("secret secret secret secret", Strength.WEAK),
        ("Tr0ub4dor&3", Strength.WEAK),
        ("four short words here", Strength.FAIR),
        ("lamp river onion seventeen cloud", Strength.STRONG),
    ],
)
def test_passphrases_are_judged_by_how_long_they_hold(passphrase: str, expected: Strength) -> None:
    assert strength_of(passphrase, SHORTEST) is expected


def test_the_bits_are_those_of_the_table() -> None:
    """NIST SP 800-63-1, table A.1, passwords chosen by users, 94 letters, no checks: 1, 8, 20 and 30 letters."""
    letters = "hqbwzkdtxmvlyrngcpfsjaeoiuhqbw"
    assert [bits_of(letters[:count]) for count in (1, 8, 20, 30)] == [4, 18, 36, 46]


def test_longer_is_never_weaker() -> None:
    letters = "lamp river onion seventeen cloud"
    held = [held_for_s(letters[:count]) for count in range(1, len(letters))]
    assert held == sorted(held)


def test_what_is_accepted_is_told_in_times() -> None:
    assert "10 letters" in strength_in_words("short", SHORTEST)
    assert "minutes" in strength_in_words("aaaaaaaaaaaaaaaaaaaa", SHORTEST)
    assert strength_in_words("lamp river onion seventeen cloud", SHORTEST).startswith("Strong")

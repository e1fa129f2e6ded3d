"""The confirmation of a clinical comment: who confirmed which words. Other words are not confirmed by it."""

import json


def confirmation(comment: str, by: str) -> str:
    """Give what is kept when `by` confirms these words; empty where there are none."""
    return json.dumps({"by": by, "words": comment}, ensure_ascii=False) if comment.strip() else ""


def is_confirmed(comment: str, confirmed: str) -> bool:
    """Whether these very words were confirmed."""
    return bool(comment.strip() and confirmed) and json.loads(confirmed).get("words") == comment


def confirmed_by(confirmed: str) -> str:
    """Give who confirmed; empty where nobody did, or nobody was logged in."""
    return str(json.loads(confirmed).get("by", "")) if confirmed else ""

"""How much two sensors may disagree about what their joint feels before they are not of one joint."""

# Two sensors with no joint between them: what they disagree on, and the margin, are both poor. Neighbours on people
# (stroke_treadmill, full_body_free_motion, a walk overground: 20 joints) disagree on 0.13 at most with margins of 5.7
# and more; strangers made of them (32) on 0.18 and more, with margins of 3.3 at most. Simulated sensors two segments
# apart look like adjacent segments where the joint between hardly moves: 0.2 and margins up to 14.
DOUBTFUL_DISAGREEMENT, DOUBTFUL_MARGIN = 0.2, 3.1
MAX_DISAGREEMENT, STRANGERS_MARGIN = 0.33, 8.0


def most_disagreement(margin: float | None) -> float | None:
    """Give the share of acceleration that one joint's fit may leave at a sign margin, 0 to 1; None: no limit."""
    if margin is None or margin < DOUBTFUL_MARGIN:
        return DOUBTFUL_DISAGREEMENT
    return MAX_DISAGREEMENT if margin < STRANGERS_MARGIN else None

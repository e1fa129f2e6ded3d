"""From a patient to walks: the steps of one session, what they share, and the frame round them."""

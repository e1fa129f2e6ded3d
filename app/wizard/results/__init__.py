"""What came of the walks: the step; its pages are shared with Home and stand in `app/results`."""

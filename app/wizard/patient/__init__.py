"""Who is examined: the page, what joins it to the visit."""

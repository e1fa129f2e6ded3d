"""Walks are recorded: page, cards and live charts, step, words, and what is computed of a walk."""

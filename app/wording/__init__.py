"""All sentences: translation, names of measures, verdicts, dates."""

"""Before and around a session: who logs in, whose sessions there are, what comes in from elsewhere, what is set."""

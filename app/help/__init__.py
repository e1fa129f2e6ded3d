"""The manual inside the window: its topics, the reader and its page. The text is in `resources/help`."""

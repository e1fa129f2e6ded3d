"""The computer the application runs on: folders, settings, logs, sound, passphrases, tables of text."""

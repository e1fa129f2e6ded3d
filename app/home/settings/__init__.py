"""Settings: users, clinic, backups, error reports."""

"""Corrections of what is stored: saved, merged with another workstation's, or asked about. Pages are not here."""

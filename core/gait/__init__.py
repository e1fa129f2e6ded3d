"""Gait events, phases, strides and figures of one or both feet; no joint is identified and no angle computed here."""

"""Estimators that follow the patient's motion as it happens: blocks of samples in, angles and their certainty out.

Everything here is causal and knows no clock, no thread and no file: what comes out depends on the samples alone, never
on how they were cut into blocks, so the same objects serve a live stream and a whole recording. What the end of a
recording shows of its beginning belongs to `core.analysis`.
"""

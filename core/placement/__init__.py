"""Which sensor is where, from the motion alone: without any label or against the labels; no angle is computed here.

Only two sensors that share a joint feel the same acceleration at one point between them (Seel et al. 2014, eq 7). Who
shares a joint with whom gives the chains of the legs, and gravity shows which end of a chain is up.
"""

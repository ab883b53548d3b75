"""Verification checks: every number the program rests on beside its reference. No run depends on them."""

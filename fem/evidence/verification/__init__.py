"""Verification checks: the program's numbers beside their references; nothing that computes a run imports them."""

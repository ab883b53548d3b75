"""The verification ladder: every statement that a number of this program rests on, computed anew and compared."""

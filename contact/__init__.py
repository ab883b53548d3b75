"""What happens at the floor and in time: base motion, contact laws, stepping, ledger, rocking block."""

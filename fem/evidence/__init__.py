"""Evidence for the program: its checks, the claims of the paper, and experiments, each number beside its reference."""

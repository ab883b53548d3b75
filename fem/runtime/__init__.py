"""The process and the program: progress, signals, threads, compilation, versions. It knows no case."""

"""What the container is and what the user touches: bodies, case, run, output, command line."""

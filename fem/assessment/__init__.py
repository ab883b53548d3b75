"""What a run found: verdict, comparison with the rigid block, joint demands, warnings, summary. It writes no file."""

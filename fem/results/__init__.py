"""Folders of results and their files: lock, disk space, history, fields, archive, reader. It computes nothing."""

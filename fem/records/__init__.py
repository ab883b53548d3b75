"""Recorded motions as data: formats, processing, response spectra, intensity. It knows no case, no container."""

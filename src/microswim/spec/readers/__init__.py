"""Text that comes from other programs: tables, tracks, beats, coils, scenes."""

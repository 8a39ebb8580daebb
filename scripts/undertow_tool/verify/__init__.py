"""The verification ladder: stand-alone cases at several resolutions, error and cost side by side."""

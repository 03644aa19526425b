"""``diagnosis.json`` and ``extended-model.json``: written, read back, applied."""

"""Report: the figures and the page; the only part that imports matplotlib."""

"""Runs: discovery of their files, manifest, sidecar files, merged traces, and opening of logs."""

"""What has no name: an empirical term for it, located, described and bounded."""

"""What a log's rows show while they go by once: each module looks for one thing."""

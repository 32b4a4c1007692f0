"""What a running graph shows: the latest epochs, on a map that lives."""

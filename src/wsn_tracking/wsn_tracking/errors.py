"""The one exception class of the package."""


class TrackingError(Exception):
    """Says what was seen, what was expected and what to do; the command line prints it as one line."""

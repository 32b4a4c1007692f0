"""The radio side: what a CC2530 sink says over its serial line. Bytes and frozen values; a thread only in `session`."""

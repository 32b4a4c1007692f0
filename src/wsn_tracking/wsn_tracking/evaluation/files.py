"""Results on disk: whole or not at all."""

from wsn_tracking.files import write_whole

__all__ = ['write_whole']

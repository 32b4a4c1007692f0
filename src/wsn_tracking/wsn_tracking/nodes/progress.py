"""A progress bar on standard error."""

from __future__ import annotations


class Bar:
    """Epochs that were sent, of all."""

    def __init__(self, total: int) -> None:
        from rich.console import Console  # only who asked for a bar pays for it
        from rich.progress import Progress

        self._progress = Progress(console=Console(stderr=True), transient=True)
        self._task = self._progress.add_task('epochs', total=total)
        self._progress.start()

    def reach(self, epoch: int) -> None:
        """So many epochs are done."""
        self._progress.update(self._task, completed=epoch)

    def close(self) -> None:
        """Take the bar away."""
        self._progress.stop()

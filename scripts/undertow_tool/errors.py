"""Exit codes and the two kinds of trouble the tool itself can be in."""

DONE, CHECKS_FAILED, INPUT, PEER, PHYSICS, INTERRUPTED = 0, 1, 2, 3, 4, 130


class UserError(Exception):
    """One sentence for the user: what is wrong and what to do. Exit code 2."""


class RunFailed(Exception):
    """A program of the run failed. `code` is passed through as the exit code."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code

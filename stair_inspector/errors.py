"""The few errors a user can cause. The command line and the page show their text and nothing else."""


class StairError(Exception):
    """Root of all errors that are told to the user as one sentence: what, where, what to do."""


class ReadError(StairError):
    """A scan or a settings file cannot be read: missing, damaged, or not what its header says."""


class WriteError(StairError):
    """A result cannot be written where the user asked for it."""


class ConfigError(StairError, ValueError):
    """A setting, preset, flag or value from a page is unknown, of the wrong type or out of range."""


class DegenerateGeometry(StairError, ValueError):
    """Points do not determine what was asked of them: too few, not finite, or all on one line."""


class CannotMeasure(StairError):
    """A stage finds nothing to hand on; the text says what was seen and which setting to try."""


class MissingLibrary(StairError):
    """A shared library of the operating system is missing; the text names the package that has it."""

"""The one exception for a mistake a person can mend."""


class InputError(Exception):
    """Input that cannot be used.

    The message is one line that says what is wrong, where (file, run, row, column or key) and what to do.
    The command line prints it without a traceback and ends with exit code 2.
    """

    def __init__(self, what: str, where: str = "", remedy: str = "") -> None:
        parts = [f"{where}: {what}" if where else what]
        if remedy:
            parts.append(remedy)
        super().__init__("; ".join(" ".join(part.split()) for part in parts))

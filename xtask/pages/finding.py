"""What a check says of a page that it does not accept."""


class Finding(Exception):
    """What is wrong, in a sentence that follows the name of page and check."""

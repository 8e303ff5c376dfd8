class Commands:
    """The script, one command per step."""

    def __init__(self):
        self.step = 0

    def next(self, distance_mm):
        self.step += 1
        return SCRIPT[self.step - 1]

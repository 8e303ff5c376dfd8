class Commands:
    """Random commands: straight, back, arcs, turns on the spot and single wheels, slow and fast."""

    def __init__(self):
        self.state = SEED
        self.left = 0
        self.right = 0
        self.held_steps = 0  # for which the command is still held
        self.unseen_steps = 0  # in a row without an echo
        self.turn_power = 0  # of the turn away from an obstacle; 0 when the way is free
        for _ in range(10):
            self.draw(0, 1)

    def draw(self, low, high):
        """Draws an integer from low to high. No product exceeds the 30 bits of a hub's integers."""
        self.state = 75 * (self.state + 1) % 65537 - 1
        return low + self.state * (high - low + 1) // 65536

    def draw_turn(self):
        power = self.draw(25, 60)
        return -power if self.draw(0, 1) == 0 else power

    def draw_command(self):
        came_forward = self.left + self.right > 0
        power = self.draw(15, 85)
        kind = self.draw(0, 19)
        self.held_steps = self.draw(1, 3)
        if kind < 3:
            self.left = power
            self.right = power
        elif kind < 11:
            self.left = power * self.draw(20, 100) // 100
            self.right = power * self.draw(20, 100) // 100
        elif kind < 15:
            self.left = self.draw_turn()
            self.right = -self.left
        elif kind < 16:
            self.left = -power // 2
            self.right = self.left
        else:
            self.left = self.draw(-60, 80)
            self.right = self.draw(-60, 80)
        # The robot sees nothing behind it: it reverses for one step only, over ground that it has just crossed.
        if self.left + self.right < 0:
            if came_forward:
                self.held_steps = 1
            else:
                self.left = -self.left
                self.right = -self.right

    def is_free(self, distance_mm):
        """Returns whether the way ahead is free for a step. To end a turn, an echo has to show more distance."""
        if distance_mm is None:
            self.unseen_steps += 1
            return self.unseen_steps <= MAX_UNSEEN_STEPS and self.turn_power == 0
        self.unseen_steps = 0
        if self.turn_power != 0:
            return distance_mm >= 10 * (NEAR_CM + PAST_CORNER_CM)
        return distance_mm >= 10 * NEAR_CM

    def next(self, distance_mm):
        """Returns the powers of this step: new ones when the last are over, or a turn until the way ahead is free."""
        free = self.is_free(distance_mm)
        if not free and self.turn_power == 0:
            self.turn_power = self.draw_turn()
        if self.turn_power != 0:
            self.left = self.turn_power
            # The sensor sees past a corner that the body would still touch, so the turn continues a little.
            if free:
                self.left = PAST_CORNER_POWER if self.turn_power > 0 else -PAST_CORNER_POWER
                self.turn_power = 0
            self.right = -self.left
            self.held_steps = 0
            return self.left, self.right
        if self.held_steps == 0:
            self.draw_command()
        self.held_steps -= 1
        return self.left, self.right

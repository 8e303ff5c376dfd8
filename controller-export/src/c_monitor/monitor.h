/* The monitor. Right shifts of negative numbers are arithmetic, as in the networks. */

enum { MONITOR_QUIET, MONITOR_PAUSED, MONITOR_CHANGED };

#define MONITOR_ALTERNATIVES (MONITOR_DIRECTIONS * MONITOR_SIZES + 2)

typedef struct {
  uint16_t evidence[MONITOR_ALTERNATIVES]; /* Nats * 1024. */
  uint16_t restarted[MONITOR_ALTERNATIVES];
  int16_t shifts[2][4]; /* Of the last innovations. */
  int16_t error[2], last[2], tracker[2];
  int16_t travel_before[2]; /* Sum and difference of both wheels. */
  uint16_t steps, after_steps;
  uint8_t run_steps, held_steps, pauses_left, until_regained;
  bool is_fresh;
  int8_t alarm; /* An index of evidence, or -1. */
} monitor_t;

static inline int32_t monitor_clamp(int32_t x, int32_t most) {
  return x > most ? most : x < -most ? -most : x;
}

static inline int32_t monitor_abs(int32_t x) {
  return x < 0 ? -x : x;
}

static inline void monitor_lose_track(monitor_t *monitor) {
  for (uint8_t channel = 0; channel < 2; channel++) {
    monitor->error[channel] = monitor->last[channel] = monitor->tracker[channel] = 0;
  }
  monitor->held_steps = 0;
  monitor->is_fresh = true;
}

/* A new run begins, from rest. Evidence and alarm stay. */
static inline void monitor_start_run(monitor_t *monitor) {
  monitor_lose_track(monitor);
  monitor->travel_before[0] = monitor->travel_before[1] = 0;
  monitor->run_steps = 0;
}

/* The robot stands still at the beginning of a run, and there is no evidence. */
static inline void monitor_start(monitor_t *monitor) {
  for (uint8_t i = 0; i < MONITOR_ALTERNATIVES; i++) {
    monitor->evidence[i] = monitor->restarted[i] = 0;
  }
  for (uint8_t i = 0; i < 4; i++) {
    monitor->shifts[0][i] = monitor->shifts[1][i] = 0;
  }
  monitor->steps = 0;
  monitor->pauses_left = MONITOR_MOST_PAUSED_STEPS;
  monitor->until_regained = MONITOR_REGAINED_AFTER;
  monitor->after_steps = 0;
  monitor->alarm = -1;
  monitor_start_run(monitor);
}

/* Returns the product of a number that first loses the bits of a shift and is limited, and of a factor with 14 fractional bits. */
static inline int32_t monitor_product(int32_t number, int16_t factor, uint8_t shift, int16_t most) {
  return (monitor_clamp(number >> shift, most) * factor) >> 14;
}

/* Returns what is added to the predictions of a channel. */
static inline int32_t monitor_correction(uint8_t channel, const int32_t *places) {
  int32_t sum = 0;
  for (uint8_t function = 0; function < 6; function++) {
    int32_t from_first = places[function] + 16384;
    const int16_t *values = monitor_functions + (function * 33 + (from_first >> 10)) * 2 + channel;
    int32_t low = MONITOR_READ(values), high = MONITOR_READ(values + 2);
    sum += low * 1024 + (high - low) * (from_first & 1023);
  }
  return (sum >> 10) * (INT32_C(1) << MONITOR_READ(monitor_scales + channel * 4 + 3));
}

/* The strongest alternative so far of those that reach the threshold, or -1, and its evidence. */
typedef struct {
  int8_t alternative;
  uint16_t evidence;
} monitor_strongest_t;

/* Adds nats to the evidence of an alternative, which restarts at zero. */
static inline void monitor_add(monitor_t *monitor, uint8_t i, int32_t nats, monitor_strongest_t *strongest) {
  int32_t sum = (int32_t)monitor->evidence[i] + (nats > MONITOR_MOST_NATS ? MONITOR_MOST_NATS : nats);
  if (sum <= 0) {
    monitor->evidence[i] = 0;
    monitor->restarted[i] = monitor->steps;
    return;
  }
  monitor->evidence[i] = (uint16_t)(sum > 65535 ? 65535 : sum);
  if (sum >= strongest->evidence) {
    strongest->evidence = monitor->evidence[i];
    strongest->alternative = (int8_t)i;
  }
}

/* Adds a step to the evidence of a direction, for shifts of both innovations; `sign` is -1 if the signal becomes weaker. */
static inline void monitor_add_direction(monitor_t *monitor, uint8_t direction, int32_t sign, const int32_t *innovations,
                                         int32_t forward, int32_t turn, monitor_strongest_t *strongest) {
  int32_t score = sign * ((forward * innovations[0] + turn * innovations[1]) >> 10);
  int32_t drift = -(forward * forward + turn * turn) >> 11;
  uint8_t i = (uint8_t)(direction * MONITOR_SIZES);
  monitor_add(monitor, i, score + drift, strongest);
  monitor_add(monitor, (uint8_t)(i + 1), MONITOR_LARGER * (score + MONITOR_LARGER * drift), strongest);
}

/* Computes by how much each response shifts the innovation of a channel: change of both wheels, travel of the left and of the
 * right one, and sign of both. */
static inline void monitor_filter(monitor_t *monitor, uint8_t channel, const int32_t *responses, int32_t residual_weight,
                                  int32_t last_weight) {
  for (uint8_t i = 0; i < 4; i++) {
    int32_t factor = MONITOR_READ(monitor_factors + channel * 2 + (i == 0));
    factor = (factor * residual_weight) >> 14;
    int16_t *shift = &monitor->shifts[channel][i];
    *shift = (int16_t)monitor_clamp((responses[i] * factor + *shift * last_weight) >> 14, 2048);
  }
}

/* Compares a step with the law. Commands, forward motion (cm) and turn (degrees) are in units of 1/65536, as those of the
 * networks; commands are left, right, previous left and previous right. Without a measurement the step is paused. */
static inline uint8_t monitor_step(monitor_t *monitor, const int32_t commands[4], bool is_measured, int32_t forward,
                                   int32_t turn, uint16_t duration_ms) {
  int32_t predicted[2] = {network_forward(commands[0], commands[1], commands[2], commands[3]),
                          network_turn(commands[0], commands[1], commands[2], commands[3])};
  int32_t measured[2] = {forward, turn};
  bool is_held = commands[0] == commands[2] && commands[1] == commands[3];
  uint8_t held = is_held ? monitor->held_steps + 1 : 0;
  monitor->held_steps = held = held < MONITOR_HELD ? held : MONITOR_HELD - 1;
  if (monitor->run_steps < 127) {
    monitor->run_steps++;
  }
  int32_t along = monitor_product(predicted[0], MONITOR_ALONG);
  int32_t across = monitor_product(predicted[1], MONITOR_ACROSS);
  int32_t left = along - across, right = along + across;
  int32_t signs[2] = {monitor_clamp(left * 64, MONITOR_SIGN), monitor_clamp(right * 64, MONITOR_SIGN)};
  int32_t turned = monitor_abs(monitor->travel_before[1]);
  /* In the turn the left wheel has the opposite sign. */
  int32_t responses[2][4] = {
    {right + left - monitor->travel_before[0], left, right, signs[1] + signs[0]},
    {right - left - monitor->travel_before[1], -left, right, signs[1] - signs[0]},
  };
  int32_t travels[2] = {monitor_abs(right + left), monitor_abs(right - left)};
  monitor->travel_before[0] = (int16_t)(right + left);
  monitor->travel_before[1] = (int16_t)(right - left);
  if (!is_held) {
    monitor->error[0] = monitor->error[1] = 0;
  }
  bool is_unknown[2] = {monitor->is_fresh || turned > MONITOR_STRAIGHT_TRAVEL, monitor->is_fresh};
  monitor->is_fresh = false;
  if (is_unknown[0]) {
    monitor->tracker[0] = 0;
  }
  int32_t late = (int32_t)MONITOR_STEP_MS - duration_ms;
  if (!is_measured || monitor_abs(late) > MONITOR_STEP_MS / 2) {
    monitor_lose_track(monitor);
    return monitor->alarm < 0 ? MONITOR_PAUSED : MONITOR_CHANGED;
  }
  int32_t places[6];
  for (uint8_t i = 0; i < 4; i++) {
    places[i] = monitor_product(commands[i], MONITOR_SHARE);
  }
  places[4] = (places[1] - places[0]) >> 1;
  places[5] = (places[3] - places[2]) >> 1;
  int32_t stretch = (late * MONITOR_PER_STEP_MS) >> 7;
  const int16_t *gains[2];
  int32_t residual_weights[2], last_weights[2], innovations[2];
  bool is_absurd = false;
  for (uint8_t i = 0; i < 2; i++) {
    gains[i] = monitor_gains + ((i * 2 + is_unknown[i]) * MONITOR_HELD + held) * 4;
    int32_t eighth = travels[i] >> 10;
    int32_t width = MONITOR_READ(&monitor_by_travel[i * MONITOR_TRAVELS + (eighth < MONITOR_TRAVELS ? eighth : MONITOR_TRAVELS - 1)]);
    int32_t stretched = ((measured[i] >> 12) * stretch) >> 2;
    int32_t residual = (measured[i] >> 2) - (predicted[i] >> 2) + stretched - monitor_correction(i, places);
    const int16_t *scale = monitor_scales + i * 4;
    int32_t units = monitor_product(residual, (int16_t)MONITOR_READ(scale), (uint8_t)MONITOR_READ(scale + 1),
                                    (int16_t)MONITOR_READ(scale + 2));
    int32_t precision = (MONITOR_READ(gains[i]) * width) >> 14;
    residual_weights[i] = precision;
    last_weights[i] = (precision * monitor->tracker[i]) >> 14;
    innovations[i] = ((units - monitor->error[i]) * precision + monitor->last[i] * last_weights[i]) >> 14;
    is_absurd = is_absurd || monitor_abs(innovations[i]) > 12288;
  }
  if (is_absurd && monitor->pauses_left > 0) {
    monitor->pauses_left--;
    monitor_lose_track(monitor);
    return monitor->alarm < 0 ? MONITOR_PAUSED : MONITOR_CHANGED;
  }
  if (--monitor->until_regained == 0) {
    monitor->until_regained = MONITOR_REGAINED_AFTER;
    if (monitor->pauses_left < MONITOR_MOST_PAUSED_STEPS) {
      monitor->pauses_left++;
    }
  }
  for (uint8_t i = 0; i < 2; i++) {
    innovations[i] = monitor_clamp(innovations[i], 6144);
    int32_t error = monitor->error[i] + ((innovations[i] * MONITOR_READ(gains[i] + 1)) >> 14);
    monitor->error[i] = (int16_t)monitor_clamp(error, 8192);
    monitor->last[i] = (int16_t)innovations[i];
    monitor->tracker[i] = (int16_t)MONITOR_READ(gains[i] + 2);
    residual_weights[i] = (residual_weights[i] * MONITOR_READ(gains[i] + 3)) >> 14;
  }
  monitor->steps++;
  monitor_strongest_t strongest = {-1, MONITOR_THRESHOLD};
  for (uint8_t i = 0; i < 2; i++) {
    monitor_filter(monitor, i, responses[i], residual_weights[i], last_weights[i]);
    int32_t square = innovations[i] * innovations[i];
    square = square > (INT32_C(1) << 24) ? INT32_C(1) << 24 : square;
    int32_t nats = (square * 3 - 5814540) >> 13;
    /* Where the networks are wrong about a command, they are wrong in all its steps. */
    nats = nats > 0 ? nats >> held : nats;
    monitor_add(monitor, (uint8_t)(MONITOR_DIRECTIONS * MONITOR_SIZES + i), nats, &strongest);
  }
  const int16_t *of_forward = monitor->shifts[0], *of_turn = monitor->shifts[1];
  monitor_add_direction(monitor, 6, -1, innovations, of_forward[0], of_turn[0], &strongest);
  monitor_add_direction(monitor, 7, 1, innovations, of_forward[0], of_turn[0], &strongest);
  monitor_add_direction(monitor, 0, -1, innovations, of_forward[1], of_turn[1], &strongest);
  monitor_add_direction(monitor, 1, -1, innovations, of_forward[2], of_turn[2], &strongest);
  monitor_add_direction(monitor, 8, -1, innovations, of_forward[3], of_turn[3], &strongest);
  int32_t forward_shift = (int32_t)of_forward[1] + of_forward[2], turn_shift = (int32_t)of_turn[1] + of_turn[2];
  monitor_add_direction(monitor, 2, -1, innovations, forward_shift, turn_shift, &strongest);
  monitor_add_direction(monitor, 3, 1, innovations, forward_shift, turn_shift, &strongest);
  monitor_add_direction(monitor, 4, -1, innovations, 0, turn_shift, &strongest);
  monitor_add_direction(monitor, 5, 1, innovations, 0, turn_shift, &strongest);
  forward_shift = (forward_shift * monitor->run_steps) >> 5;
  turn_shift = (turn_shift * monitor->run_steps) >> 5;
  monitor_add_direction(monitor, 9, -1, innovations, forward_shift, turn_shift, &strongest);
  if (monitor->alarm < 0 && strongest.alternative >= 0) {
    monitor->alarm = strongest.alternative;
    monitor->after_steps = (uint16_t)(monitor->steps - monitor->restarted[strongest.alternative]);
  }
  return monitor->alarm < 0 ? MONITOR_QUIET : MONITOR_CHANGED;
}

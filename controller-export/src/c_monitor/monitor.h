/* The monitor. Right shifts of negative numbers are arithmetic, as in the networks. */

enum { MONITOR_QUIET, MONITOR_PAUSED, MONITOR_CHANGED };

#define MONITOR_ALTERNATIVES (MONITOR_DIRECTIONS * MONITOR_SIZES + 2)

typedef struct {
  uint16_t evidence[MONITOR_ALTERNATIVES]; /* Nats * 1024. */
  uint16_t restarted[MONITOR_ALTERNATIVES];
  int16_t last_shifts[MONITOR_DIRECTIONS][2];
  int16_t error[2], last[2], tracker[2];
  int16_t travel_before[2];
  uint16_t steps, run_steps, after_steps;
  uint8_t held_steps, pauses_left, until_regained;
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
  for (uint8_t d = 0; d < MONITOR_DIRECTIONS; d++) {
    monitor->last_shifts[d][0] = monitor->last_shifts[d][1] = 0;
  }
  monitor->steps = 0;
  monitor->pauses_left = MONITOR_MOST_PAUSED_STEPS;
  monitor->until_regained = MONITOR_REGAINED_AFTER;
  monitor->after_steps = 0;
  monitor->alarm = -1;
  monitor_start_run(monitor);
}

/* Returns what is added to the predictions of a channel. */
static inline int32_t monitor_correction(uint8_t channel, const int32_t *places) {
  int32_t sum = 0;
  for (uint8_t function = 0; function < 6; function++) {
    int32_t from_first = places[function] + 16384;
    from_first = from_first < 0 ? 0 : from_first > 32767 ? 32767 : from_first;
    const int16_t *values = monitor_functions + (channel * 6 + function) * 33 + (from_first >> 10);
    int32_t low = MONITOR_READ(values), high = MONITOR_READ(values + 1);
    sum += low + (((high - low) * (from_first & 1023)) >> 10);
  }
  return sum * (INT32_C(1) << monitor_function_shift(channel));
}

/* Adds nats to the evidence of an alternative, which restarts at zero. */
static inline void monitor_add(monitor_t *monitor, uint8_t i, int32_t nats, uint16_t *most, int8_t *strongest) {
  int32_t sum = (int32_t)monitor->evidence[i] + nats;
  if (sum <= 0) {
    monitor->evidence[i] = 0;
    return;
  }
  if (monitor->evidence[i] == 0) {
    monitor->restarted[i] = (uint16_t)(monitor->steps - 1);
  }
  int32_t limit = (int32_t)monitor->evidence[i] + MONITOR_MOST_NATS;
  sum = sum > limit ? limit : sum;
  monitor->evidence[i] = (uint16_t)(sum > 65535 ? 65535 : sum);
  if (monitor->evidence[i] >= *most) {
    *most = monitor->evidence[i];
    *strongest = (int8_t)i;
  }
}

/* Returns the shift of a channel by the smallest alternative of a direction, with these factors of both wheels. */
static inline int32_t monitor_shift(const int16_t *factors, int32_t left, int32_t right) {
  return (left * MONITOR_READ(factors) + right * MONITOR_READ(factors + 1)) >> 14;
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
  if (monitor->run_steps < 65535) {
    monitor->run_steps++;
  }
  int32_t run_steps = monitor->run_steps < 255 ? monitor->run_steps : 255;
  int32_t along = (int32_t)(((int64_t)predicted[0] * MONITOR_TRAVEL_FORWARD) >> 32);
  int32_t across = (int32_t)(((int64_t)predicted[1] * MONITOR_TRAVEL_TURN) >> 32);
  int32_t travel[2] = {monitor_clamp(network_saturated((int64_t)along - across), 8192),
                       monitor_clamp(network_saturated((int64_t)along + across), 8192)};
  int32_t wheels[3][2];
  for (uint8_t wheel = 0; wheel < 2; wheel++) {
    wheels[0][wheel] = travel[wheel];
    wheels[1][wheel] = travel[wheel] - monitor->travel_before[wheel];
    wheels[2][wheel] = travel[wheel] >= 64 ? 4096 : travel[wheel] <= -64 ? -4096 : 0;
  }
  int32_t turned = monitor_abs((int32_t)monitor->travel_before[1] - monitor->travel_before[0]);
  int32_t travels[2] = {monitor_abs(travel[0] + travel[1]), monitor_abs(travel[1] - travel[0])};
  monitor->travel_before[0] = (int16_t)travel[0];
  monitor->travel_before[1] = (int16_t)travel[1];
  if (!is_held) {
    monitor->error[0] = monitor->error[1] = 0;
  }
  bool is_unknown[2] = {monitor->is_fresh || turned > MONITOR_STRAIGHT_TRAVEL, monitor->is_fresh};
  monitor->is_fresh = false;
  if (is_unknown[0]) {
    monitor->tracker[0] = 0;
  }
  int32_t late = (int32_t)MONITOR_STEP_MS - duration_ms;
  if (!is_measured || 2 * monitor_abs(late) > MONITOR_STEP_MS) {
    monitor_lose_track(monitor);
    return monitor->alarm < 0 ? MONITOR_PAUSED : MONITOR_CHANGED;
  }
  int32_t places[6];
  for (uint8_t i = 0; i < 4; i++) {
    places[i] = (int32_t)(((int64_t)commands[i] * MONITOR_SHARE_OF_COMMAND) >> 32);
  }
  places[4] = (places[1] - places[0]) >> 1;
  places[5] = (places[3] - places[2]) >> 1;
  int32_t stretch = network_saturated((int64_t)late * MONITOR_PER_STEP_MS) >> 10;
  const int16_t *gains[2];
  int32_t residual_weights[2], last_weights[2], innovations[2];
  bool is_absurd = false;
  for (uint8_t i = 0; i < 2; i++) {
    gains[i] = monitor_gains + ((i * 2 + is_unknown[i]) * MONITOR_HELD + held) * 4;
    int32_t eighth = travels[i] >> 10;
    int32_t width = MONITOR_READ(&monitor_by_travel[i * MONITOR_TRAVELS + (eighth < MONITOR_TRAVELS ? eighth : MONITOR_TRAVELS - 1)]);
    int32_t stretched = (int32_t)(((int64_t)measured[i] * stretch) >> 14);
    int32_t scaled = network_saturated((int64_t)measured[i] + stretched);
    int32_t expected = network_saturated((int64_t)predicted[i] + monitor_correction(i, places));
    int32_t residual = network_saturated((int64_t)scaled - expected);
    int32_t units = (int32_t)(((int64_t)residual * monitor_scale(i)) >> 32) >> monitor_scale_shift(i);
    units = monitor_clamp(units, 31744);
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
  uint16_t most = MONITOR_THRESHOLD;
  int8_t strongest = -1;
  for (uint8_t i = 0; i < 2; i++) {
    innovations[i] = monitor_clamp(innovations[i], 6144);
    int32_t error = monitor->error[i] + ((innovations[i] * MONITOR_READ(gains[i] + 1)) >> 14);
    monitor->error[i] = (int16_t)monitor_clamp(error, 8192);
    monitor->last[i] = (int16_t)innovations[i];
    monitor->tracker[i] = (int16_t)MONITOR_READ(gains[i] + 2);
    residual_weights[i] = (residual_weights[i] * MONITOR_READ(gains[i] + 3)) >> 14;
  }
  monitor->steps++;
  int32_t score = 0, half = 0;
  for (uint8_t d = 0; d < MONITOR_DIRECTIONS; d++) {
    const int16_t *direction = monitor_directions + d * 7;
    if (MONITOR_READ(direction + 6) == 1) {
      score = -score;
    } else {
      const int32_t *response = wheels[MONITOR_READ(direction)];
      bool grows = MONITOR_READ(direction + 5) == 1;
      int32_t left = grows ? (response[0] * run_steps) >> 6 : response[0];
      int32_t right = grows ? (response[1] * run_steps) >> 6 : response[1];
      int32_t square = 0;
      score = 0;
      for (uint8_t i = 0; i < 2; i++) {
        int16_t *last = &monitor->last_shifts[d][i];
        int32_t shift = monitor_shift(direction + 1 + 2 * i, left, right);
        shift = monitor_clamp((shift * residual_weights[i] + *last * last_weights[i]) >> 14, 8192);
        *last = (int16_t)shift;
        score += shift * innovations[i];
        square += shift * shift;
      }
      half = square >> 1;
    }
    for (uint8_t size = 0; size < MONITOR_SIZES; size++) {
      int32_t nats = (score - half * (INT32_C(1) << size)) >> (10 - size);
      monitor_add(monitor, (uint8_t)(d * MONITOR_SIZES + size), nats, &most, &strongest);
    }
  }
  for (uint8_t i = 0; i < 2; i++) {
    int32_t z = monitor_clamp(innovations[i], 4096);
    int32_t nats = (((z * z) >> 10) * 384 - 726817) >> 10;
    /* Where the networks are wrong about a command, they are wrong in all its steps. */
    nats = nats > 0 ? nats >> held : nats;
    monitor_add(monitor, (uint8_t)(MONITOR_DIRECTIONS * MONITOR_SIZES + i), nats, &most, &strongest);
  }
  if (monitor->alarm < 0 && strongest >= 0) {
    monitor->alarm = strongest;
    monitor->after_steps = (uint16_t)(monitor->steps - monitor->restarted[strongest]);
  }
  return monitor->alarm < 0 ? MONITOR_QUIET : MONITOR_CHANGED;
}

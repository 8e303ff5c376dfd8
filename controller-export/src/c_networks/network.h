/* Products need 64 bits. Right shifts of negative numbers are arithmetic, as on every compiler for microcontrollers. */

static inline uint32_t network_upper_product(uint32_t a, uint32_t b) {
  return (uint32_t)(((uint64_t)a * b) >> 32);
}

static inline int32_t network_saturated(int64_t wide) {
  return wide > INT32_MAX ? INT32_MAX : wide < INT32_MIN ? INT32_MIN : (int32_t)wide;
}

static inline uint32_t network_step(uint8_t index) {
  return (uint32_t)NETWORK_READ(&network_steps[index]);
}

/* Returns 1 + fraction with 31 fractional bits; fraction has 32. */
static inline uint32_t network_mantissa(uint32_t fraction) {
  return UINT32_C(0x80000000) | fraction >> 1;
}

/* Returns 2^x with 26 fractional bits; x has 52. */
static inline int32_t network_exp2(int64_t x) {
  int32_t shift = 4 - (int32_t)(x >> 52);
  if (shift < 0 || shift > 31) {
    return shift < 0 ? INT32_MAX : 0;
  }
  uint32_t fraction = (uint32_t)(x >> 20);
  uint32_t step = network_step((uint8_t)(fraction >> 27));
  uint32_t t = fraction << 5;
  uint32_t growth = network_upper_product(t, 117619);
  growth = network_upper_product(t, 16120621 + growth);
  growth = network_upper_product(t, 1488522352 + growth);
  growth = step + ((growth + network_upper_product(step, growth) + 8) >> 4);
  uint32_t bits = network_mantissa(growth) >> shift;
  return network_saturated((int64_t)(bits >> 1) + (bits & 1));
}

/* Returns the logarithm of x to base two; both have 26 fractional bits. An x below 2^-10 counts as 2^-10. */
static inline int32_t network_log2(int32_t x) {
  uint32_t bits = x < 65536 ? 65536 : (uint32_t)x;
  int32_t whole = 5;
  while (bits < UINT32_C(0x80000000)) {
    bits <<= 1;
    whole--;
  }
  uint32_t fraction = bits << 1;
  uint8_t above = 1;
  while (above < 32 && network_step(above) <= fraction) {
    above++;
  }
  uint32_t ratio = network_mantissa(fraction);
  if (above > 1) {
    ratio = network_upper_product(ratio, network_mantissa(network_step((uint8_t)(33 - above))));
  }
  uint32_t u = ratio > UINT32_C(0x80000000) ? (ratio - UINT32_C(0x80000000)) << 6 : 0;
  uint32_t slope = UINT32_C(3097363789) - network_upper_product(u, 62557795);
  slope = UINT32_C(3098162573) - (network_upper_product(u, slope) >> 6);
  u = network_upper_product(u, slope) >> 4;
  return whole * INT32_C(67108864) + (above - 1) * INT32_C(2097152) + (int32_t)((u + 32) >> 6);
}

/* Returns an input scaled to the trained range, with 26 fractional bits. The weights are gain, shift, the offset in limbs
 * of 16 bits, and the range. */
static inline int32_t network_scaled(const int32_t *weights, int32_t input) {
  uint64_t offset = 0;
  for (uint8_t limb = 2; limb < 6; limb++) {
    offset = offset << 16 | (uint16_t)NETWORK_READ(&weights[limb]);
  }
  int64_t gained = ((int64_t)input * NETWORK_READ(&weights[0])) >> NETWORK_READ(&weights[1]);
  int64_t scaled = gained + (int64_t)offset;
  int32_t low = NETWORK_READ(&weights[6]), high = NETWORK_READ(&weights[7]);
  return scaled < low ? low : scaled > high ? high : (int32_t)scaled;
}

/* Evaluates the network with these weights. Inputs and output have 16 fractional bits. */
static inline int32_t network_evaluate(const int32_t *weights, const int32_t *inputs) {
  int32_t scaled[4], log2_scaled[4];
  uint8_t count = (uint8_t)NETWORK_READ(weights++);
  uint8_t powers = (uint8_t)NETWORK_READ(weights++);
  uint8_t output_shift = (uint8_t)NETWORK_READ(weights++);
  bool is_ramp = NETWORK_READ(weights++) == 1;
  for (uint8_t i = 0; i < count; i++, weights += 8) {
    scaled[i] = network_scaled(weights, inputs[i]);
    log2_scaled[i] = network_log2(scaled[i]);
  }
  int64_t affine = NETWORK_READ(weights++);
  for (uint8_t i = 0; i < count; i++) {
    affine += ((int64_t)scaled[i] * NETWORK_READ(weights++)) >> 26;
  }
  int32_t sum = network_saturated(affine);
  for (; powers > 0; powers--) {
    bool is_minus = NETWORK_READ(weights++) == 1;
    int64_t exponent = (int64_t)NETWORK_READ(weights++) * 67108864;
    for (uint8_t i = 0; i < count; i++) {
      exponent += (int64_t)log2_scaled[i] * NETWORK_READ(weights++);
    }
    int32_t term = network_exp2(exponent);
    sum = network_saturated(is_minus ? (int64_t)sum - term : (int64_t)sum + term);
  }
  int32_t output = network_saturated(((int64_t)sum * (INT64_C(1) << output_shift) + 512) >> 10);
  return is_ramp && output < 0 ? 0 : is_ramp && output > 65536 ? 65536 : output;
}

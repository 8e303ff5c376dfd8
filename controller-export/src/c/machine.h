
/* Motor commands, -100..100. */
typedef struct {
  int8_t left;
  int8_t right;
} controller_motors;

typedef struct {
  controller_motors motors;
  /* Whether a reading above the threshold ends the tuple; otherwise one below it does. */
  bool when_larger;
  int16_t threshold_cm;
} controller_tuple;

typedef enum { CONTROLLER_RUNNING, CONTROLLER_FINISHED, CONTROLLER_TIMED_OUT } controller_status;

/* A run: the tuple that is held, and the number of steps taken. Initialise it with {0}. */
typedef struct {
  uint8_t tuple;
  uint16_t steps;
  controller_status status;
} controller_machine;

@tuples@
/* Takes one step with its reading. reading_cm is used only if has_reading is true. A stopped run stays stopped. */
static inline controller_status controller_step(controller_machine *machine, bool has_reading, int16_t reading_cm) {
  if (machine->status != CONTROLLER_RUNNING) {
    return machine->status;
  }
  const controller_tuple *tuple = &controller_tuples[machine->tuple];
  bool larger = reading_cm > tuple->threshold_cm;
  bool smaller = reading_cm < tuple->threshold_cm;
  machine->steps++;
  if (has_reading && (tuple->when_larger ? larger : smaller)) {
    machine->tuple++;
  }
  if (machine->tuple == CONTROLLER_TUPLES) {
    machine->status = CONTROLLER_FINISHED;
  } else if (machine->steps == CONTROLLER_MAX_STEPS) {
    machine->status = CONTROLLER_TIMED_OUT;
  }
  return machine->status;
}

/* Returns the current motor commands; zero once stopped. */
static inline controller_motors controller_motors_now(const controller_machine *machine) {
  controller_motors stopped = {0, 0};
  return machine->status == CONTROLLER_RUNNING ? controller_tuples[machine->tuple].motors : stopped;
}

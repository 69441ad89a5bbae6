/* Derivatives of outputs. */

/* Adds a matrix, column after column, times a vector. */
static void add_product(const double *matrix, int rows, int columns, const double *vector, double *sum) {
  for (int j = 0; j < columns; j++) {
    for (int i = 0; i < rows; i++) sum[i] += matrix[j * rows + i] * vector[j];
  }
}

/* A direction in which inputs and parameters change, and how fast the inputs then move. */
typedef struct {
  double inputs[INPUT_ROOM];
  double inputs_rate[INPUT_ROOM];
  double parameters[PARAMETER_ROOM];
} direction;

/* Derivatives of the equilibrium at the start by inputs and parameters. Returns null, or a reason without them. */
static const char *change_at_rest(instance *self, const direction *along) {
  const moment *now = &self->held.now;
  if (FMU_STARTS_UNLOADED) return 0;
  const fmu_status status = fmu_solve_sensitivity(now->inputs, self->held.parameters, now->state.x, self->d_x_d_inputs,
                                                  self->d_x_d_parameters, &self->workspace);
  if (status != FMU_CONVERGED) return fmu_status_text(status);
  add_product(self->d_x_d_inputs, N, FMU_INPUTS, along->inputs, self->state_change);
  add_product(self->d_x_d_parameters, N, FMU_PARAMETERS, along->parameters, self->state_change);
  return 0;
}

/* Derivatives of the state at the end of the last communication step by the inputs given for it. Returns null, or a
   reason without them. The integrator takes its steps again, each with its derivatives. */
static const char *change_of_step(instance *self, const direction *along) {
  static const double zero[INPUT_ROOM] = {0};
  const snapshot *held = &self->held;
  moment *again = &self->kept;
  /* Inputs as they were in that step: others may have been given since for the next one. */
  const course way = {held->before.inputs, held->before.inputs_rate, held->now.inputs, held->now.inputs_rate,
                      held->last_step};
  const course way_changes = {zero, zero, along->inputs, along->inputs_rate, held->last_step};
  const int count = count_steps(held, held->last_step);
  const double duration = held->last_step / count;
  *again = held->before;
  for (int k = 0; k < count; k++) {
    moving_inputs at, changes;
    double next[STATE] = {0};
    inputs_on(&way, k * duration, 2 * k >= count, &at);
    inputs_on(&way_changes, k * duration, 2 * k >= count, &changes);
    const fmu_motion_status status =
        fmu_step_sensitivity(at.value, held->parameters, at.rate, at.acceleration, duration, &again->state, &again->memory,
                             self->d_next_d_state, self->d_next_d_inputs, self->d_next_d_rate,
                             self->d_next_d_acceleration, &self->workspace);
    if (status != FMU_DONE) return fmu_motion_status_text(status);
    add_product(self->d_next_d_state, STATE, STATE, self->state_change, next);
    add_product(self->d_next_d_inputs, STATE, FMU_INPUTS, changes.value, next);
    add_product(self->d_next_d_rate, STATE, FMU_INPUTS, changes.rate, next);
    add_product(self->d_next_d_acceleration, STATE, FMU_INPUTS, changes.acceleration, next);
    memcpy(self->state_change, next, sizeof next);
  }
  return 0;
}

/* Reads the direction that an importer asks for. Returns null, or a reason without a derivative. */
static const char *read_direction(const snapshot *held, const fmi3ValueReference knowns[], const fmi3Float64 seed[],
                                  size_t count, direction *along) {
  const int stepped = held->mode == STEPPING && held->last_step > 0;
  memset(along, 0, sizeof *along);
  for (size_t k = 0; k < count; k++) {
    if (is_between(knowns[k], FIRST_INPUT, FIRST_OUTPUT)) {
      const int input = (int)knowns[k] - FIRST_INPUT;
      const double change = stepped ? held->sign[input] * seed[k] : seed[k];
      along->inputs[input] += change;
      /* The rate at the end is the mean rate plus lead times its change. */
      if (stepped && MOVES[input]) along->inputs_rate[input] += change * (1 + held->lead) / held->last_step;
    } else if (is_between(knowns[k], FIRST_PARAMETER, VARIABLES)) {
      if (stepped) return "after the first step derivatives are with respect to inputs alone";
      along->parameters[knowns[k] - FIRST_PARAMETER] += seed[k];
    } else {
      return "derivatives are with respect to inputs and to parameters of the scene";
    }
  }
  return 0;
}

/* Derivatives of outputs: before the first step at the equilibrium, by inputs and parameters; later at the end of the
   last communication step, by the inputs given for it. */
FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[],
                                                    size_t unknown_count, const fmi3ValueReference knowns[],
                                                    size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                    fmi3Float64 sensitivity[], size_t sensitivity_count) {
  instance *self = (instance *)handle;
  const snapshot *held = &self->held;
  const moment *now = &held->now;
  direction along;
  double outputs_change[FMU_OUTPUTS] = {0};
  if (seed_count != known_count || sensitivity_count != unknown_count) {
    return refuse(self, "fmi3GetDirectionalDerivative", "every variable is one number");
  }
  const char *why = read_direction(held, knowns, seed, known_count, &along);
  if (why) return refuse(self, "fmi3GetDirectionalDerivative", why);
  const fmi3Status computed = compute_outputs(self);
  if (computed != fmi3OK) return computed;
  memset(self->state_change, 0, sizeof self->state_change);
  const bool stepped = held->mode == STEPPING && held->last_step > 0;
  why = stepped ? change_of_step(self, &along) : change_at_rest(self, &along);
  if (why) return refuse(self, "fmi3GetDirectionalDerivative", why);
  fmu_outputs_jacobian(now->state.x, now->state.v, now->inputs, held->parameters, now->inputs_rate,
                       self->d_outputs_d_state, self->d_outputs_d_inputs, self->d_outputs_d_parameters,
                       self->d_outputs_d_rate);
  add_product(self->d_outputs_d_state, FMU_OUTPUTS, STATE, self->state_change, outputs_change);
  add_product(self->d_outputs_d_inputs, FMU_OUTPUTS, FMU_INPUTS, along.inputs, outputs_change);
  add_product(self->d_outputs_d_parameters, FMU_OUTPUTS, FMU_PARAMETERS, along.parameters, outputs_change);
  add_product(self->d_outputs_d_rate, FMU_OUTPUTS, FMU_INPUTS, along.inputs_rate, outputs_change);
  for (size_t k = 0; k < unknown_count; k++) {
    if (!is_between(unknowns[k], FIRST_OUTPUT, STEP)) {
      return refuse(self, "fmi3GetDirectionalDerivative", "derivatives are those of outputs");
    }
    sensitivity[k] = outputs_change[unknowns[k] - FIRST_OUTPUT];
  }
  return fmi3OK;
}

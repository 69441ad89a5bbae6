/* The start of a motion, and its steps. */

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean tolerance_defined,
                                                   fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined,
                                                   fmi3Float64 stop) {
  instance *self = (instance *)handle;
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  if (self->held.mode != INSTANTIATED) return refuse(self, "fmi3EnterInitializationMode", "not the time for it");
  self->held.now.time = start;
  self->held.mode = INITIALISING;
  return fmi3OK;
}

/* At rest: in the static equilibrium of the inputs, or in the unloaded shape where the scene starts there. */
static fmi3Status settle(instance *self) {
  moment *now = &self->held.now;
  const double *parameters = self->held.parameters;
  fmu_status found = FMU_CONVERGED;
  double x[N] = {0};
  memset(&now->memory, 0, sizeof now->memory);
  memcpy(now->inputs, self->held.given, sizeof now->inputs);
  memset(now->inputs_rate, 0, sizeof now->inputs_rate);
  if (!FMU_STARTS_UNLOADED) found = fmu_solve(now->inputs, parameters, x, &self->workspace);
#ifdef FMU_START
  /* Only the scene's own start has exact contacts; a solve has none. */
  const int inputs_of_scene = memcmp(now->inputs, DEFAULT_INPUTS, sizeof now->inputs) == 0;
  const int parameters_of_scene = memcmp(parameters, DEFAULT_PARAMETERS, sizeof self->held.parameters) == 0;
  if (found != FMU_CONVERGED && inputs_of_scene && parameters_of_scene) {
    FMU_START(&now->state);
    return fmi3OK;
  }
#endif
  if (found != FMU_CONVERGED) return refuse(self, "the equilibrium at the start", fmu_status_text(found));
  const fmu_motion_status status = fmu_rest(now->inputs, parameters, x, &now->state, &self->workspace);
  if (status != FMU_DONE) return refuse(self, "the start", fmu_motion_status_text(status));
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance handle) {
  instance *self = (instance *)handle;
  if (self->held.mode != INITIALISING) return refuse(self, "fmi3ExitInitializationMode", "not the time for it");
  if (!(self->held.step > 0) || !isfinite(self->held.step)) return refuse(self, "step", "must be > 0");
  const fmi3Status status = settle(self);
  if (status != fmi3OK) return status;
  self->held.before = self->held.now;
  self->held.last_step = 0;
  self->held.mode = STEPPING;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance handle) {
  ((instance *)handle)->held.mode = TERMINATED;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance handle, fmi3Float64 start, fmi3Float64 duration, fmi3Boolean no_set_prior,
                                  fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                                  fmi3Float64 *last_time) {
  instance *self = (instance *)handle;
  snapshot *held = &self->held;
  (void)no_set_prior;
  *event_needed = false;
  *terminate = false;
  *early_return = false;
  *last_time = held->now.time;
  if (held->mode != STEPPING) return refuse(self, "fmi3DoStep", "not the time for it");
  if (!(duration > 0) || !isfinite(duration)) return refuse(self, "fmi3DoStep", "the step must be > 0");
  if (!(duration / held->step < 1e6)) return refuse(self, "fmi3DoStep", "more than a million steps of the integrator");
  /* Times that an importer sums up in another way differ by rounding. */
  if (!(fabs(start - held->now.time) <= 1e-6 * duration + 4 * DBL_EPSILON * fabs(start))) {
    return refuse(self, "fmi3DoStep", "does not begin where the last step ended");
  }
  self->kept = held->now;
  moment *now = &held->now;
  double end_rate[INPUT_ROOM] = {0};
  double to[INPUT_ROOM] = {0};
  double sign[INPUT_ROOM] = {0};
  on_one_side(held, to, sign);
  for (int i = 0; i < FMU_INPUTS; i++) end_rate[i] = MOVES[i] ? rate_at_end(held, i, to[i], duration) : 0;
  const course way = {self->kept.inputs, self->kept.inputs_rate, to, end_rate, duration};
  const int count = count_steps(held, duration);
  for (int k = 0; k < count; k++) {
    moving_inputs at;
    inputs_on(&way, k * duration / count, 2 * k >= count, &at);
    const fmu_motion_status status = fmu_step(at.value, held->parameters, at.rate, at.acceleration, duration / count,
                                              &now->state, &now->memory, &self->workspace);
    if (status != FMU_DONE) {
      *now = self->kept;
      return say(self, fmi3Discard, fmu_motion_status_text(status));
    }
  }
  memcpy(now->inputs, to, sizeof now->inputs);
  memcpy(held->sign, sign, sizeof held->sign);
  memcpy(now->inputs_rate, end_rate, sizeof now->inputs_rate);
  now->time = start + duration;
  held->before = self->kept;
  held->lead = lead_of_rate(held, duration);
  held->last_step = duration;
  *last_time = held->now.time;
  return fmi3OK;
}

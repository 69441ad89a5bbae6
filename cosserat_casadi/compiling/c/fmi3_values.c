/* Values of variables. */

static fmi3Status compute_outputs(instance *self) {
  moment *now = &self->held.now;
  if (self->held.mode == INSTANTIATED) return refuse(self, "outputs", "there are none before the initialisation");
  if (self->held.mode == INITIALISING) {
    const fmi3Status status = settle(self);
    if (status != fmi3OK) return status;
  }
  fmu_outputs(now->state.x, now->state.v, now->inputs, self->held.parameters, now->inputs_rate, self->outputs);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                      fmi3Float64 values[], size_t value_count) {
  instance *self = (instance *)handle;
  int computed = 0;
  if (count != value_count) return refuse(self, "fmi3GetFloat64", "every variable is one number");
  for (size_t k = 0; k < count; k++) {
    const fmi3ValueReference reference = references[k];
    if (reference == TIME) {
      values[k] = self->held.now.time;
    } else if (reference < FIRST_OUTPUT) {
      values[k] = self->held.given[reference - FIRST_INPUT];
    } else if (reference < STEP) {
      const fmi3Status status = computed ? fmi3OK : compute_outputs(self);
      if (status != fmi3OK) return status;
      computed = 1;
      values[k] = self->outputs[reference - FIRST_OUTPUT];
    } else if (reference == STEP) {
      values[k] = self->held.step;
    } else if (reference < VARIABLES) {
      values[k] = self->held.parameters[reference - FIRST_PARAMETER];
    } else {
      return refuse(self, "fmi3GetFloat64", "no such variable");
    }
  }
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                      const fmi3Float64 values[], size_t value_count) {
  instance *self = (instance *)handle;
  if (count != value_count) return refuse(self, "fmi3SetFloat64", "every variable is one number");
  /* All or none are set. */
  for (size_t k = 0; k < count; k++) {
    const int is_input = is_between(references[k], FIRST_INPUT, FIRST_OUTPUT);
    const int is_parameter = is_between(references[k], STEP, VARIABLES) && self->held.mode < STEPPING;
    if (!isfinite(values[k])) return refuse(self, "fmi3SetFloat64", "a value must be finite");
    if (!is_input && !is_parameter) return refuse(self, "fmi3SetFloat64", "this variable cannot be set now");
  }
  for (size_t k = 0; k < count; k++) {
    if (references[k] == STEP) self->held.step = values[k];
    else if (references[k] > STEP) self->held.parameters[references[k] - FIRST_PARAMETER] = values[k];
    else self->held.given[references[k] - FIRST_INPUT] = values[k];
  }
  return fmi3OK;
}



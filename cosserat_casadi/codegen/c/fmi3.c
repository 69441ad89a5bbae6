/* Co-simulation of a scene in motion by FMI 3.0, on top of the functions of the library's header.

   The file of the scene that includes this one has defined the sizes, named the functions of the library, and given two
   kernels: the outputs, and their derivatives. What an importer may expect of each function is in the FMI standard
   (https://fmi-standard.org). Value references count through: the time, the inputs, the outputs, the step. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3.h"

enum {
  TIME = 0,
  FIRST_INPUT = 1,
  FIRST_OUTPUT = FIRST_INPUT + FMU_INPUTS,
  STEP = FIRST_OUTPUT + FMU_OUTPUTS,
  N = FMU_UNKNOWNS,
  STATE = 2 * FMU_UNKNOWNS, /* x and v */
  INPUT_ROOM = FMU_INPUTS > 0 ? FMU_INPUTS : 1
};

static const double DEFAULT_INPUTS[INPUT_ROOM] = FMU_DEFAULTS;

/* Which inputs move linearly over a communication step: those that move rods or prescribe a length have a velocity. They
   have no acceleration, which two values do not tell: jumps of the velocity between steps exert no inertia forces. The
   others are loads, held over the step. */
static const int MOVES[INPUT_ROOM] = FMU_MOVES;

typedef enum { INSTANTIATED, INITIALISING, STEPPING, TERMINATED } mode;

/* All that a step depends on: what fmi3GetFMUState copies. */
typedef struct {
  fmu_state state;
  fmu_memory memory;
  double inputs[INPUT_ROOM];      /* that the state has seen */
  double inputs_rate[INPUT_ROOM]; /* at the end of the last step */
  double time;
} moment;

/* What a copy of an instance holds. */
typedef struct {
  moment now;
  moment before; /* at the start of the last communication step */
  double last_step;
  double given[INPUT_ROOM]; /* inputs as the importer set them */
  double step;
  mode mode;
} snapshot;

typedef struct {
  snapshot held;
  fmu_workspace workspace;
  double outputs[FMU_OUTPUTS];
  double d_outputs_d_state[FMU_OUTPUTS * STATE];
  double d_outputs_d_inputs[FMU_OUTPUTS * INPUT_ROOM];
  double d_outputs_d_rate[FMU_OUTPUTS * INPUT_ROOM];
  double d_next_d_state[STATE * STATE];
  double d_next_d_inputs[STATE * INPUT_ROOM]; /* of x alone at the start */
  double d_next_d_rate[STATE * INPUT_ROOM];
  double direction[STATE];
  moment kept; /* of one call; too large for the stack of a thread */
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
  bool logging;
} instance;

static fmi3Status say(const instance *self, fmi3Status status, const char *message) {
  const char *category = status == fmi3Discard ? "logStatusDiscard" : "logStatusError";
  if (self->log && self->logging) self->log(self->environment, status, category, message);
  return status;
}

static fmi3Status refuse(const instance *self, const char *function, const char *why) {
  char message[256];
  (void)snprintf(message, sizeof message, "%s: %s", function, why);
  return say(self, fmi3Error, message);
}

/* ---- Instances ---- */

static void reset(instance *self) {
  memset(&self->held, 0, sizeof self->held);
  memcpy(self->held.given, DEFAULT_INPUTS, sizeof DEFAULT_INPUTS);
  self->held.step = FMU_STEP;
  self->held.mode = INSTANTIATED;
}

FMI3_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed, const fmi3ValueReference intermediate[],
    size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
  (void)name, (void)resources, (void)visible, (void)event_mode_used, (void)early_return_allowed;
  (void)intermediate, (void)intermediate_count, (void)update;
  if (!token || strcmp(token, FMU_TOKEN) != 0) {
    if (log) log(environment, fmi3Error, "logStatusError", "the token is that of another model description");
    return 0;
  }
  instance *self = (instance *)calloc(1, sizeof *self);
  if (!self) {
    if (log) log(environment, fmi3Error, "logStatusError", "there is no memory for an instance");
    return 0;
  }
  self->environment = environment;
  self->log = log;
  self->logging = logging;
  reset(self);
  return self;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging;
  if (log) log(environment, fmi3Error, "logStatusError", "this FMU is one for co-simulation alone");
  return 0;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                           fmi3Boolean visible, fmi3Boolean logging,
                                                           fmi3InstanceEnvironment environment,
                                                           fmi3LogMessageCallback log, void (*clock)(void *),
                                                           void (*lock)(void), void (*unlock)(void)) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
  if (log) log(environment, fmi3Error, "logStatusError", "this FMU is one for co-simulation alone");
  return 0;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance handle) { free(handle); }

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean logging, size_t count,
                                           const fmi3String categories[]) {
  (void)count, (void)categories;
  ((instance *)handle)->logging = logging;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance handle) {
  reset((instance *)handle);
  return fmi3OK;
}

/* ---- Initialisation ---- */

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
  double x[N] = {0};
  memset(&now->memory, 0, sizeof now->memory);
  memcpy(now->inputs, self->held.given, sizeof now->inputs);
  memset(now->inputs_rate, 0, sizeof now->inputs_rate);
  const fmu_status found = FMU_STARTS_UNLOADED ? FMU_CONVERGED : fmu_solve(now->inputs, x, &self->workspace, 0);
  if (found != FMU_CONVERGED) return refuse(self, "the equilibrium at the start", fmu_status_text(found));
  const fmu_motion_status status = fmu_rest(now->inputs, x, &now->state, &self->workspace);
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

/* ---- Steps ---- */

/* Inputs of a moment and their rates on the way to those that were given, over one communication step. */
static void set_course(const snapshot *held, double duration, moment *now) {
  for (int i = 0; i < FMU_INPUTS; i++) {
    now->inputs_rate[i] = MOVES[i] ? (held->given[i] - now->inputs[i]) / duration : 0;
    if (!MOVES[i]) now->inputs[i] = held->given[i];
  }
}

static int count_steps(const snapshot *held, double duration) {
  const double count = ceil(duration / held->step - 1e-9);
  return count < 1 ? 1 : (int)count;
}

static void move_inputs(moment *now, double duration) {
  for (int i = 0; i < FMU_INPUTS; i++) now->inputs[i] += duration * now->inputs_rate[i];
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
  if (!(fabs(start - held->now.time) <= 1e-6 * duration)) {
    return refuse(self, "fmi3DoStep", "does not begin where the last step ended");
  }
  self->kept = held->now;
  const int count = count_steps(held, duration);
  moment *now = &held->now;
  set_course(held, duration, now);
  for (int k = 0; k < count; k++) {
    const fmu_motion_status status = fmu_step(now->inputs, now->inputs_rate, duration / count, &now->state,
                                              &now->memory, 0, &self->workspace, 0);
    if (status != FMU_DONE) {
      *now = self->kept;
      return say(self, fmi3Discard, fmu_motion_status_text(status));
    }
    move_inputs(now, duration / count);
  }
  held->now.time = start + duration;
  held->before = self->kept;
  held->last_step = duration;
  *last_time = held->now.time;
  return fmi3OK;
}

/* ---- Values ---- */

static fmi3Status compute_outputs(instance *self) {
  moment *now = &self->held.now;
  if (self->held.mode == INSTANTIATED) return refuse(self, "outputs", "there are none before the initialisation");
  if (self->held.mode == INITIALISING) {
    const fmi3Status status = settle(self);
    if (status != fmi3OK) return status;
  }
  fmu_outputs(now->state.x, now->state.v, now->inputs, now->inputs_rate, self->outputs);
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
    const int is_input = references[k] >= FIRST_INPUT && references[k] < FIRST_OUTPUT;
    const int is_step = references[k] == STEP && self->held.mode < STEPPING;
    if (!isfinite(values[k])) return refuse(self, "fmi3SetFloat64", "a value must be finite");
    if (!is_input && !is_step) return refuse(self, "fmi3SetFloat64", "this variable cannot be set now");
  }
  for (size_t k = 0; k < count; k++) {
    if (references[k] == STEP) self->held.step = values[k];
    else self->held.given[references[k] - FIRST_INPUT] = values[k];
  }
  return fmi3OK;
}

/* Variables of other types there are none. */
#define NO_GETTER(Type)                                                                                        \
  FMI3_EXPORT fmi3Status fmi3Get##Type(fmi3Instance handle, const fmi3ValueReference references[], size_t count, \
                                       fmi3##Type values[], size_t value_count) {                              \
    (void)references, (void)values, (void)value_count;                                                         \
    return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3Get" #Type, "no such variable");              \
  }
#define NO_SETTER(Type)                                                                                        \
  FMI3_EXPORT fmi3Status fmi3Set##Type(fmi3Instance handle, const fmi3ValueReference references[], size_t count, \
                                       const fmi3##Type values[], size_t value_count) {                        \
    (void)references, (void)values, (void)value_count;                                                         \
    return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3Set" #Type, "no such variable");              \
  }
#define NO_VARIABLES(Type) NO_GETTER(Type) NO_SETTER(Type)
NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)

FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                     size_t sizes[], fmi3Binary values[], size_t value_count) {
  (void)references, (void)sizes, (void)values, (void)value_count;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3GetBinary", "no such variable");
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                     const size_t sizes[], const fmi3Binary values[], size_t value_count) {
  (void)references, (void)sizes, (void)values, (void)value_count;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3SetBinary", "no such variable");
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                    fmi3Clock values[]) {
  (void)references, (void)values;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3GetClock", "no such variable");
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                    const fmi3Clock values[]) {
  (void)references, (void)values;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3SetClock", "no such variable");
}

/* ---- Copies of a state ---- */

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState *state) {
  instance *self = (instance *)handle;
  if (!*state) *state = malloc(sizeof self->held);
  if (!*state) return refuse(self, "fmi3GetFMUState", "there is no memory");
  memcpy(*state, &self->held, sizeof self->held);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState state) {
  instance *self = (instance *)handle;
  memcpy(&self->held, state, sizeof self->held);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState *state) {
  (void)handle;
  free(*state);
  *state = 0;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState state, size_t *size) {
  (void)handle, (void)state;
  *size = sizeof(snapshot);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  if (size < sizeof(snapshot)) return refuse((instance *)handle, "fmi3SerializeFMUState", "there is too little room");
  memcpy(bytes, state, sizeof(snapshot));
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte bytes[], size_t size,
                                               fmi3FMUState *state) {
  instance *self = (instance *)handle;
  if (size != sizeof(snapshot)) return refuse(self, "fmi3DeserializeFMUState", "not a state of this FMU");
  if (!*state) *state = malloc(sizeof(snapshot));
  if (!*state) return refuse(self, "fmi3DeserializeFMUState", "there is no memory");
  memcpy(*state, bytes, size);
  return fmi3OK;
}

/* ---- Derivatives ---- */

/* Adds a matrix, column after column, times a vector. */
static void add_product(const double *matrix, int rows, int columns, const double *vector, double *sum) {
  for (int j = 0; j < columns; j++) {
    for (int i = 0; i < rows; i++) sum[i] += matrix[j * rows + i] * vector[j];
  }
}

/* How the equilibrium at the start changes with the inputs along `change`; null, or why it is not known. */
static const char *direction_at_rest(instance *self, const double *change) {
  const moment *now = &self->held.now;
  double *d_x = self->d_next_d_inputs;
  if (FMU_STARTS_UNLOADED) return 0;
  const fmu_status status = fmu_solve_sensitivity(now->inputs, now->state.x, d_x, 0, &self->workspace);
  if (status != FMU_CONVERGED) return fmu_status_text(status);
  add_product(d_x, N, FMU_INPUTS, change, self->direction);
  return 0;
}

/* How the state at the end of the last communication step changes with the inputs given for it along `change`; null, or
   why it is not known. Its steps are taken again, each with its derivatives. */
static const char *direction_of_step(instance *self, const double *change) {
  const snapshot *held = &self->held;
  moment *now = &self->kept;
  const int count = count_steps(held, held->last_step);
  const double duration = held->last_step / count;
  double inputs_change[INPUT_ROOM] = {0};
  double rate_change[INPUT_ROOM] = {0};
  double next[STATE];
  *now = held->before;
  for (int i = 0; i < FMU_INPUTS; i++) {
    /* As they were in that step: others may have been given since for the next one. */
    now->inputs_rate[i] = held->now.inputs_rate[i];
    if (!MOVES[i]) now->inputs[i] = held->now.inputs[i];
    rate_change[i] = MOVES[i] ? change[i] / held->last_step : 0;
    inputs_change[i] = MOVES[i] ? 0 : change[i];
  }
  for (int k = 0; k < count; k++) {
    const fmu_motion_status status =
        fmu_step_sensitivity(now->inputs, now->inputs_rate, duration, &now->state, &now->memory, 0, self->d_next_d_state,
                             self->d_next_d_inputs, self->d_next_d_rate, &self->workspace, 0);
    if (status != FMU_DONE) return fmu_motion_status_text(status);
    memset(next, 0, sizeof next);
    add_product(self->d_next_d_state, STATE, STATE, self->direction, next);
    add_product(self->d_next_d_inputs, STATE, FMU_INPUTS, inputs_change, next);
    add_product(self->d_next_d_rate, STATE, FMU_INPUTS, rate_change, next);
    memcpy(self->direction, next, sizeof next);
    move_inputs(now, duration);
    for (int i = 0; i < FMU_INPUTS; i++) inputs_change[i] += duration * rate_change[i];
  }
  return 0;
}

/* Derivatives of outputs with the inputs: of those in equilibrium before the first step, then of those at the end of the
   last communication step with the inputs that were given for it. */
FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[],
                                                    size_t unknown_count, const fmi3ValueReference knowns[],
                                                    size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                    fmi3Float64 sensitivity[], size_t sensitivity_count) {
  instance *self = (instance *)handle;
  const snapshot *held = &self->held;
  double change[INPUT_ROOM] = {0};
  double rate_change[INPUT_ROOM] = {0};
  double outputs_change[FMU_OUTPUTS] = {0};
  if (seed_count != known_count || sensitivity_count != unknown_count) {
    return refuse(self, "fmi3GetDirectionalDerivative", "every variable is one number");
  }
  for (size_t k = 0; k < known_count; k++) {
    if (knowns[k] < FIRST_INPUT || knowns[k] >= FIRST_OUTPUT) {
      return refuse(self, "fmi3GetDirectionalDerivative", "derivatives are with respect to inputs");
    }
    change[knowns[k] - FIRST_INPUT] += seed[k];
  }
  const fmi3Status computed = compute_outputs(self);
  if (computed != fmi3OK) return computed;
  memset(self->direction, 0, sizeof self->direction);
  const bool stepped = held->mode == STEPPING && held->last_step > 0;
  const char *why = stepped ? direction_of_step(self, change) : direction_at_rest(self, change);
  if (why) return refuse(self, "fmi3GetDirectionalDerivative", why);
  for (int i = 0; i < FMU_INPUTS; i++) rate_change[i] = stepped && MOVES[i] ? change[i] / held->last_step : 0;
  fmu_outputs_jacobian(held->now.state.x, held->now.state.v, held->now.inputs, held->now.inputs_rate,
                       self->d_outputs_d_state, self->d_outputs_d_inputs, self->d_outputs_d_rate);
  add_product(self->d_outputs_d_state, FMU_OUTPUTS, STATE, self->direction, outputs_change);
  add_product(self->d_outputs_d_inputs, FMU_OUTPUTS, FMU_INPUTS, change, outputs_change);
  add_product(self->d_outputs_d_rate, FMU_OUTPUTS, FMU_INPUTS, rate_change, outputs_change);
  for (size_t k = 0; k < unknown_count; k++) {
    if (unknowns[k] < FIRST_OUTPUT || unknowns[k] >= STEP) {
      return refuse(self, "fmi3GetDirectionalDerivative", "derivatives are those of outputs");
    }
    sensitivity[k] = outputs_change[unknowns[k] - FIRST_OUTPUT];
  }
  return fmi3OK;
}

/* ---- What this FMU does not offer ---- */

#define NOT_OFFERED(function, ...)                                                      \
  FMI3_EXPORT fmi3Status function(fmi3Instance handle, __VA_ARGS__) {                   \
    return refuse((instance *)handle, #function, "is not offered by this FMU");         \
  }
#define NOT_OFFERED_ALONE(function)                                                     \
  FMI3_EXPORT fmi3Status function(fmi3Instance handle) {                                \
    return refuse((instance *)handle, #function, "is not offered by this FMU");         \
  }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
typedef const fmi3ValueReference *references_in;
NOT_OFFERED(fmi3GetAdjointDerivative, references_in unknowns, size_t unknown_count, references_in knowns,
            size_t known_count, const fmi3Float64 *seed, size_t seed_count, fmi3Float64 *sensitivity, size_t count)
NOT_OFFERED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *count)
NOT_OFFERED(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t *dependent_elements,
            fmi3ValueReference *independents, size_t *independent_elements, fmi3DependencyKind *kinds, size_t count)
NOT_OFFERED_ALONE(fmi3EnterConfigurationMode)
NOT_OFFERED_ALONE(fmi3ExitConfigurationMode)
NOT_OFFERED_ALONE(fmi3EnterEventMode)
NOT_OFFERED_ALONE(fmi3EnterStepMode)
NOT_OFFERED_ALONE(fmi3EnterContinuousTimeMode)
NOT_OFFERED_ALONE(fmi3EvaluateDiscreteStates)
NOT_OFFERED(fmi3UpdateDiscreteStates, fmi3Boolean *update_needed, fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
            fmi3Boolean *values_changed, fmi3Boolean *next_defined, fmi3Float64 *next_time)
NOT_OFFERED(fmi3GetIntervalDecimal, references_in references, size_t count, fmi3Float64 *intervals,
            fmi3IntervalQualifier *qualifiers)
NOT_OFFERED(fmi3GetIntervalFraction, references_in references, size_t count, fmi3UInt64 *counters,
            fmi3UInt64 *resolutions, fmi3IntervalQualifier *qualifiers)
NOT_OFFERED(fmi3GetShiftDecimal, references_in references, size_t count, fmi3Float64 *shifts)
NOT_OFFERED(fmi3GetShiftFraction, references_in references, size_t count, fmi3UInt64 *counters, fmi3UInt64 *resolutions)
NOT_OFFERED(fmi3SetIntervalDecimal, references_in references, size_t count, const fmi3Float64 *intervals)
NOT_OFFERED(fmi3SetIntervalFraction, references_in references, size_t count, const fmi3UInt64 *counters,
            const fmi3UInt64 *resolutions)
NOT_OFFERED(fmi3SetShiftDecimal, references_in references, size_t count, const fmi3Float64 *shifts)
NOT_OFFERED(fmi3SetShiftFraction, references_in references, size_t count, const fmi3UInt64 *counters,
            const fmi3UInt64 *resolutions)
NOT_OFFERED(fmi3CompletedIntegratorStep, fmi3Boolean no_set_prior, fmi3Boolean *event_mode, fmi3Boolean *terminate)
NOT_OFFERED(fmi3SetTime, fmi3Float64 time)
NOT_OFFERED(fmi3SetContinuousStates, const fmi3Float64 *states, size_t count)
NOT_OFFERED(fmi3GetContinuousStates, fmi3Float64 *states, size_t count)
NOT_OFFERED(fmi3GetContinuousStateDerivatives, fmi3Float64 *derivatives, size_t count)
NOT_OFFERED(fmi3GetEventIndicators, fmi3Float64 *indicators, size_t count)
NOT_OFFERED(fmi3GetNominalsOfContinuousStates, fmi3Float64 *nominals, size_t count)
NOT_OFFERED(fmi3GetNumberOfEventIndicators, size_t *count)
NOT_OFFERED(fmi3GetNumberOfContinuousStates, size_t *count)
NOT_OFFERED(fmi3GetOutputDerivatives, references_in references, size_t count, const fmi3Int32 *orders,
            fmi3Float64 *values, size_t value_count)
NOT_OFFERED(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

/* Co-simulation of a scene in motion by FMI 3.0, on top of the functions of the library's header.

   The file of the scene that includes this one has defined the sizes, named the functions of the library, and given two
   kernels: the outputs, and their derivatives. What an importer may expect of each function is in the FMI standard
   (https://fmi-standard.org). Value references count through: the time, the inputs, the outputs, the step, the
   parameters of the scene. */

#include <float.h>
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
  FIRST_PARAMETER = STEP + 1,
  VARIABLES = FIRST_PARAMETER + FMU_PARAMETERS,
  N = FMU_UNKNOWNS,
  STATE = 2 * FMU_UNKNOWNS, /* x and v */
  INPUT_ROOM = FMU_INPUTS > 0 ? FMU_INPUTS : 1,
  PARAMETER_ROOM = FMU_PARAMETERS > 0 ? FMU_PARAMETERS : 1
};

static const double DEFAULT_INPUTS[INPUT_ROOM] = FMU_DEFAULTS;
static const double DEFAULT_PARAMETERS[PARAMETER_ROOM] = FMU_PARAMETER_DEFAULTS;

/* Whether each input moves over a communication step: it does if it moves rods or prescribes a length. */
static const int MOVES[INPUT_ROOM] = FMU_MOVES;

/* Whether each input is the first entry of a quaternion. */
static const int BEGINS_QUATERNION[INPUT_ROOM] = FMU_QUATERNIONS;

typedef enum { INSTANTIATED, INITIALISING, STEPPING, TERMINATED } mode;

/* All that a step depends on: what fmi3GetFMUState copies. */
typedef struct {
  fmu_state state;
  fmu_memory memory;
  double inputs[INPUT_ROOM];      /* that the state has seen */
  double inputs_rate[INPUT_ROOM]; /* there */
  double time;
} moment;

/* What a copy of an instance holds. */
typedef struct {
  moment now;
  moment before; /* at the start of the last communication step */
  double last_step;
  double lead;              /* of the rate at its end */
  double sign[INPUT_ROOM];  /* signs of its inputs over the given inputs: a quaternion may be negated */
  double given[INPUT_ROOM]; /* inputs as the importer set them */
  double parameters[PARAMETER_ROOM];
  double step;
  mode mode;
} snapshot;

typedef struct {
  snapshot held;
  fmu_workspace workspace;
  double outputs[FMU_OUTPUTS];
  double d_outputs_d_state[FMU_OUTPUTS * STATE];
  double d_outputs_d_inputs[FMU_OUTPUTS * INPUT_ROOM];
  double d_outputs_d_parameters[FMU_OUTPUTS * PARAMETER_ROOM];
  double d_outputs_d_rate[FMU_OUTPUTS * INPUT_ROOM];
  double d_next_d_state[STATE * STATE];
  double d_next_d_inputs[STATE * INPUT_ROOM];
  double d_next_d_rate[STATE * INPUT_ROOM];
  double d_next_d_acceleration[STATE * INPUT_ROOM];
  double d_x_d_inputs[N * INPUT_ROOM]; /* at the start */
  double d_x_d_parameters[N * PARAMETER_ROOM];
  double state_change[STATE]; /* along a direction */
  moment kept; /* of one call; too large for the stack of a thread */
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
  bool logging;
} instance;

/* Whether a variable is one of those from first up to end. */
static int is_between(fmi3ValueReference reference, int first, int end) {
  return reference >= (fmi3ValueReference)first && reference < (fmi3ValueReference)end;
}

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

#include "fmi3_instances.c"
#include "fmi3_course.c"
#include "fmi3_steps.c"
#include "fmi3_values.c"
#include "fmi3_states.c"
#include "fmi3_derivatives.c"
#include "fmi3_missing.c"

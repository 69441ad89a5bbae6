/* How inputs move over a communication step.

   Loads move in a straight line from their value at its start to the one that was given: held at one of the two, they
   would be late or early by half a step. What moves rods or prescribes a length needs rates and accelerations, and the
   importer gives a value for the end of each communication step alone. The rate at the end of a step is that of the
   parabola through the last three values; the first step begins at rest, and its parabola without a rate. Two
   accelerations, one in each half of the step, lead from value and rate at its start to those at its end. So neither
   values nor rates jump; on a smooth path they are right to the third and to the second power of the step. */

/* Values at both ends of a communication step, and rates. */
typedef struct {
  const double *from;
  const double *from_rate;
  const double *to;
  const double *to_rate;
  double duration; /* s */
} course;

/* Inputs at one time, with what they do in the integrator's step that begins there. */
typedef struct {
  double value[INPUT_ROOM];
  double rate[INPUT_ROOM];
  double acceleration[INPUT_ROOM];
} moving_inputs;

/* Writes the given inputs, with each quaternion on the side of the last one, and the signs for this: q and -q are the
   same orientation, but the way between them is none. */
static void on_one_side(const snapshot *held, double *to, double *sign) {
  for (int i = 0; i < FMU_INPUTS; i++) {
    sign[i] = 1;
    to[i] = held->given[i];
  }
  for (int first = 0; first < FMU_INPUTS; first++) {
    double cosine = 0;
    if (!BEGINS_QUATERNION[first]) continue;
    for (int i = first; i < first + 4; i++) cosine += held->now.inputs[i] * to[i];
    for (int i = first; i < first + 4 && cosine < 0; i++) {
      sign[i] = -1;
      to[i] = -to[i];
    }
  }
}

/* Rate at the end of a step minus its mean rate, over the change of the mean rate. */
static double lead_of_rate(const snapshot *held, double duration) {
  return held->last_step > 0 ? duration / (duration + held->last_step) : 1;
}

static double rate_at_end(const snapshot *held, int input, double given, double duration) {
  const double now = held->now.inputs[input];
  const double mean = (given - now) / duration;
  const double mean_before = held->last_step > 0 ? (now - held->before.inputs[input]) / held->last_step : 0;
  return mean + lead_of_rate(held, duration) * (mean - mean_before);
}

/* Inputs at a time after the start of a communication step, s, by the acceleration of its first or second half. */
static void inputs_on(const course *way, double time, int is_second_half, moving_inputs *at) {
  const double left = way->duration - time;
  for (int i = 0; i < FMU_INPUTS; i++) {
    const double mean_rate = (way->to[i] - way->from[i]) / way->duration;
    at->value[i] = way->from[i] + time * mean_rate;
    at->rate[i] = mean_rate;
    at->acceleration[i] = 0;
    if (!MOVES[i]) continue;
    const double sooner = 4 * (mean_rate - way->from_rate[i]) / way->duration;
    const double mean = (way->to_rate[i] - way->from_rate[i]) / way->duration;
    if (is_second_half) {
      const double acceleration = 3 * mean - sooner;
      at->value[i] = way->to[i] - left * (way->to_rate[i] - left / 2 * acceleration);
      at->rate[i] = way->to_rate[i] - left * acceleration;
      at->acceleration[i] = acceleration;
    } else {
      const double acceleration = sooner - mean;
      at->value[i] = way->from[i] + time * (way->from_rate[i] + time / 2 * acceleration);
      at->rate[i] = way->from_rate[i] + time * acceleration;
      at->acceleration[i] = acceleration;
    }
  }
}

/* Number of steps of the integrator in a communication step: even if an input moves, so that each half has as many. */
static int count_steps(const snapshot *held, double duration) {
  int halves = 1;
  for (int i = 0; i < FMU_INPUTS; i++) halves = MOVES[i] ? 2 : halves;
  const double count = ceil(duration / halves / held->step - 1e-9);
  return count < 1 ? halves : halves * (int)count;
}

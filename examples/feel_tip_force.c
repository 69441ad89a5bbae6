/* A moving tendon robot feels a force at its tip: the extended Kalman filter of feel_tip_force.py in C.

   It is compiled with the folder that `python examples/feel_tip_force.py --export robot` writes:

     gcc -O2 -Irobot examples/feel_tip_force.c robot/robot.c robot/robot_kernels.c -lm -o feel

   Each line of its input is a measurement, 4 ms after the one before: four tensions in N, then the place of the tip in
   m. It answers each with a line: the force in N, then its standard deviations. */
#include "robot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
  SIZE = ROBOT_UNKNOWNS,
  MOTION = 2 * SIZE,
  ENTRIES = MOTION + 3, /* unknowns, velocities, force */
  FORCE = ROBOT_INPUT_TOUCH_FORCE,
  TENDONS = 4
};

static const double PERIOD = 4e-3;                           /* s */
static const double CAMERA = 5e-4, GAUGE = 0.05;             /* m, N */
static const double WANDER = 0.1, JOLTS = 0.02;              /* N over a second, 1/s in a period */
static const double SPREAD[3] = {1e-3, 1e-2, 0.05};          /* of unknowns, velocities, force at first */
static const double PULLS[TENDONS] = {8, 2, 9, 4};           /* N */
static const int TENSIONS[TENDONS] = {
    ROBOT_INPUT_LOWER_EAST_TENSION,
    ROBOT_INPUT_LOWER_NORTH_TENSION,
    ROBOT_INPUT_UPPER_WEST_TENSION,
    ROBOT_INPUT_UPPER_SOUTH_TENSION,
};

/* What the robot believes of itself; the covariance is that of unknowns, velocities and force. */
typedef struct {
  robot_state state;
  robot_step_memory memory;
  double force[3];
  double covariance[ENTRIES][ENTRIES];
} belief;

static robot_workspace workspace;

static void set_inputs(const double *force, const double *tensions, double *inputs) {
  memset(inputs, 0, ROBOT_INPUTS * sizeof *inputs);
  for (int i = 0; i < 3; i++) inputs[FORCE + i] = force[i];
  for (int i = 0; i < TENDONS; i++) inputs[TENSIONS[i]] = tensions[i];
}

/* At rest and untouched, as far as one knows. Zero where there is no such state. */
static int begin(belief *now) {
  double inputs[ROBOT_INPUTS], x[SIZE] = {0};
  memset(now, 0, sizeof *now);
  set_inputs(now->force, PULLS, inputs);
  if (robot_solve(inputs, x, &workspace, 0) != ROBOT_CONVERGED) return 0;
  if (robot_rest(inputs, x, &now->state, &workspace) != ROBOT_MOTION_DONE) return 0;
  for (int i = 0; i < ENTRIES; i++) {
    const double deviation = SPREAD[i / SIZE];
    now->covariance[i][i] = deviation * deviation;
  }
  return 1;
}

/* sum = left right, or with the right one transposed. */
static void multiply(double left[ENTRIES][ENTRIES], double right[ENTRIES][ENTRIES], int transposed,
                     double sum[ENTRIES][ENTRIES]) {
  for (int i = 0; i < ENTRIES; i++) {
    for (int j = 0; j < ENTRIES; j++) {
      double entry = 0;
      for (int k = 0; k < ENTRIES; k++) entry += left[i][k] * (transposed ? right[j][k] : right[k][j]);
      sum[i][j] = entry;
    }
  }
}

/* One period on, with the tensions that were measured. Zero where the step cannot be computed. */
static int predict(belief *now, const double *tensions) {
  static double by_start[MOTION * MOTION], by_inputs[MOTION * ROBOT_INPUTS];
  static double transition[ENTRIES][ENTRIES], product[ENTRIES][ENTRIES];
  double inputs[ROBOT_INPUTS];
  set_inputs(now->force, tensions, inputs);
  if (robot_step_sensitivity(inputs, 0, PERIOD, &now->state, &now->memory, 0, by_start, by_inputs, 0, 0, &workspace, 0) !=
      ROBOT_MOTION_DONE) {
    return 0;
  }
  memset(transition, 0, sizeof transition);
  for (int i = 0; i < MOTION; i++) {
    for (int j = 0; j < MOTION; j++) transition[i][j] = by_start[j * MOTION + i];
    for (int j = 0; j < 3; j++) transition[i][MOTION + j] = by_inputs[(FORCE + j) * MOTION + i];
  }
  for (int j = 0; j < 3; j++) transition[MOTION + j][MOTION + j] = 1;
  multiply(transition, now->covariance, 0, product);
  multiply(product, transition, 1, now->covariance);
  for (int k = 0; k < TENDONS; k++) {
    const double *pull = by_inputs + TENSIONS[k] * MOTION;
    for (int i = 0; i < MOTION; i++) {
      for (int j = 0; j < MOTION; j++) now->covariance[i][j] += GAUGE * GAUGE * pull[i] * pull[j];
    }
  }
  for (int i = 0; i < SIZE; i++) now->covariance[SIZE + i][SIZE + i] += JOLTS * JOLTS;
  for (int i = 0; i < 3; i++) now->covariance[MOTION + i][MOTION + i] += WANDER * WANDER * PERIOD;
  return 1;
}

/* The covariance after one coordinate was seen, in Joseph's form. */
static void reduce(belief *now, const double *row, const double *gain) {
  static double left[ENTRIES][ENTRIES], product[ENTRIES][ENTRIES];
  for (int i = 0; i < ENTRIES; i++) {
    for (int j = 0; j < ENTRIES; j++) left[i][j] = (i == j) - (j < SIZE ? gain[i] * row[j] : 0);
  }
  multiply(left, now->covariance, 0, product);
  multiply(product, left, 1, now->covariance);
  for (int i = 0; i < ENTRIES; i++) {
    for (int j = 0; j < ENTRIES; j++) now->covariance[i][j] += CAMERA * CAMERA * gain[i] * gain[j];
  }
}

/* The belief after the tip was seen; coordinate after coordinate, so that nothing is inverted. */
static void correct(belief *now, const double *seen) {
  static double d_pose_d_x[7 * SIZE], d_pose_d_inputs[7 * ROBOT_INPUTS];
  double inputs[ROBOT_INPUTS], tip[3], quaternion[4], change[ENTRIES] = {0};
  set_inputs(now->force, PULLS, inputs);
  robot_tip(now->state.x, inputs, tip, quaternion);
  robot_tip_jacobian(now->state.x, inputs, d_pose_d_x, d_pose_d_inputs);
  for (int axis = 0; axis < 3; axis++) {
    double row[SIZE], gain[ENTRIES];
    double variance = CAMERA * CAMERA, innovation = seen[axis] - tip[axis];
    for (int k = 0; k < SIZE; k++) row[k] = d_pose_d_x[7 * k + axis];
    for (int i = 0; i < ENTRIES; i++) {
      gain[i] = 0;
      for (int k = 0; k < SIZE; k++) gain[i] += now->covariance[i][k] * row[k];
    }
    for (int k = 0; k < SIZE; k++) {
      variance += row[k] * gain[k];
      innovation -= row[k] * change[k];
    }
    for (int i = 0; i < ENTRIES; i++) {
      gain[i] /= variance;
      change[i] += gain[i] * innovation;
    }
    reduce(now, row, gain);
  }
  for (int i = 0; i < SIZE; i++) {
    now->state.x[i] += change[i];
    now->state.v[i] += change[SIZE + i];
  }
  for (int i = 0; i < 3; i++) now->force[i] += change[MOTION + i];
}

int main(void) {
  static belief now;
  double tensions[TENDONS], seen[3];
  if (!begin(&now)) {
    fprintf(stderr, "the robot has no state at rest\n");
    return 1;
  }
  while (scanf("%lf %lf %lf %lf %lf %lf %lf", tensions, tensions + 1, tensions + 2, tensions + 3, seen, seen + 1,
               seen + 2) == 7) {
    if (!predict(&now, tensions)) {
      fprintf(stderr, "a step cannot be computed\n");
      return 1;
    }
    correct(&now, seen);
    for (int i = 0; i < 3; i++) printf("%.17g ", now.force[i]);
    for (int i = 0; i < 3; i++) printf("%.17g%c", sqrt(now.covariance[MOTION + i][MOTION + i]), i < 2 ? ' ' : '\n');
  }
  return 0;
}

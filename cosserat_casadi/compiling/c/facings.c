/* Rods and bodies of a simulated motion, and what each may touch: an obstacle, or another rod. Functions of the model come
   from Python; PointsRecord and FacingRecord in cosserat_casadi/motion/contact_law.py have these layouts. moving_contacts.c
   and rubbing_steps.c include this file. Uses: kernel, workspace. */

/* The nodes of a rod, those of another rod behind them, or the origin of a body. */
typedef struct {
  int count;
  int unknowns; /* numbers of the arguments of the functions */
  int inputs;
  int is_known; /* whether the positions were computed before */
  kernel *positions;
  kernel *velocities; /* null in the law without friction, as the second derivative */
  kernel *gradient;   /* of the sum of positions by weights */
  kernel *hessian;    /* second derivative of this sum */
  const real *shares; /* unit of the work of forces, in that of each balance; null where all are equal */
} moving_points;

/* A rod or the ball of a body, and an obstacle or another rod that it may touch. */
typedef struct facing_rod {
  moving_points *points;
  int is_body;
  int elements;
  int nodes;
  int watches_base;
  int watches_tip;
  int laid_count;
  const real *ends;
  const real *to_coefficients;
  const real *looks;
  const real *laid;
  real length;
  real force_unit;
  real radius_at_base;
  real radius_at_tip;
  real restitution;
  real stride;
  real coefficients[3]; /* of friction along a rod, back, and across it */
  kernel *surface;      /* point to distance, normal, curvature; null where another rod is in the place of an obstacle */
  kernel *distance;     /* point to distance; null for another rod */
  kernel *rubbing;      /* state and section to velocity along the surface; null without friction */
  real *fitted;         /* room for coefficients of the polynomials through the nodes */
  real *gaps_along;     /* room for the gaps that are looked at first */
  struct facing_rod *other; /* rod that it may touch in the place of an obstacle, whose points stand behind its own; or null */
  real *seen_from;          /* point from which that rod is seen; null without it */
  real *looked_at;          /* positions of the sections of that rod that are looked at first */
  real *balls;              /* centre and radius of a ball about these sections of each element of that rod */
} facing;

#define fitted_of(own, work) (own)->fitted
#define gaps_of(own, work) (own)->gaps_along
#define point_count(own) (own)->points->count
#define seen_from_of(own, work) (own)->seen_from
#define looked_at_of(own, work) (own)->looked_at
#define balls_of(own, work) (own)->balls

/* Unit of the work of forces, in that of a balance. */
static real share_of(const facing *own, int balance) { return own->points->shares ? own->points->shares[balance] : 1; }

/* ---- Functions of the model ---- */

/* The place behind the last number that was written into the arguments of a function. */
typedef struct {
  kernel *function;
  int argument;
  int filled;
} writing;

/* Writes numbers at this place, and goes on in the next argument where one is full. Returns whether the numbers differ
   from those of the last call. */
static int put(writing *to, const real *values, int count) {
  kernel *own = to->function;
  int is_new = 0;
  while (count > 0) {
    const int room = own->counts[to->argument] - to->filled;
    const int most = count < room ? count : room;
    const size_t bytes = (size_t)most * sizeof *values;
    real *place = own->arguments[to->argument] + to->filled;
    if (memcmp(place, values, bytes)) {
      is_new = 1;
      memcpy(place, values, bytes);
    }
    values += most;
    count -= most;
    to->filled += most;
    if (most == room) {
      to->argument++;
      to->filled = 0;
    }
  }
  return is_new;
}

/* Calls a function whose arguments are written. The result is NaN if Python raised an exception. */
static const real *result_of(kernel *function, int count) {
  if (!call(function)) {
    for (int i = 0; i < count; i++) function->result[i] = NAN;
  }
  return function->result;
}

/* Positions of the points, computed once for repeated calls with a state. */
static const real *positions_at(moving_points *points, const real *x, const real *inputs) {
  writing to = {points->positions, 0, 0};
  const int is_new = put(&to, x, points->unknowns) | put(&to, inputs, points->inputs);
  if (is_new || !points->is_known) points->is_known = isfinite(*result_of(points->positions, 3 * points->count));
  return points->positions->result;
}

#include "struck_rods.h"

static void surface_at(const facing *own, const real *point, real *distance, real *normal, real *curvature,
                       workspace *work) {
  writing to = {own->surface, 0, 0};
  (void)work;
  put(&to, point, 3);
  const real *found = result_of(own->surface, 13);
  *distance = found[0];
  memcpy(normal, found + 1, 3 * sizeof *normal);
  memcpy(curvature, found + 4, 9 * sizeof *curvature);
}

static real distance_at(const facing *own, const real *point, workspace *work) {
  writing to = {own->distance, 0, 0};
  if (own->other) return distance_from_other(own, point, work);
  put(&to, point, 3);
  return *result_of(own->distance, 1);
}

#include "contact_gaps.c"

#include "struck_rods.c"

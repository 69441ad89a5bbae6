/* Rods and bodies of a simulated motion, and what each may touch: an obstacle, or another rod. Functions of the model come
   from Python; PointsRecord and FacingRecord in cosserat_casadi/motion/contact_law.py have these layouts. moving_contacts.c
   and rubbing_steps.c include this file. Uses: kernel, workspace. */

#define RODS_FACE_RODS

/* The nodes of a rod, those of another rod behind them, or the origin of a body. */
typedef struct {
  int count;
  int unknowns; /* numbers of the arguments of the functions */
  int inputs;
  int is_known; /* whether the positions were asked for before */
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
  kernel *distance;     /* point to distance; null there */
  kernel *rubbing;      /* state and section to velocity along the surface; null without friction */
  real *fitted;         /* room for coefficients of the polynomials through the nodes */
  real *gaps_along;     /* room for the gaps that are looked at first */
  struct facing_rod *other; /* rod that it may touch in the place of an obstacle, whose points stand behind its own; or null */
  real *seen_from;          /* of such a rod: the point that it is looked at from; else null */
  real *looked_at;          /* of such a rod: positions of the sections that are looked at first */
  real *balls;              /* of such a rod: centre and radius of a ball about these sections of each element */
  void *nearest;            /* of such a rod: its section that is nearest to that point */
} facing;

#define fitted_of(own, work) (own)->fitted
#define gaps_of(own, work) (own)->gaps_along

/* Unit of the work of forces, in that of a balance. */
static real share_of(const facing *own, int balance) { return own->points->shares ? own->points->shares[balance] : 1; }

/* ---- Functions of the model ---- */

/* The place behind the last number that was written into the arguments of a function. */
typedef struct {
  kernel *function;
  int argument;
  int filled;
} writing;

/* Writes numbers at this place; where an argument is full, they go on in the next one. Returns whether they are others than
   those of the last call. */
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

/* Positions of the points, which are computed once for a state that is asked for again. */
static const real *positions_at(moving_points *points, const real *x, const real *inputs) {
  writing to = {points->positions, 0, 0};
  const int is_new = put(&to, x, points->unknowns) | put(&to, inputs, points->inputs);
  if (is_new || !points->is_known) points->is_known = isfinite(*result_of(points->positions, 3 * points->count));
  return points->positions->result;
}

static void surface_of_other(const facing *own, const real *point, real *distance, real *normal, real *curvature);
static void surface_of_point(const real *from, const real *point, real *distance, real *normal, real *curvature);

static void surface_at(const facing *own, const real *point, real *distance, real *normal, real *curvature,
                       workspace *work) {
  writing to = {own->surface, 0, 0};
  (void)work;
  if (own->other) {
    surface_of_other(own, point, distance, normal, curvature);
    return;
  }
  if (own->seen_from) {
    surface_of_point(own->seen_from, point, distance, normal, curvature);
    return;
  }
  put(&to, point, 3);
  const real *found = result_of(own->surface, 13);
  *distance = found[0];
  memcpy(normal, found + 1, 3 * sizeof *normal);
  memcpy(curvature, found + 4, 9 * sizeof *curvature);
}

static real distance_at(const facing *own, const real *point, workspace *work) {
  writing to = {own->distance, 0, 0};
  if (!own->distance) {
    real distance, normal[3], curvature[9];
    surface_at(own, point, &distance, normal, curvature, work);
    return distance;
  }
  put(&to, point, 3);
  return *result_of(own->distance, 1);
}

static void fit_other(const facing *own, const real *nodes);
static void weigh_other(const facing *own);
static void add_other(const facing *own, real times, const real *normal, real *weights);
static void add_row_of_other(const facing *own, int row, const real *direction, real *weights);
static void turn_slope_of_other(const facing *own, const real *tangent, real *moved);
static real turning_beside_other(const facing *own, const real *moved, const real *more);

/* Numbers that a change moves: position, or way from the section of another rod, and slopes of the gap along both rods. */
enum { OWN_SLOPE = 3, OTHER_SLOPE = 4, MOVED = 5 };

#include "contact_gaps.c"

/* ---- Another rod in the place of an obstacle ---- */

/* Distance of a point from another one, with its derivatives. */
static void surface_of_point(const real *from, const real *point, real *distance, real *normal, real *curvature) {
  real way[3];
  for (int i = 0; i < 3; i++) way[i] = point[i] - from[i];
  const real length = SQUARE_ROOT(inner(way, way));
  /* Where both are one no direction is known. */
  *distance = length > NEXT_TO_NOTHING ? length : NEXT_TO_NOTHING;
  for (int i = 0; i < 3; i++) normal[i] = way[i] / *distance;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) curvature[3 * i + j] = ((i == j) - normal[i] * normal[j]) / *distance;
  }
}

/* Whether a nearest section stays at an end of its rod. */
static int is_at_end(const section_gap *nearest) { return nearest->place <= AT_END || nearest->place >= 1 - AT_END; }

static real way_between(const real *a, const real *b) {
  const real way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return SQUARE_ROOT(inner(way, way));
}

/* Finds the section of a rod that is nearest to a point: of those that are looked at first, then next to that one. Elements
   in whose balls all is farther than what is found are passed over; the element that was nearest last is looked at first. */
static void find_nearest(const facing *rod, const real *point) {
  section_gap *nearest = rod->nearest;
  const real taper = rod->radius_at_tip - rod->radius_at_base;
  const real widest = taper > 0 ? taper : 0;
  const int last = nearest->nodes ? nearest->first / rod->nodes : 0;
  int look = 0;
  real least = INFINITY;
  for (int k = 0; k < rod->elements; k++) {
    const int e = (last + k) % rod->elements;
    const real *ball = rod->balls + 4 * e;
    if (way_between(ball, point) - ball[3] - widest >= least) continue;
    for (int i = e * LOOKS; i <= (e + 1) * LOOKS; i++) {
      const real distance = way_between(rod->looked_at + 3 * i, point) - taper * place_of_look(rod, i);
      if (!(distance < least)) continue;
      least = distance;
      look = i;
    }
  }
  memcpy(rod->seen_from, point, 3 * sizeof *point);
  look_lowest_by(rod, look, nearest, 0);
}

/* Positions of the sections of a rod that are looked at first, and a ball about those of each element: its centre is the
   middle one, its radius the largest distance from there. */
static void place_looks(const facing *rod, const real *nodes) {
  for (int i = 0; i <= rod->elements * LOOKS; i++) {
    const int e = i / LOOKS < rod->elements ? i / LOOKS : rod->elements - 1;
    const real *weights = rod->looks + (i - e * LOOKS) * rod->nodes;
    real *at = rod->looked_at + 3 * i;
    at[0] = at[1] = at[2] = 0;
    for (int k = 0; k < rod->nodes; k++) {
      for (int j = 0; j < 3; j++) at[j] += weights[k] * nodes[3 * (e * rod->nodes + k) + j];
    }
  }
  for (int e = 0; e < rod->elements; e++) {
    real *ball = rod->balls + 4 * e;
    memcpy(ball, rod->looked_at + 3 * (e * LOOKS + LOOKS / 2), 3 * sizeof *ball);
    ball[3] = 0;
    for (int i = e * LOOKS; i <= (e + 1) * LOOKS; i++) {
      const real distance = way_between(ball, rod->looked_at + 3 * i);
      if (distance > ball[3]) ball[3] = distance;
    }
  }
}

/* The other rod is looked at by these positions from now on, if there is one. */
static void fit_other(const facing *own, const real *nodes) {
  if (!own->other) return;
  const real *of_other = nodes + 3 * own->elements * own->nodes;
  fit_nodes(own->other, of_other, 0);
  place_looks(own->other, of_other);
}

/* The surface of the other rod: its distance is that of its nearest section, which goes along as the point moves. */
static void surface_of_other(const facing *own, const real *point, real *distance, real *normal, real *curvature) {
  const facing *rod = own->other;
  const section_gap *nearest = rod->nearest;
  find_nearest(rod, point);
  *distance = nearest->value * rod->length;
  for (int i = 0; i < 3; i++) normal[i] = -nearest->normal[i];
  memcpy(curvature, nearest->curvature, 9 * sizeof *curvature);
  if (is_at_end(nearest)) return;
  real turned[3];
  for (int i = 0; i < 3; i++) turned[i] = inner(nearest->curvature + 3 * i, nearest->tangent);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) curvature[3 * i + j] -= turned[i] * turned[j] / (nearest->bend * rod->length);
  }
}

/* The section of the other rod that was nearest at the last look of a pair; null beside an obstacle. Its gap is its distance
   from the point, its normal is the direction from the point to it. */
static section_gap *other_section(const facing *own) { return own->other ? own->other->nearest : 0; }

/* Index, among all points of a pair, of the first node of an element of the other rod that its nearest section lies in. */
static int first_of_other(const facing *own) { return own->elements * own->nodes + other_section(own)->first; }

/* Weights of its nodes for the section of the other rod, if there is one. */
static void weigh_other(const facing *own) {
  if (own->other) weigh_nodes(own->other, other_section(own));
}

/* Adds weights of the nodes of the other rod, if there is one, whose section takes part in a gap with this normal. */
static void add_other(const facing *own, real times, const real *normal, real *weights) {
  const section_gap *other = other_section(own);
  if (other) add_section(other, -times, own->length, normal, weights + 3 * own->elements * own->nodes);
}

/* ---- How the other rod, if there is one, takes part in derivatives of a gap at the last look ---- */

/* Part of the rate of a gap that is of the other rod, of velocities of the points. */
static real rate_of_other(const facing *own, const real *normal, const real *velocities) {
  const section_gap *other = other_section(own);
  real rate = 0;
  if (!other) return 0;
  for (int i = 0; i < other->nodes; i++) {
    rate -= other->rows[0][i] * inner(normal, velocities + 3 * (first_of_other(own) + i));
  }
  return rate;
}

/* Adds to weights of the points those of a row of row_weights: the way from the other section to the own one along an axis;
   nothing of the slope along the own rod; the tangent of the other rod along the normal. */
static void add_row_of_other(const facing *own, int row, const real *direction, real *weights) {
  const section_gap *other = other_section(own);
  if (!other || row == OWN_SLOPE) return;
  const int is_slope = row == OTHER_SLOPE;
  for (int i = 0; i < other->nodes; i++) {
    const real share = is_slope ? other->rows[1][i] : -other->rows[0][i];
    for (int k = 0; k < 3; k++) weights[3 * (first_of_other(own) + i) + k] = share * direction[k];
  }
}

/* Adds to the derivatives of both slopes what the turning normal adds, from those of the way between both sections, where the
   section of the other rod slides. The curvature of the gap has in it that this section slides as the way changes. */
static void turn_slope_of_other(const facing *own, const real *tangent, real *moved) {
  const section_gap *other = other_section(own);
  if (!other || is_at_end(other)) return;
  real turned[3];
  for (int i = 0; i < 3; i++) turned[i] = inner(other->curvature + 3 * i, other->tangent);
  moved[OWN_SLOPE] -= inner(tangent, turned) / (other->bend * own->other->length) * moved[OTHER_SLOPE];
  moved[OTHER_SLOPE] += inner(turned, moved);
}

/* Second derivative of the distance, by two numbers that move both sections, as both are held and the other one then slides. */
static real turning_beside_other(const facing *own, const real *moved, const real *more) {
  const section_gap *other = other_section(own);
  real sum = 0;
  for (int k = 0; k < 3; k++) sum += moved[k] * inner(other->curvature + 3 * k, more);
  return is_at_end(other) ? sum : sum - moved[OTHER_SLOPE] * more[OTHER_SLOPE] / (other->bend * own->other->length);
}

/* Writes weights of the other rod's nodes and its abscissa behind those of the own rod. */
static void put_other_section(const facing *own, real *section) {
  const section_gap *other = other_section(own);
  if (!other) return;
  memcpy(section + first_of_other(own), other->rows[0], (size_t)other->nodes * sizeof *section);
  section[own->points->count + 1] = other->place;
}

/* Gaps and contacts of a simulated motion: where rods and bodies touch, and what forces there do. It is compiled once, for
   models of all sizes; contact_gaps.c, which exported steps have too, says what a gap is. */

/* What is compiled for speed waits for it: the functions that take most of the time are elsewhere. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O1")
#endif

#include <math.h>
#include <string.h>

#include "moving_contacts.h"

typedef double real;
#define ABSOLUTE fabs
#define SQUARE_ROOT sqrt

#include "python_kernels.c"

/* The nodes of a rod, or the origin of a body. */
typedef struct {
  int count;
  int is_known; /* whether their positions were asked for before */
  kernel *positions;
  kernel *gradient; /* of the sum of positions by weights */
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
  real radius_at_base;
  real radius_at_tip;
  kernel *surface;  /* point to distance, normal, curvature; null where another rod is in the place of an obstacle */
  kernel *distance; /* point to distance; null there */
  real *coefficients;
  real *gaps_along;
  struct facing_rod *other; /* rod that it may touch in the place of an obstacle, whose points stand behind its own; or null */
  real *seen_from;          /* of such a rod: the point that it is looked at from; else null */
  real *looked_at;          /* of such a rod: positions of the sections that are looked at first */
  real *balls;              /* of such a rod: centre and radius of a ball about these sections of each element */
  void *nearest;            /* of such a rod: its section that is nearest to that point */
} facing;

/* A contact; where it slides the place is that next to which it is looked for. */
typedef struct {
  const facing *facing;
  int slides;
  int element;
  real place;
  real height; /* gap that it keeps */
} touch;

/* Room of a pair, or of constraints of which some push. */
typedef struct {
  real *coefficients;
  real *gaps_along;
  real *scaled_compliance;
  real *scales;
  real *small_values;
  real *small_matrix;
  int *small_pivots;
  int *active;
  int *passed_over;
} workspace;

static real larger(real a, real b) { return a > b ? a : b; }

static int all_finite(const real *a, int count) {
  real sum = 0;
  for (int i = 0; i < count; i++) sum += a[i] * 0;
  return sum == 0;
}

/* Writes an argument; whether it is another one than that of the last call. */
static int give(kernel *function, int number, const real *values) {
  const size_t bytes = (size_t)function->counts[number] * sizeof *values;
  if (!memcmp(function->arguments[number], values, bytes)) return 0;
  memcpy(function->arguments[number], values, bytes);
  return 1;
}

static void surface_of_other(const facing *own, const real *point, real *distance, real *normal, real *curvature);
static void surface_of_point(const real *from, const real *point, real *distance, real *normal, real *curvature);

static void surface_at(const facing *own, const real *point, real *distance, real *normal, real *curvature,
                       workspace *work) {
  (void)work;
  if (!own->surface) {
    if (own->other) {
      surface_of_other(own, point, distance, normal, curvature);
    } else {
      surface_of_point(own->seen_from, point, distance, normal, curvature);
    }
    return;
  }
  const real *found = own->surface->result;
  give(own->surface, 0, point);
  call(own->surface);
  *distance = found[0];
  memcpy(normal, found + 1, 3 * sizeof *normal);
  memcpy(curvature, found + 4, 9 * sizeof *curvature);
}

static real distance_at(const facing *own, const real *point, workspace *work) {
  if (!own->distance) {
    real distance, normal[3], curvature[9];
    surface_at(own, point, &distance, normal, curvature, work);
    return distance;
  }
  give(own->distance, 0, point);
  call(own->distance);
  return own->distance->result[0];
}

#include "contact_gaps.c"
#include "square_systems.c"
#include "least_pushes.c"

/* A gap, and the section of the other rod that is nearest, where there is one: its distance from the point in its own
   length, and the direction from the point to it. */
typedef struct {
  section_gap own;
  section_gap other;
} met_gap;

/* ---- Another rod in the place of an obstacle ---- */

/* Distance of a point from another one, with its derivatives. */
static void surface_of_point(const real *from, const real *point, real *distance, real *normal, real *curvature) {
  real way[3];
  for (int i = 0; i < 3; i++) way[i] = point[i] - from[i];
  /* Where both are one no direction is known. */
  *distance = larger(SQUARE_ROOT(inner(way, way)), NEXT_TO_NOTHING);
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
  workspace room = {.coefficients = rod->coefficients, .gaps_along = rod->gaps_along};
  section_gap *nearest = rod->nearest;
  const real taper = rod->radius_at_tip - rod->radius_at_base;
  const int last = nearest->nodes ? nearest->first / rod->nodes : 0;
  int look = 0;
  real least = INFINITY;
  for (int k = 0; k < rod->elements; k++) {
    const int e = (last + k) % rod->elements;
    const real *ball = rod->balls + 4 * e;
    if (way_between(ball, point) - ball[3] - larger(taper, 0) >= least) continue;
    for (int i = e * LOOKS; i <= (e + 1) * LOOKS; i++) {
      const real distance = way_between(rod->looked_at + 3 * i, point) - taper * place_of_look(rod, i);
      if (!(distance < least)) continue;
      least = distance;
      look = i;
    }
  }
  memcpy(rod->seen_from, point, 3 * sizeof *point);
  look_lowest_by(rod, look, nearest, &room);
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
    for (int i = e * LOOKS; i <= (e + 1) * LOOKS; i++) ball[3] = larger(ball[3], way_between(ball, rod->looked_at + 3 * i));
  }
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

/* The section of the other rod next to a gap that was looked at last, with the weights of its nodes among all points. */
static void weigh_other(const facing *own, met_gap *gap) {
  if (!own->other) return;
  memcpy(&gap->other, own->other->nearest, sizeof gap->other);
  weigh_nodes(own->other, &gap->other);
  gap->other.first += own->elements * own->nodes;
}

/* ---- Gaps of a pair, at positions of its points ---- */

/* Room of a pair; another rod is looked at by these positions from now on. */
static workspace room_of(const facing *own, const real *nodes) {
  const facing *rod = own->other;
  if (rod) {
    const real *of_rod = nodes + 3 * own->elements * own->nodes;
    workspace room = {.coefficients = rod->coefficients, .gaps_along = rod->gaps_along};
    fit_nodes(rod, of_rod, &room);
    place_looks(rod, of_rod);
  }
  const workspace room = {.coefficients = own->coefficients, .gaps_along = own->gaps_along};
  return room;
}

/* The element that a section is looked at in, or that of the section itself where it is farther beyond that one's ends. */
static int element_near(const facing *own, real place, int element) {
  const int is_near = own->ends[element] - BEYOND <= place && place <= own->ends[element + 1] + BEYOND;
  return is_near ? element : element_of(own, place);
}

/* Newton's method for a place where the slope is zero; not a number where it leads nowhere. */
static real stationary(const facing *own, real near, int element, workspace *work) {
  real place = near;
  for (int k = 0; k < MOST_PLACINGS; k++) {
    const int number = element_near(own, place, element);
    section_gap gap;
    look_in(own, number, place, &gap, work);
    if (!(gap.bend > 0)) return NAN;
    const real change = -gap.slope / gap.bend;
    place += change;
    if (!(-BEYOND <= place && place <= 1 + BEYOND)) return NAN;
    /* Beyond its element the gap is that of the next one. */
    if (ABSOLUTE(change) <= PLACED && element_near(own, place, element) == number) break;
  }
  return place;
}

/* Number of the section, of those looked at first, that is least in the valley of a place. */
static int downhill(const facing *own, const real *gaps, int count, real near) {
  int look = 0;
  for (int i = 1; i < count; i++) {
    if (ABSOLUTE(place_of_look(own, i) - near) < ABSOLUTE(place_of_look(own, look) - near)) look = i;
  }
  while (look > 0 && gaps[look - 1] < gaps[look]) look--;
  while (look < count - 1 && gaps[look + 1] < gaps[look]) look++;
  return look;
}

/* Place next to another where the gap is least, by the polynomials of an element; not beyond the ends by more than a
   little. */
static real place_near(const facing *own, const real *nodes, real near, int element, workspace *work) {
  const real first = own->ends[element];
  const real last = own->ends[element + 1];
  real place = stationary(own, near, element, work);
  if (ABSOLUTE(place - near) <= FAR) return place;
  /* Down the gaps from section to section no other minimum can be met. */
  const int count = gaps_along(own, nodes, work->gaps_along, work);
  const real beside = place_of_look(own, downhill(own, work->gaps_along, count, near));
  if (first <= beside && beside <= last) {
    place = stationary(own, beside, element, work);
    return ABSOLUTE(place - beside) <= FAR ? place : beside;
  }
  /* By the polynomials of its element it may be farther beyond an end of that one than it is. */
  const real end = clipped(beside, first, last);
  place = stationary(own, end, element, work);
  return ABSOLUTE(place - end) <= BEYOND ? place : clipped(beside, end - BEYOND, end + BEYOND);
}

/* The gap at a place, by the polynomials of an element next to it, with the weights of the nodes. */
void gap_at(const facing *own, const real *nodes, real place, int element, met_gap *gap) {
  workspace room = room_of(own, nodes);
  fit_nodes(own, nodes, &room);
  look_in(own, own->is_body ? 0 : element_near(own, place, element), place, &gap->own, &room);
  weigh_nodes(own, &gap->own);
  weigh_other(own, gap);
}

/* The place next to another where the gap is least. */
real gap_place(const facing *own, const real *nodes, real near, int element) {
  workspace room = room_of(own, nodes);
  if (own->is_body) return near;
  fit_nodes(own, nodes, &room);
  return place_near(own, nodes, near, element, &room);
}

/* Gaps at the sections at which a rod that lies is held. */
void laid_gaps(const facing *own, const real *nodes, real *gaps) {
  workspace room = room_of(own, nodes);
  fit_nodes(own, nodes, &room);
  for (int k = 0; k < own->laid_count; k++) {
    section_gap gap;
    look_at(own, own->laid[k], &gap, &room);
    gaps[k] = gap.value;
  }
}

/* Places of the sections whose gaps are the least about them, and not above a bound, base to tip, and these gaps; returns
   their number. There is room for as many as are looked at. */
int gap_valleys(const facing *own, const real *nodes, real below, real *places, real *gaps) {
  workspace room = room_of(own, nodes);
  section_gap lowest;
  int look = 0, count = 0;
  look_along(own, nodes, &room);
  while ((look = next_valley(own, look, below, 0, &lowest, &room)) > 0) {
    places[count] = lowest.place;
    gaps[count++] = lowest.value;
  }
  return count;
}

/* How much lower than a section that is looked at the minimum next to it may be. */
static real step_down(const real *gaps, int count, int look) {
  real highest = gaps[look];
  if (look > 0 && gaps[look - 1] > highest) highest = gaps[look - 1];
  if (look < count - 1 && gaps[look + 1] > highest) highest = gaps[look + 1];
  return highest - gaps[look] + BETWEEN;
}

/* Whether a section that is looked at first is the least about it, and none of those left out: sections in the valleys of
   some, next to them, and at some ends. Equal ones count where they are the first or the last. */
static int is_lowest(const facing *own, const real *gaps, int count, int look, int all, const int *left_out,
                     int left_out_count, const real *ends, int end_count) {
  const real fall = look > 0 ? gaps[look - 1] - gaps[look] : 1;
  const real rise = look < count - 1 ? gaps[look + 1] - gaps[look] : 1;
  if (!(fall >= 0 && rise >= 0 && fall + rise > 0)) return 0;
  if (!all && ((look == 0 && !own->watches_base) || (look == count - 1 && !own->watches_tip))) return 0;
  for (int k = 0; k < left_out_count; k++) {
    if (look - left_out[k] <= 1 && left_out[k] - look <= 1) return 0;
  }
  for (int k = 0; k < end_count; k++) {
    if (ABSOLUTE(place_of_look(own, look) - ends[k]) <= AT_END) return 0;
  }
  return 1;
}

/* The place of the least gap, and the gap, but for those in the valleys of some places, whose sections are written, and at
   some ends; infinite where there is none. Ends that are not watched are none, but where all are asked for. */
void lowest_gap(const facing *own, const real *nodes, int all, const real *but, int *left_out, int but_count,
                const real *ends, int end_count, real *place, real *lowest) {
  workspace room = room_of(own, nodes);
  real *gaps = own->gaps_along;
  section_gap gap;
  *place = 0;
  *lowest = INFINITY;
  look_along(own, nodes, &room);
  if (own->is_body) {
    if (but_count > 0) return;
    look_at(own, 0, &gap, &room);
    *lowest = gap.value;
    return;
  }
  const int count = own->elements * LOOKS + 1;
  for (int k = 0; k < but_count; k++) left_out[k] = downhill(own, gaps, count, but[k]);
  real least = INFINITY;
  for (int i = 0; i < count; i++) {
    if (gaps[i] < least && is_lowest(own, gaps, count, i, all, left_out, but_count, ends, end_count)) least = gaps[i];
  }
  for (int i = 0; i < count; i++) {
    /* A valley between two sections may be lower than another one at a section, such as an end, whose gap is less. */
    const real deeper = step_down(gaps, count, i);
    if (gaps[i] - deeper > least || !is_lowest(own, gaps, count, i, all, left_out, but_count, ends, end_count)) continue;
    gap.place = place_of_look(own, i);
    gap.value = gaps[i];
    /* Far from zero no one asks how much lower it is beside a section. */
    if (all || !(gaps[i] > OFF * deeper)) look_lowest_by(own, i, &gap, &room);
    if (!(gap.value < *lowest)) continue;
    *lowest = gap.value;
    *place = gap.place;
  }
}

/* ---- Contacts at a state ---- */

/* Positions of the points, at the state that they were asked for last. */
static const real *positions_at(moving_points *points, const real *x, const real *inputs) {
  const int moved = give(points->positions, 0, x) | give(points->positions, 1, inputs);
  if (moved || !points->is_known) points->is_known = call(points->positions);
  return points->positions->result;
}

/* Has the positions of points in memory, as the result of their function. */
void known_positions(moving_points *points, const real *x, const real *inputs) { positions_at(points, x, inputs); }

/* Gaps of contacts where they are. */
void touched_gaps(const touch *touches, int count, const real *x, const real *inputs, met_gap *gaps) {
  for (int k = 0; k < count; k++) {
    const facing *own = touches[k].facing;
    const real *nodes = positions_at(own->points, x, inputs);
    workspace room = room_of(own, nodes);
    real place = touches[k].place;
    fit_nodes(own, nodes, &room);
    if (touches[k].slides && !own->is_body) place = place_near(own, nodes, place, touches[k].element, &room);
    look_in(own, own->is_body ? 0 : element_near(own, place, touches[k].element), place, &gaps[k].own, &room);
    gaps[k].own.place = place;
    weigh_nodes(own, &gaps[k].own);
    weigh_other(own, gaps + k);
  }
}

/* Adds a force along a normal, at the section of a gap, to forces on the nodes. */
static void add_push(real *weights, const section_gap *gap, real force, real length, const real *normal) {
  for (int i = 0; i < gap->nodes; i++) {
    const real share = force * gap->rows[0][i] / length;
    for (int j = 0; j < 3; j++) weights[3 * (gap->first + i) + j] += share * normal[j];
  }
}

/* Takes forces of contacts from equations of motion, and writes how far gaps are open behind them. */
void push_touches(const touch *touches, int count, int unknowns, const real *x, const real *inputs, const real *forces,
                  real *rows, real *open) {
  met_gap gap;
  for (int k = 0; k < count; k++) {
    kernel *gradient = touches[k].facing->points->gradient;
    memset(gradient->arguments[2], 0, (size_t)gradient->counts[2] * sizeof(real));
  }
  for (int k = 0; k < count; k++) {
    const facing *own = touches[k].facing;
    real *weights = own->points->gradient->arguments[2];
    touched_gaps(touches + k, 1, x, inputs, &gap);
    open[k] = gap.own.value - touches[k].height;
    add_push(weights, &gap.own, forces[k], own->length, gap.own.normal);
    if (own->other) add_push(weights, &gap.other, -forces[k], own->length, gap.own.normal);
  }
  for (int k = 0; k < count; k++) {
    moving_points *points = touches[k].facing->points;
    int is_first = 1;
    for (int i = 0; i < k; i++) is_first &= touches[i].facing->points != points;
    if (!is_first) continue;
    give(points->gradient, 0, x);
    give(points->gradient, 1, inputs);
    call(points->gradient);
    if (points->shares) {
      for (int i = 0; i < unknowns; i++) points->gradient->result[i] *= points->shares[i];
    }
    for (int i = 0; i < unknowns; i++) rows[i] -= points->gradient->result[i];
  }
}

/* Contacts as steps have them, whose unknowns of a base that nothing holds may be others than those of the model. */
typedef struct {
  const touch *touches;
  int count;
  int unknowns;
  int base_begin;
  kernel *base; /* unknowns of steps to those of the base; null where they are the same */
  real *x;      /* unknowns of the model */
} step_contacts;

/* push_touches in steps. */
void push_in_steps(const step_contacts *own, const real *unknowns, const real *inputs, const real *forces, real *rows,
                   real *open) {
  const real *x = unknowns;
  if (own->base) {
    memcpy(own->x, unknowns, (size_t)own->unknowns * sizeof *unknowns);
    give(own->base, 0, unknowns);
    call(own->base);
    memcpy(own->x + own->base_begin, own->base->result, BASE_UNKNOWNS * sizeof *unknowns);
    x = own->x;
  }
  push_touches(own->touches, own->count, own->unknowns, x, inputs, forces, rows, open);
}

/* least_pushes of constraints with 2 count (count + 1) numbers and 3 count whole numbers of room. */
int settle_pushes(const real *compliance, const real *rates, int count, real tolerance, real *forces, real *room,
                  int *integers) {
  real *vectors = room + 2 * count * count;
  workspace work = {.scaled_compliance = room,
                    .small_matrix = room + count * count,
                    .scales = vectors,
                    .small_values = vectors + count,
                    .small_pivots = integers,
                    .active = integers + count,
                    .passed_over = integers + 2 * count};
  return least_pushes(compliance, rates, count, tolerance, forces, &work);
}

/* Sizes of the records, by which Python tells that it has the same. */
int contact_records(int number) {
  const size_t sizes[] = {sizeof(kernel), sizeof(moving_points), sizeof(facing), sizeof(touch),
                          sizeof(step_contacts), sizeof(met_gap)};
  return (int)sizes[number];
}

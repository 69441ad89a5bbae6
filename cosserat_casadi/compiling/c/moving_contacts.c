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

/* Workspace of one-sided constraints. */
typedef struct {
  real *scaled_compliance;
  real *scales;
  real *small_values;
  real *small_matrix;
  int *small_pivots;
  int *active;
  int *passed_over;
} workspace;

#include "facings.c"

/* A contact. For a sliding one, the search for its place begins at place. */
typedef struct {
  const facing *facing;
  int slides;
  int element;
  real place;
  real height; /* gap that it keeps */
} touch;

static real larger(real a, real b) { return a > b ? a : b; }

static int all_finite(const real *a, int count) {
  real sum = 0;
  for (int i = 0; i < count; i++) sum += a[i] * 0;
  return sum == 0;
}

#include "square_systems.c"
#include "least_pushes.c"

/* ---- Gaps of a pair, at positions of its points ---- */

/* The given element, or the element of the section if the section is too far beyond the given one. */
static int element_near(const facing *own, real place, int element) {
  const int is_near = own->ends[element] - BEYOND <= place && place <= own->ends[element + 1] + BEYOND;
  return is_near ? element : element_of(own, place);
}

/* Newton's method for a place with zero slope; not a number if it fails. */
static real stationary(const facing *own, real near, int element) {
  real place = near;
  for (int k = 0; k < MOST_PLACINGS; k++) {
    const int number = element_near(own, place, element);
    section_gap gap;
    look_in(own, number, place, &gap, 0);
    if (!(gap.bend > 0)) return NAN;
    const real change = -gap.slope / gap.bend;
    place += change;
    if (!(-BEYOND <= place && place <= 1 + BEYOND)) return NAN;
    /* Beyond its element the gap follows the next one. */
    if (ABSOLUTE(change) <= PLACED && element_near(own, place, element) == number) break;
  }
  return place;
}

/* Number of the lowest section, among those looked at first, in the valley of a place. */
static int downhill(const facing *own, const real *gaps, int count, real near) {
  int look = 0;
  for (int i = 1; i < count; i++) {
    if (ABSOLUTE(place_of_look(own, i) - near) < ABSOLUTE(place_of_look(own, look) - near)) look = i;
  }
  while (look > 0 && gaps[look - 1] < gaps[look]) look--;
  while (look < count - 1 && gaps[look + 1] < gaps[look]) look++;
  return look;
}

/* Place of the least gap next to another place, by the polynomials of an element; at most a little beyond the ends. */
static real place_near(const facing *own, const real *nodes, real near, int element) {
  const real first = own->ends[element];
  const real last = own->ends[element + 1];
  real place = stationary(own, near, element);
  if (ABSOLUTE(place - near) <= FAR) return place;
  /* The search goes down from section to section, so that it meets no other minimum. */
  const int count = gaps_along(own, nodes, own->gaps_along, 0);
  const real beside = place_of_look(own, downhill(own, own->gaps_along, count, near));
  if (first <= beside && beside <= last) {
    place = stationary(own, beside, element);
    return ABSOLUTE(place - beside) <= FAR ? place : beside;
  }
  /* By the polynomials of its element it may be farther beyond an end of that one than it is. */
  const real end = clipped(beside, first, last);
  place = stationary(own, end, element);
  return ABSOLUTE(place - end) <= BEYOND ? place : clipped(beside, end - BEYOND, end + BEYOND);
}

/* The gap at a place, by the polynomials of an element next to it, with the weights of the nodes. */
void gap_at(const facing *own, const real *nodes, real place, int element, section_gap *gap) {
  fit_nodes(own, nodes, 0);
  look_in(own, own->is_body ? 0 : element_near(own, place, element), place, gap, 0);
  weigh_nodes(own, gap);
}

/* The place of the least gap next to another place. */
real gap_place(const facing *own, const real *nodes, real near, int element) {
  if (own->is_body) return near;
  fit_nodes(own, nodes, 0);
  return place_near(own, nodes, near, element);
}

/* Gaps at the sections at which a rod that lies is held. */
void laid_gaps(const facing *own, const real *nodes, real *gaps) {
  fit_nodes(own, nodes, 0);
  for (int k = 0; k < own->laid_count; k++) {
    section_gap gap;
    look_at(own, own->laid[k], &gap, 0);
    gaps[k] = gap.value;
  }
}

/* Writes places and values of local minima of the gap up to a bound, from base to tip. Returns their number, at most
   that of the sections looked at. */
int gap_valleys(const facing *own, const real *nodes, real below, real *places, real *gaps) {
  section_gap lowest;
  int look = 0, count = 0;
  look_along(own, nodes, 0);
  while ((look = next_valley(own, look, below, 0, &lowest, 0)) > 0) {
    places[count] = lowest.place;
    gaps[count++] = lowest.value;
  }
  return count;
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
  const real *gaps = own->gaps_along;
  section_gap gap;
  *place = 0;
  *lowest = INFINITY;
  look_along(own, nodes, 0);
  if (own->is_body) {
    if (but_count > 0) return;
    look_at(own, 0, &gap, 0);
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
    /* A valley between two sections may be lower than a section, such as an end, with a smaller gap. */
    const real deeper = step_down(gaps, count - 1, i);
    if (gaps[i] - deeper > least || !is_lowest(own, gaps, count, i, all, left_out, but_count, ends, end_count)) continue;
    gap.place = place_of_look(own, i);
    gap.value = gaps[i];
    /* Far from zero the exact minimum beside a section does not matter. */
    if (all || !(gaps[i] > OFF * deeper)) look_lowest_by(own, i, &gap, 0);
    if (!(gap.value < *lowest)) continue;
    *lowest = gap.value;
    *place = gap.place;
  }
}

/* ---- Contacts at a state ---- */

/* Has the positions of points in memory, as the result of their function. */
void known_positions(moving_points *points, const real *x, const real *inputs) { positions_at(points, x, inputs); }

/* Gaps of contacts at their places. */
void touched_gaps(const touch *touches, int count, const real *x, const real *inputs, section_gap *gaps) {
  for (int k = 0; k < count; k++) {
    const facing *own = touches[k].facing;
    const real *nodes = positions_at(own->points, x, inputs);
    real place = touches[k].place;
    fit_nodes(own, nodes, 0);
    if (touches[k].slides && !own->is_body) place = place_near(own, nodes, place, touches[k].element);
    look_in(own, own->is_body ? 0 : element_near(own, place, touches[k].element), place, gaps + k, 0);
    gaps[k].place = place;
    weigh_nodes(own, gaps + k);
  }
}

/* Subtracts the forces of contacts from equations of motion, and appends the open gaps. */
void push_touches(const touch *touches, int count, int unknowns, const real *x, const real *inputs, const real *forces,
                  real *rows, real *open) {
  section_gap gap;
  for (int k = 0; k < count; k++) {
    kernel *gradient = touches[k].facing->points->gradient;
    memset(gradient->arguments[2], 0, (size_t)gradient->counts[2] * sizeof(real));
  }
  for (int k = 0; k < count; k++) {
    const facing *own = touches[k].facing;
    real *weights = own->points->gradient->arguments[2];
    touched_gaps(touches + k, 1, x, inputs, &gap);
    open[k] = gap.value - touches[k].height;
    add_weights(own, &gap, forces[k], weights);
  }
  for (int k = 0; k < count; k++) {
    moving_points *points = touches[k].facing->points;
    int is_first = 1;
    for (int i = 0; i < k; i++) is_first &= touches[i].facing->points != points;
    if (!is_first) continue;
    writing to = {points->gradient, 0, 0};
    put(&to, x, points->unknowns);
    put(&to, inputs, points->inputs);
    call(points->gradient);
    for (int i = 0; i < unknowns; i++) rows[i] -= points->gradient->result[i] * share_of(touches[k].facing, i);
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
    writing to = {own->base, 0, 0};
    put(&to, unknowns, own->base->counts[0]);
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
                          sizeof(step_contacts), sizeof(section_gap)};
  return (int)sizes[number];
}

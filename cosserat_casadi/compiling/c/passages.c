/* Whether a step leads through something thin: a smooth ball or bar, or another rod, pushes where a rod is in it, so that a
   step which ends behind it has not felt it. Unknowns and inputs change in proportion on the way; a part of it in which what
   moves leaves the straight line is halved where the room beside something thin does not cover that.

   cosserat_casadi/equilibrium/smooth_passage.py asks the same of the steps in Python. A distance changes by no more than
   the way: from a place that is clear by some way the next one that is looked at is as far away, along the motion and
   along the rod. Uses of the scene: BARRIER, ROD_PAIR, QUATERNION, SIZES, places_at, find_sizes. */

#include "interpolation.c"

/* Least width of a stretch between two looks, relative to the admitted depth: looks miss no way through the middle. */
static const real FINEST = (real)0.25;

/* Longest step along a rod, over which a chord is about as long as the arc. */
static const real LONGEST_STRETCH = (real)0.125;

enum {
  EVERY = 2,      /* sections of rods that touch rods of which one is looked at */
  MOST_PARTS = 64 /* of a step that are looked at */
};

/* Unknowns at both ends of a step, and inputs with parameters behind them. */
typedef struct {
  const real *x[2];
  const real *inputs[2];
} step_ends;

/* Shares of a part of a step at which places are computed. */
enum { AT_START, IN_MIDDLE, AT_END };

static real least_of(real a, real b) { return a < b ? a : b; }

static real most_of(real a, real b) { return a > b ? a : b; }

static real distance_of(const real *a, const real *b) {
  real sum = 0;
  for (int i = 0; i < 3; i++) sum += (b[i] - a[i]) * (b[i] - a[i]);
  return SQUARE_ROOT(sum);
}

/* Distance of places from the straight line in the middle of a part; zero if it is negligible. */
static real bend_of(const workspace *work, int first, int count, real overlooked) {
  real bend = 0;
  for (int i = 3 * first; i < 3 * (first + count); i += 3) {
    real halfway[3];
    for (int j = 0; j < 3; j++) halfway[j] = (work->places[AT_START][i + j] + work->places[AT_END][i + j]) / 2;
    bend = most_of(bend, distance_of(halfway, work->places[IN_MIDDLE] + i));
  }
  return bend > overlooked ? bend : 0;
}

#if BARRIERS
/* Distance that a section may still approach before it counts as deep, m; negative if it is deep, or if this is not a
   number. */
static real clear_by(const barrier *own, const real *start, const real *end, real radius, workspace *work) {
  const real admitted = SIZES(work)[own->sizes + ADMITTED];
  const real way = distance_of(start, end);
  real least = -1, before = 0, gone = 0, share = 0;
  for (;;) {
    real position[3];
    for (int i = 0; i < 3; i++) position[i] = start[i] + share * (end[i] - start[i]);
    const real clear = own->distance(position, work) - radius + admitted;
    if (!(clear >= 0)) return -1;
    /* Between two looks the room follows from the room at both ends. */
    const real between = most_of((before + clear - gone) / 2, 0);
    least = share > 0 ? least_of(least, between) : clear;
    if (share == 1 || way == 0) return least;
    before = clear;
    gone = most_of(clear, FINEST * admitted);
    if (gone < (1 - share) * way) {
      share += gone / way;
    } else {
      gone = (1 - share) * way;
      share = 1;
    }
  }
}

/* Position of the section at an abscissa, or of a ball. */
static void position_of(const barrier *own, const real *places, real X, real *position) {
  const rod_nodes *rod = own->rod;
  const real *first = places + 3 * own->first;
  int e = 0;
  if (!rod) {
    memcpy(position, first, 3 * sizeof *position);
    return;
  }
  while (e + 1 < rod->elements && X > rod->ends[e + 1]) e++;
  const real local = (X - rod->ends[e]) / (rod->ends[e + 1] - rod->ends[e]);
  point_of_curve(first + 3 * e * rod->nodes, rod->local_nodes, rod->barycentric, rod->nodes, local, position);
}

static real radius_of(const barrier *own, real X, const workspace *work) {
  const real *radii = SIZES(work) + own->sizes + RADII;
  const real place = X * (real)own->parts;
  const int part = place < (real)own->parts ? (int)place : own->parts - 1;
  return radii[part] + (place - (real)part) * (radii[part + 1] - radii[part]);
}

/* Whether a section of a rod, or a ball, is deep inside an obstacle on its way, or so near that the bend of the way
   decides. */
static int goes_through(const barrier *own, real bend, workspace *work) {
  const real *before = work->places[AT_START];
  const real *after = work->places[AT_END];
  const real *sizes = SIZES(work) + own->sizes;
  real start[3], end[3], next_start[3], next_end[3];
  real X = 0;
  position_of(own, before, X, start);
  position_of(own, after, X, end);
  for (;;) {
    const real clear = clear_by(own, start, end, radius_of(own, X, work) + bend, work);
    if (clear < 0) return 1;
    if (!own->rod || X == 1) return 0;
    const real reach = most_of(clear, FINEST * sizes[ADMITTED]);
    /* The bound is a little smaller, so that rounding does not halve the step. */
    real step = least_of((real)0.9 * reach / own->length, LONGEST_STRETCH);
    real next;
    for (;;) {
      next = least_of(X + step, 1);
      position_of(own, before, next, next_start);
      position_of(own, after, next, next_end);
      if (!(most_of(distance_of(start, next_start), distance_of(end, next_end)) > reach)) break;
      step /= 2;
    }
    X = next;
    memcpy(start, next_start, sizeof start);
    memcpy(end, next_end, sizeof end);
  }
}
#endif

#if ROD_PAIRS
/* Least distance of two sections while both move. */
static real nearest_of(const real *first, const real *second, const real *first_end, const real *second_end) {
  real square = 0, product = 0, apart[3], way[3];
  for (int i = 0; i < 3; i++) {
    apart[i] = first[i] - second[i];
    way[i] = first_end[i] - second_end[i] - apart[i];
    square += way[i] * way[i];
    product -= apart[i] * way[i];
  }
  const real share = square > 0 ? most_of(least_of(product / square, 1), 0) : 0;
  real sum = 0;
  for (int i = 0; i < 3; i++) sum += (apart[i] + share * way[i]) * (apart[i] + share * way[i]);
  return SQUARE_ROOT(sum);
}

/* The longest way from one section to the next. */
static real longest_between(const real *places, int count) {
  real longest = 0;
  for (int i = 1; i < count; i++) longest = most_of(longest, distance_of(places + 3 * (i - 1), places + 3 * i));
  return longest;
}

/* Whether the axes of two rods come nearer to each other than half their thickness, or so near that the bend of the way
   decides. */
static int pass_each_other(const rod_pair *own, real bend, const workspace *work) {
  const real *before = work->places[AT_START];
  const real *after = work->places[AT_END];
  const real *sizes = SIZES(work) + own->sizes;
  const int own_first = 3 * own->first[0];
  const int others = 3 * own->first[1];
  const int own_count = own->counts[0];
  const int count = own->counts[1];
  const real spacing = most_of(longest_between(before + others, count), longest_between(after + others, count));
  const real own_spacing =
      most_of(longest_between(before + own_first, own_count), longest_between(after + own_first, own_count));
  /* Crossing axes have sections among those looked at within this distance: more than half the thickness for long
     rods. */
  const real met = SQUARE_ROOT(spacing * spacing + own_spacing * own_spacing) * EVERY / 2;
  const real allowed = most_of(sizes[NEAREST], met) + bend;
  for (int i = 0; i < own_count; i += EVERY) {
    const real X = (i + (real)0.5) / own_count;
    const int first = own_first + 3 * i;
    for (int j = 0; j < count;) {
      const int second = others + 3 * j;
      const real along = (j + (real)0.5) / count - X;
      int skipped = 1;
      if (along >= sizes[APART]) {
        const real clear = nearest_of(before + first, before + second, after + first, after + second) - allowed;
        if (!(clear >= 0)) return 1;
        skipped = clear < spacing * count ? (int)(clear / spacing) / EVERY : count;
        if (skipped < 1) skipped = 1;
      }
      j += EVERY * skipped;
    }
  }
  return 0;
}
#endif

/* Whether a quaternion among the inputs changes to one that is nearer with the other sign. */
static int turns_farther(const real *from, const real *to, int first) {
  real product = 0;
  for (int i = first; i < first + 4; i++) product += from[i] * to[i];
  return product < 0;
}

/* The places after a share of a step. */
static void find_places(const step_ends *step, real share, int where, workspace *work) {
  real *x = work->x_between;
  real *inputs = work->inputs_between;
  for (int i = 0; i < N; i++) x[i] = (1 - share) * step->x[0][i] + share * step->x[1][i];
  for (int i = 0; i < INPUTS; i++) inputs[i] = (1 - share) * step->inputs[0][i] + share * step->inputs[1][i];
  for (int k = 0; k < QUATERNIONS; k++) {
    const int first = QUATERNION[k];
    if (!turns_farther(step->inputs[0], step->inputs[1], first)) continue;
    for (int i = first; i < first + 4; i++) inputs[i] -= 2 * share * step->inputs[1][i];
  }
  places_at(x, inputs, work->places[where], work);
}

/* Whether a part of a step leads through something thin; *bends tells whether its bend leaves that open. */
static int part_leads_through(workspace *work, int *bends) {
#if BARRIERS
  for (int k = 0; k < BARRIERS; k++) {
    const barrier *own = BARRIER + k;
    const int count = own->rod ? own->rod->elements * own->rod->nodes : 1;
    const real bend = bend_of(work, own->first, count, FINEST * SIZES(work)[own->sizes + ADMITTED]);
    *bends = bend > 0;
    if (goes_through(own, bend, work)) return 1;
  }
#endif
#if ROD_PAIRS
  for (int k = 0; k < ROD_PAIRS; k++) {
    const rod_pair *own = ROD_PAIR + k;
    real bend = 0;
    for (int i = 0; i < 2; i++) {
      bend += bend_of(work, own->first[i], own->counts[i], FINEST / 2 * SIZES(work)[own->sizes + NEAREST]);
    }
    *bends = bend > 0;
    if (pass_each_other(own, bend, work)) return 1;
  }
#endif
  return 0;
}

/* Whether a step leads through something thin; sizes are those at its end. */
static int leads_through(const step_ends *step, workspace *work) {
  const size_t all = sizeof work->places[0];
  real begun = 0, share = 1;
  find_sizes(step->inputs[1], work);
  find_places(step, 0, AT_START, work);
  find_places(step, 1, AT_END, work);
  for (int parts = 0; parts < MOST_PARTS; parts++) {
    int bends = 0;
    find_places(step, begun + share / 2, IN_MIDDLE, work);
    if (!part_leads_through(work, &bends)) {
      begun += share;
      if (begun == 1) return 0;
      share = least_of(2 * share, 1 - begun);
      memcpy(work->places[AT_START], work->places[AT_END], all);
      find_places(step, begun + share, AT_END, work);
    } else if (bends) {
      share /= 2;
      memcpy(work->places[AT_END], work->places[IN_MIDDLE], all);
    } else {
      return 1;
    }
  }
  return 1;
}

/* Gaps between rods or bodies and obstacles that they touch exactly, along the rods, and the places of least gaps.
   Positions between nodes come from the polynomials through the nodes of an element.

   Exported steps and simulated motions both include it, and say what a surface is, surface_at and distance_at, where
   polynomials and gaps are written to, fitted_of and gaps_of, and how many numbers of a section a change moves, MOVED. Gaps
   are counted in the length of the rod, or of the longest rod that holds the body. */

/* Gap up to which a section touches. */
static const real TOUCHING = (real)1e-7;

/* Bend of a gap up to which it is flat: a rod lies there, and is held at sections of its own. */
static const real FLATTEST = (real)1e-3;

/* Slope of a gap over the length up to which a section is level. */
static const real SMOOTH = (real)1e-6;

/* Distance along the rod up to which two sections that touch count as one. */
static const real SAME_PLACE = (real)0.02;

/* Unit to which gaps are rounded before valleys are sought, so that a flat gap has none. */
static const real LEVEL = (real)1e-10;

/* Change of a place below which the next step of Newton's method is at rounding. */
static const real PLACED = (real)1e-8;

/* Largest fall of a gap between two sections beyond the change from one to the next: the fall halfway with a bend of
   one. */
static const real BETWEEN = (real)0.125 / (LOOKS * LOOKS);

/* Way down a gap without a bend. */
static const real DOWN = (real)5e-3;

enum { PLACINGS = 50 };

/* A gap at a section, with its derivatives along the rod and the parts of its derivatives by the unknowns. */
typedef struct {
  real place; /* abscissa */
  real value;
  real slope;
  real bend;
  real normal[3];
  real curvature[9]; /* of the distance, 1/m */
  real tangent[3];   /* derivative of the position with the abscissa, m */
  int first;         /* of the nodes of its element */
  int nodes;
  real rows[2][MOST_NODES]; /* their weights for the section, and for the tangent */
#ifdef RODS_FACE_RODS
  other_section other; /* of a rod that faces a rod */
#endif
} section_gap;

#ifdef RODS_FACE_RODS
static int surface_of_rod(const facing *own, const real *point, real *distance, section_gap *gap, workspace *work);
static void fit_other(const facing *own, const real *nodes, workspace *work);
static void weigh_other(const facing *own, section_gap *gap);
static void add_other(const facing *own, const section_gap *gap, real times, real *weights);
static void add_row_of_other(const facing *own, const section_gap *gap, int row, const real *direction, real *weights);
static void turn_slope_of_other(const facing *own, const section_gap *gap, real *moved);
static real turning_beside_other(const facing *own, const section_gap *gap, const real *moved, const real *more);

#endif
static real clipped(real value, real least, real most) { return value < least ? least : value > most ? most : value; }

static real inner(const real *a, const real *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Evaluates the surface at a point, and the gap with two derivatives along a curve through the point. */
static void along_surface(const facing *own, const real *point, const real *second, section_gap *gap, workspace *work) {
  const real taper = own->radius_at_tip - own->radius_at_base;
  real distance;
#ifdef RODS_FACE_RODS
  if (!surface_of_rod(own, point, &distance, gap, work))
#endif
  surface_at(own, point, &distance, gap->normal, gap->curvature, work);
  real turned[3];
  for (int i = 0; i < 3; i++) turned[i] = inner(gap->curvature + 3 * i, gap->tangent);
  gap->value = (distance - own->radius_at_base - gap->place * taper) / own->length;
  gap->slope = (inner(gap->normal, gap->tangent) - taper) / own->length;
  gap->bend = (inner(gap->tangent, turned) + inner(gap->normal, second)) / own->length;
}

/* Values of the Chebyshev polynomials of an element at a section, and two derivatives along the rod. */
static void polynomials_at(const facing *own, int element, real place, real values[3][MOST_NODES]) {
  const real width = own->ends[element + 1] - own->ends[element];
  const real z = 2 * (place - own->ends[element]) / width - 1;
  const real rate = 2 / width;
  values[0][0] = 1;
  values[1][0] = values[2][0] = values[2][1] = 0;
  values[0][1] = z;
  values[1][1] = rate;
  for (int k = 2; k < own->nodes; k++) {
    values[0][k] = 2 * z * values[0][k - 1] - values[0][k - 2];
    values[1][k] = 2 * rate * values[0][k - 1] + 2 * z * values[1][k - 1] - values[1][k - 2];
    values[2][k] = 4 * rate * values[1][k - 1] + 2 * z * values[2][k - 1] - values[2][k - 2];
  }
}

static int element_of(const facing *own, real place) {
  int e = 0;
  while (e + 1 < own->elements && place > own->ends[e + 1]) e++;
  return e;
}

/* Writes the coefficients of the polynomials through the nodes, which give all gaps from now on; for a body, its
   origin. */
static void fit_nodes(const facing *own, const real *nodes, workspace *work) {
  real *coefficients = fitted_of(own, work);
#ifdef RODS_FACE_RODS
  fit_other(own, nodes, work);
#endif
  if (own->is_body) {
    memcpy(coefficients, nodes, 3 * sizeof *nodes);
    return;
  }
  for (int e = 0; e < own->elements; e++) {
    const real *node = nodes + 3 * e * own->nodes;
    for (int k = 0; k < own->nodes; k++, coefficients += 3) {
      const real *weights = own->to_coefficients + k * own->nodes;
      real sum[3] = {0, 0, 0};
      for (int i = 0; i < own->nodes; i++) {
        for (int j = 0; j < 3; j++) sum[j] += weights[i] * node[3 * i + j];
      }
      memcpy(coefficients, sum, sizeof sum);
    }
  }
}

/* The gap at an abscissa, by the polynomials of an element, a little beyond its ends too; of a body whatever the abscissa. */
static void look_in(const facing *own, int element, real place, section_gap *gap, workspace *work) {
  real values[3][MOST_NODES];
  real curve[3][3] = {{0}};
  gap->place = own->is_body ? 0 : place;
  gap->nodes = own->nodes;
  gap->first = 0;
  if (own->is_body) {
    memset(gap->tangent, 0, sizeof gap->tangent);
    along_surface(own, fitted_of(own, work), curve[2], gap, work);
    return;
  }
  polynomials_at(own, element, place, values);
  gap->first = element * own->nodes;
  const real *coefficients = fitted_of(own, work) + 3 * gap->first;
  for (int k = 0; k < own->nodes; k++) {
    for (int order = 0; order < 3; order++) {
      for (int j = 0; j < 3; j++) curve[order][j] += values[order][k] * coefficients[3 * k + j];
    }
  }
  memcpy(gap->tangent, curve[1], sizeof gap->tangent);
  along_surface(own, curve[0], curve[2], gap, work);
}

/* The gap at an abscissa, by the polynomials of its element. */
static void look_at(const facing *own, real place, section_gap *gap, workspace *work) {
  look_in(own, element_of(own, place), place, gap, work);
}

/* Weights of the nodes of its element for a section, and for its tangent. */
static void weigh_nodes(const facing *own, section_gap *gap) {
  real values[3][MOST_NODES];
  for (int order = 0; order < 2; order++) memset(gap->rows[order], 0, (size_t)own->nodes * sizeof(real));
#ifdef RODS_FACE_RODS
  weigh_other(own, gap);
#endif
  if (own->is_body) {
    gap->rows[0][0] = 1;
    return;
  }
  polynomials_at(own, gap->first / own->nodes, gap->place, values);
  for (int k = 0; k < own->nodes; k++) {
    const real *weights = own->to_coefficients + k * own->nodes;
    for (int i = 0; i < own->nodes; i++) {
      gap->rows[0][i] += values[0][k] * weights[i];
      gap->rows[1][i] += values[1][k] * weights[i];
    }
  }
}

/* Adds weights of the nodes of a section along a normal, over a length. */
static void add_section(const section_gap *gap, real times, real length, const real *normal, real *weights) {
  for (int i = 0; i < gap->nodes; i++) {
    const real share = times * gap->rows[0][i] / length;
    for (int k = 0; k < 3; k++) weights[3 * (gap->first + i) + k] += share * normal[k];
  }
}

/* Adds a multiple of the weights of the points of a rod or body whose weighted sum changes like a gap. */
static void add_weights(const facing *own, const section_gap *gap, real times, real *weights) {
  add_section(gap, times, own->length, gap->normal, weights);
#ifdef RODS_FACE_RODS
  add_other(own, gap, times, weights);
#endif
}

/* Adds weights of the points whose weighted sum changes like a section along an axis (rows 0 to 2), like its tangent
   along the normal (row 3), or like the tangent of another rod (row 4). */
static void row_weights(const facing *own, const section_gap *gap, int row, real *weights) {
  const int is_slope = row > 2;
  const real axis[3] = {(real)(row == 0), (real)(row == 1), (real)(row == 2)};
  const real *direction = is_slope ? gap->normal : axis;
  for (int i = 0; i < gap->nodes && row < 4; i++) {
    for (int k = 0; k < 3; k++) weights[3 * (gap->first + i) + k] = gap->rows[is_slope][i] * direction[k];
  }
#ifdef RODS_FACE_RODS
  add_row_of_other(own, gap, row, direction, weights);
#else
  (void)own;
#endif
}

/* Adds to the derivatives of a slope what the turning normal adds, from the derivatives of the position beside them. */
static void turn_slopes(const facing *own, const section_gap *gap, int columns, real *moved) {
  for (int i = 0; i < columns; i++, moved += MOVED) {
    for (int k = 0; k < 3; k++) moved[3] += inner(gap->curvature + 3 * k, gap->tangent) * moved[k];
#ifdef RODS_FACE_RODS
    turn_slope_of_other(own, gap, moved);
#else
    (void)own;
#endif
  }
}

/* Second derivative of a gap by two numbers that move its section, without that of the points. */
static real turning(const facing *own, const section_gap *gap, int slides, const real *moved, const real *other) {
  real sum = 0;
  for (int k = 0; k < 3; k++) sum += moved[k] * inner(gap->curvature + 3 * k, other);
#ifdef RODS_FACE_RODS
  if (own->other) sum = turning_beside_other(own, gap, moved, other);
#endif
  if (slides && gap->place > 0 && gap->place < 1) sum -= moved[3] * other[3] / (gap->bend * own->length);
  return sum / own->length;
}

/* Finds the section of the least gap next to another section: its slope is zero there, unless it is an end of the rod.
   Newton's method solves for the slope, which is continuous though the bend jumps between elements. Bisection between
   slopes of different sign helps where Newton fails, as beside a thin and distant wire. */
static void look_lowest(const facing *own, real near, section_gap *gap, workspace *work) {
  real falls = -1, rises = 2; /* sections where the gap falls, and where it rises */
  real place = near;
  look_at(own, place, gap, work);
  for (int k = 0; k < PLACINGS && !own->is_body; k++) {
    const int is_falling = gap->slope < 0;
    if (!(gap->bend > 0) && !(ABSOLUTE(gap->slope) > SMOOTH)) return;
    if (is_falling) {
      falls = place;
    } else {
      rises = place;
    }
    const real change = gap->bend > 0 ? clipped(-gap->slope / gap->bend, -SAME_PLACE, SAME_PLACE) : is_falling ? DOWN : -DOWN;
    real next = clipped(place + change, 0, 1);
    /* Rounding alone takes a short step of Newton's method past a section that was looked at. */
    const int is_past = ABSOLUTE(next - place) > PLACED && (next <= falls || next >= rises);
    if (is_past && falls >= 0 && rises <= 1) next = (falls + rises) / 2;
    const real moved = ABSOLUTE(next - place);
    if (moved == 0) return;
    place = next;
    look_at(own, place, gap, work);
    if (moved <= PLACED) return;
  }
}

/* Writes the rounded gaps at the sections that are looked at first; returns their number. */
static int gaps_along(const facing *own, const real *nodes, real *gaps, workspace *work) {
  const real taper = own->radius_at_tip - own->radius_at_base;
  const int count = own->elements * LOOKS + 1;
  for (int i = 0; i < count; i++) {
    const int e = i / LOOKS < own->elements ? i / LOOKS : own->elements - 1;
    const int local = i - e * LOOKS;
    const real *weights = own->looks + local * own->nodes;
    const real *node = nodes + 3 * e * own->nodes;
    const real place = own->ends[e] + (own->ends[e + 1] - own->ends[e]) * (real)local / (real)LOOKS;
    real x = 0, y = 0, z = 0; /* apart: a compiler leaves an array whose address is taken in memory */
    for (int k = 0; k < own->nodes; k++) {
      x += weights[k] * node[3 * k];
      y += weights[k] * node[3 * k + 1];
      z += weights[k] * node[3 * k + 2];
    }
    const real point[3] = {x, y, z};
    const real gap = (distance_at(own, point, work) - own->radius_at_base - place * taper) / own->length;
    gaps[i] = LEVEL * (real)floor((double)(gap / LEVEL) + 0.5);
  }
  return count;
}

static real place_of_look(const facing *own, int i) {
  const int e = i / LOOKS < own->elements ? i / LOOKS : own->elements - 1;
  return own->ends[e] + (own->ends[e + 1] - own->ends[e]) * (real)(i - e * LOOKS) / (real)LOOKS;
}

/* The least gap next to a section that is looked at first; that section where none is. */
static void look_lowest_by(const facing *own, int look, section_gap *lowest, workspace *work) {
  const real place = place_of_look(own, look);
  look_lowest(own, place, lowest, work);
  if (!(ABSOLUTE(lowest->place - place) <= SAME_PLACE) || !(lowest->bend > 0)) look_at(own, place, lowest, work);
}

/* Computes the gaps along a rod, or of a body, for the searches of valleys that follow. */
static void look_along(const facing *own, const real *nodes, workspace *work) {
  fit_nodes(own, nodes, work);
  if (!own->is_body) gaps_along(own, nodes, gaps_of(own, work), work);
}

/* Bound on how much lower the gap is next to a section of least gap among those looked at first, from the bend, which
   the differences to both neighbours give. An end has one neighbour only: there the bound is half of that
   difference. */
static real step_down(const real *gaps, int last, int look) {
  const int first = look == 0 ? 0 : look == last ? last - 2 : look - 1;
  real deepest = BETWEEN;
  for (int i = first; i < first + 2; i++) {
    const real step = ABSOLUTE(gaps[i + 1] - gaps[i]);
    if (step > deepest) deepest = step;
  }
  return deepest;
}

/* Finds the next section with a least gap below a bound, from a given one of those looked at first on. Returns the
   section to go on from, or zero at the end. Ends that are not watched count only if all are asked for. Each section
   looked at has one valley at most. */
static int next_valley(const facing *own, int look, real below, int all, section_gap *found, workspace *work) {
  const real *gaps = gaps_of(own, work);
  const int last = own->elements * LOOKS;
  if (own->is_body) {
    if (look > 0) return 0;
    look_at(own, 0, found, work);
    return found->value <= below;
  }
  for (int i = look; i <= last; i++) {
    const real fall = i > 0 ? gaps[i - 1] - gaps[i] : 1;
    const real rise = i < last ? gaps[i + 1] - gaps[i] : 1;
    /* Of equal ones the first and the last. */
    const int is_valley = fall >= 0 && rise >= 0 && fall + rise > 0;
    const int is_watched = all || ((i > 0 || own->watches_base) && (i < last || own->watches_tip));
    if (!is_valley || !is_watched || gaps[i] > below + step_down(gaps, last, i)) continue;
    look_lowest_by(own, i, found, work);
    if (!(found->value > below)) return i + 1;
  }
  return 0;
}

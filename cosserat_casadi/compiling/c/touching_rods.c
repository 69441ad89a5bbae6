/* Rods that touch other rods at a section of either: the gap of a section from another rod, contacts at both places, and
   whether rods would pass through each other.
   cosserat_casadi/equilibrium/contact/rod_gaps.py and passing_through.py do the same in Python. */

enum {
  REFINEMENTS = 6,  /* of the place on another rod that is nearest to a section */
  FINER = 8,        /* times that sections move closer together in each of them */
  WAYS = 16,        /* parts of a way at whose ends places of two rods are compared */
  HALVINGS_OF_WAY = 30
};

static int is_end(real place) { return place <= 0 || place >= 1; }

/* A place on a rod, or the end that it is near. */
static real at_end(real place) { return place < AT_TIP ? 0 : place > 1 - AT_TIP ? 1 : place; }

/* The nearer end of a rod, or a place inwards of an end. */
static real otherwise_at(real place) {
  if (is_end(place)) return fabs(place - 2 * NEAR_CONTACT);
  return place > (real)0.5 ? 1 : 0;
}

/* A contact of two rods in the order of their pair. */
static touch of_rods(int rod, int obstacle, real place, real other) {
  const touch made = {.rod = rod, .obstacle = obstacle, .is_line = 0, .start = place, .end = place, .other = other};
  return made;
}

/* A contact of two rods of an arrangement, at the places that are sought. */
static touch touch_of_rods(const contact_entry *entry, const real *places) {
  const real place = entry->held[0] < 0 ? places[0] : entry->held[0];
  const real other = entry->held[1] < 0 ? places[entry->moving - 1] : entry->held[1];
  return of_rods(entry->rod, entry->obstacle, place, other);
}

/* Whether a place on a rod is of the kind that an arrangement has: sought, or this end of the rod. */
static int is_of_kind(real place, real held) { return held < 0 ? !is_end(place) : place == held; }

/* Writes the places of a contact of two rods. Returns zero if the arrangement has other places. */
static int set_places_of_rods(const contact_entry *entry, const touch *wanted, real *places) {
  if (!is_of_kind(wanted->start, entry->held[0]) || !is_of_kind(wanted->other, entry->held[1])) return 0;
  if (entry->held[0] < 0) places[0] = wanted->start;
  if (entry->held[1] < 0) places[entry->moving - 1] = wanted->other;
  return 1;
}

/* ---- The gap of a section from another rod ---- */

/* Computes the positions of the sections of all rods that are looked at first. */
static void sample_rods(const arrangement *at, const real *z, const real *nodes, real *samples) {
  for (int rod = 0; rod < RODS; rod++) {
    for (int i = 0; i <= SAMPLES_OF_ROD; i++, samples += 3) {
      position_at(at, z, nodes, rod, (real)i / (real)SAMPLES_OF_ROD, samples);
    }
  }
}

static const real *sample_of(const real *samples, int rod, int number) {
  return samples + 3 * ((SAMPLES_OF_ROD + 1) * rod + number);
}

static real distance_of(const real *a, const real *b) {
  const real way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return norm_of(way, 3);
}

static real radius_at(int rod, real X) {
  return ROD[rod].radius_at_base + X * (ROD[rod].radius_at_tip - ROD[rod].radius_at_base);
}

/* Distance of a point from the surface of a section of a rod. */
static real distance_from_section(const arrangement *at, const real *z, int rod, const real *point, real X,
                                  workspace *work) {
  real position[3];
  position_at(at, z, work->nodes, rod, X, position);
  return distance_of(point, position) - radius_at(rod, X);
}

/* Distance of a point from the surface of a rod, at the section of least distance near another section; writes its
   abscissa. The squared distance is smooth however thin the rods are, so that parabolas of it lead to the section;
   beside it, the distance enters with the slope of the radius. */
static real refined_distance(const arrangement *at, const real *z, int rod, const real *point, real *place,
                             workspace *work) {
  real spacing = (real)1 / (real)SAMPLES_OF_ROD;
  for (int k = 0; k < REFINEMENTS; k++) {
    const real middle = smaller(larger(*place, spacing), 1 - spacing);
    real distances[3], values[3];
    for (int i = 0; i < 3; i++) {
      real position[3];
      position_at(at, z, work->nodes, rod, middle + (i - 1) * spacing, position);
      distances[i] = distance_of(point, position);
    }
    for (int i = 0; i < 3; i++) {
      const real radius = radius_at(rod, middle + (i - 1) * spacing);
      values[i] = distances[i] * distances[i] - 2 * distances[1] * radius;
    }
    const real bend = values[0] - 2 * values[1] + values[2];
    const real fall = values[0] - values[2];
    const real step = bend > 0 ? fall / (2 * bend) : fall > 0 ? 1 : -1;
    *place = smaller(larger(middle + spacing * smaller(larger(step, -1), 1), 0), 1);
    spacing /= (real)FINER;
  }
  return distance_from_section(at, z, rod, point, *place, work);
}

/* Gap of the section at a position and abscissa X of a rod from another rod that stands in the place of an obstacle, over
   the length of the first; writes the abscissa of the nearest section of the other. The positions of the sections that are
   looked at first stand in the workspace. Beside each of least distance among them a nearer one is sought, unless none
   there can be the nearest of all. */
static real gap_from_rod(const arrangement *at, const real *z, int rod, int obstacle, const real *position, real X,
                         real *nearest, workspace *work) {
  const int other = other_rod(obstacle);
  const real taper = fabs(ROD[other].radius_at_tip - ROD[other].radius_at_base);
  const real reach = (FASTEST * ROD[other].length + taper) / (real)SAMPLES_OF_ROD;
  real distances[SAMPLES_OF_ROD + 1];
  real least = HUGE_VAL;
  int lowest = 0;
  for (int i = 0; i <= SAMPLES_OF_ROD; i++) {
    const real place = (real)i / (real)SAMPLES_OF_ROD;
    distances[i] = distance_of(position, sample_of(work->samples[0], other, i)) - radius_at(other, place);
    if (distances[i] < distances[lowest]) lowest = i;
  }
  *nearest = 0;
  for (int k = 0; k <= SAMPLES_OF_ROD; k++) {
    const int i = (lowest + k) % (SAMPLES_OF_ROD + 1);
    const int falls_before = i > 0 && distances[i - 1] < distances[i];
    const int falls_behind = i < SAMPLES_OF_ROD && distances[i + 1] < distances[i];
    if (falls_before || falls_behind || distances[i] - reach >= least) continue;
    real place = (real)i / (real)SAMPLES_OF_ROD;
    const real distance = refined_distance(at, z, other, position, &place, work);
    if (distance < least) {
      least = distance;
      *nearest = place;
    }
  }
  return (least - radius_at(rod, X)) / ROD[rod].length;
}

/* ---- Whether rods pass through each other ---- */

/* The ends of two pieces of rods, at both ends of a way. */
typedef struct {
  const real *corners[2][4]; /* of the first piece, then of the second */
} pieces;

static void corners_at(const pieces *both, real share, real corners[4][3]) {
  for (int k = 0; k < 4; k++) {
    for (int i = 0; i < 3; i++) {
      corners[k][i] = both->corners[0][k][i] + share * (both->corners[1][k][i] - both->corners[0][k][i]);
    }
  }
}

static void cross(const real *a, const real *b, real *product) {
  for (int i = 0; i < 3; i++) product[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Both pieces, the way from the first to the second, and the vector across both. */
static void spanned(const pieces *both, real share, real sides[3][3], real *across) {
  real corners[4][3];
  corners_at(both, share, corners);
  for (int i = 0; i < 3; i++) {
    sides[0][i] = corners[1][i] - corners[0][i];
    sides[1][i] = corners[3][i] - corners[2][i];
    sides[2][i] = corners[2][i] - corners[0][i];
  }
  cross(sides[0], sides[1], across);
}

static real volume(const pieces *both, real share) {
  real sides[3][3], across[3];
  spanned(both, share, sides, across);
  return dot(across, sides[2], 3);
}

/* Whether the pieces cut each other, at a share of the way at which their ends are in one plane. */
static int cut_each_other(const pieces *both, real share) {
  real sides[3][3], across[3], turned[3];
  spanned(both, share, sides, across);
  const real square = dot(across, across, 3);
  for (int k = 0; k < 2; k++) {
    cross(sides[2], sides[1 - k], turned);
    const real place = dot(turned, across, 3);
    if (!(place >= 0 && place <= square)) return 0;
  }
  return square > 0;
}

/* Whether two pieces of rods cut each other on the straight way of their ends: where their four ends come to lie in one
   plane. */
static int pieces_pass(const pieces *both) {
  real before = volume(both, 0);
  for (int k = 0; k < WAYS; k++) {
    const real after = volume(both, (real)(k + 1) / (real)WAYS);
    if ((before > 0) != (after > 0)) {
      real low = (real)k / (real)WAYS, high = (real)(k + 1) / (real)WAYS;
      for (int j = 0; j < HALVINGS_OF_WAY; j++) {
        const real middle = (low + high) / 2;
        if ((volume(both, middle) > 0) == (before > 0)) {
          low = middle;
        } else {
          high = middle;
        }
      }
      if (cut_each_other(both, low)) return 1;
    }
    before = after;
  }
  return 0;
}

/* The longest way of a section of a rod, and the longest piece of its line, m. */
static void longest_of(int rod, const workspace *work, real *way, real *piece) {
  *way = *piece = 0;
  for (int i = 0; i <= SAMPLES_OF_ROD; i++) {
    const real *start = sample_of(work->samples[1], rod, i);
    const real *end = sample_of(work->samples[0], rod, i);
    *way = larger(*way, distance_of(start, end));
    if (i == SAMPLES_OF_ROD) continue;
    *piece = larger(*piece, larger(distance_of(start, start + 3), distance_of(end, end + 3)));
  }
}

static int lines_pass(int rod, int other, const workspace *work) {
  real way, other_way, piece, other_piece;
  longest_of(rod, work, &way, &piece);
  longest_of(other, work, &other_way, &other_piece);
  const real reach = 2 * larger(piece, other_piece) + way + other_way;
  for (int i = 0; i < SAMPLES_OF_ROD; i++) {
    for (int j = 0; j < SAMPLES_OF_ROD; j++) {
      pieces both;
      for (int end = 0; end < 2; end++) {
        const real *own = sample_of(work->samples[1 - end], rod, i);
        const real *others = sample_of(work->samples[1 - end], other, j);
        both.corners[end][0] = own;
        both.corners[end][1] = own + 3;
        both.corners[end][2] = others;
        both.corners[end][3] = others + 3;
      }
      if (distance_of(both.corners[0][0], both.corners[0][2]) > reach) continue;
      if (pieces_pass(&both)) return 1;
    }
  }
  return 0;
}

/* Whether the centre lines of two rods that may touch cut each other on the straight way of their sections from one shape to
   another, whose nodes stand in the workspace. */
static int rods_pass(const arrangement *from, const real *old, const arrangement *to, const real *z, workspace *work) {
  sample_rods(from, old, work->nodes_before, work->samples[1]);
  sample_rods(to, z, work->nodes, work->samples[0]);
  for (int p = 0; p < PAIRS; p++) {
    const int other = other_rod(PAIR[p].obstacle);
    if (other >= 0 && lines_pass(PAIR[p].rod, other, work)) return 1;
  }
  return 0;
}

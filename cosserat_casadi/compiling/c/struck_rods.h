/* Another rod in the place of an obstacle: declarations of struck_rods.c for contact_gaps.c, which is included
   between. */

#define RODS_FACE_RODS

/* Numbers that a change moves: position, or way from the section of another rod, and slopes of the gap along both rods. */
enum { OWN_SLOPE = 3, OTHER_SLOPE = 4, MOVED = 5 };

/* The section of the other rod that is nearest to a section, seen from there: its members are those of a gap. Its first node
   is counted among all points of the pair. */
typedef struct {
  real place;
  real value;
  real slope;
  real bend;
  real normal[3];
  real curvature[9];
  real tangent[3];
  int first;
  int nodes;
  real rows[2][MOST_NODES];
} other_section;

static real distance_from_other(const facing *own, const real *point, workspace *work);

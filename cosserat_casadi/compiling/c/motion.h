/* Types of the tables that motions are computed with; see step.c and elimination.c. */

/* Some entries of a vector of results: the kernel that gives them, the numbers of the state (x, v, a one after the other)
   and of the inputs (with rates and accelerations) that it reads, its constants, and where its entries belong. */
typedef struct {
  void (*kernel)(const real *, const real *, const real *, const real *, real *, workspace *);
  const int *state;
  const int *inputs;
  const real *constants;
  const int *entries;
  int state_count;
  int input_count;
  int entry_count;
} motion_part;

/* A block of unknowns, the interface unknowns that it touches, the start of its matrix. */
typedef struct {
  const int *members;
  const int *interface;
  int member_count;
  int interface_count;
  int start;
} stage_front;

/* In which order unknowns are eliminated: front after front, then the interface. Of each entry of the matrix its front,
   or front_count for those of the interface, and row and column there. */
typedef struct {
  const stage_front *fronts;
  const int *interface_members;
  const int *entry_fronts;
  const int *entry_rows;
  const int *entry_columns;
  int front_count;
  int interface;
  int interface_start;
} elimination;

/* A factorised matrix: what its rows and columns were scaled by, its factors, and whether the order AS_A_WHOLE served. */
typedef struct {
  real *rows;
  real *columns;
  real *matrix;
  int *pivots;
  int *as_a_whole;
} stage_factors;

typedef solver_instant instant;

enum {
  STAGES = 2,
  STAGED = 2 * SOLVER_UNKNOWNS, /* unknowns of all stages */
  FOUR = 4,                     /* right-hand sides that are solved for together */
  MATRICES = 3,                 /* stiffness, damping, mass */
  ORDERS = 3,                   /* derivatives by inputs, their rates, their accelerations */
  STAGE_ENTRIES = SOLVER_STAGE_ENTRIES
};

/* Types of the tables that cut a scene's equations rod by rod; see linear_blocks.c. */

/* Some entries of a vector of results: the kernel that gives them, the unknowns and inputs that it reads, its constants,
   and where its entries belong. */
typedef struct {
  void (*kernel)(const real *, const real *, const real *, const real *, real *, workspace *);
  const int *unknowns;
  const int *inputs;
  const real *constants;
  const int *entries;
  int unknown_count;
  int input_count;
  int entry_count;
} part;

/* The front of one rod: its unknowns, the interface unknowns that it touches, the start of its matrix. */
typedef struct {
  const int *members;
  const int *interface;
  int member_count;
  int interface_count;
  int start;
} front;

enum {
  ENTRIES = SOLVER_ENTRIES,
  FRONT_COUNT = SOLVER_FRONT_COUNT,
  FRONTS_SIZE = SOLVER_FRONTS_SIZE,
  INTERFACE = SOLVER_INTERFACE,
  INTERFACE_START = SOLVER_INTERFACE_START,
  MAX_ORDER = SOLVER_MAX_ORDER
};

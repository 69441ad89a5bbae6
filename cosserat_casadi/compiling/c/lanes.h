/* Lanes: the same arithmetic on several rows at once, one row in each lane of a vector of the processor. An array of
   lanes holds for each entry the numbers of LANES rows, one after the other.

   LANES is 0 where the compiler has no vectors; everything is then computed row after row. On x86 the code is made for
   AVX2, and processor_has_lanes tells whether there is; elsewhere the compiler splits vectors as it must. Sums and
   their order are those of one row, so that results are the same to the last digit. */
#ifndef LANES
#if defined(__GNUC__)
#define LANES 4
#else
#define LANES 0
#endif
#endif

/* Seen by the library alone. */
#if defined(__GNUC__) && !defined(_WIN32)
#define IN_LIBRARY __attribute__((visibility("hidden")))
#else
#define IN_LIBRARY
#endif

/* A kernel in lanes: arguments and results are arrays of lanes, and so is the room that it works in. */
#define IN_LANES(kernel) kernel##_in_lanes
#define KERNEL_IN_LANES(kernel) \
  IN_LIBRARY int IN_LANES(kernel)(const double **arguments, double **results, int *integers, double *reals)

/* Whether the processor that runs this has the vectors that the code in lanes is compiled for. */
IN_LIBRARY int processor_has_lanes(void);

/* Factorises LANES matrices in place. Gives pivots (size arrays of lanes), whether each matrix is regular, and whether
   its entries were finite. */
IN_LIBRARY void factorise_in_lanes(int size, double singular, double *matrices, int *pivots, int *regular, int *finite);

/* Brings right sides into the order of the pivots. */
IN_LIBRARY void permute_in_lanes(int size, const int *pivots, double *right_sides);

/* Solves with such factors, in place; the right sides are in the order of the pivots. */
IN_LIBRARY void substitute_in_lanes(int size, const double *factors, double *right_sides);

/* Steps of the updates of a Jacobian in lanes: for each lane their number, the steps one after the other, and the
   squares of their lengths. */
typedef struct {
  int counts[LANES ? LANES : 1];
  const double *steps[LANES ? LANES : 1];
  const double *squares[LANES ? LANES : 1];
} updates_in_lanes;

/* Quasi-Newton steps from minus the inverse of the Jacobian times the residual, as apply_updates and complete_step of
   solver_newton.c. earlier: room for two arrays of lanes. */
IN_LIBRARY void complete_steps_in_lanes(int size, const updates_in_lanes *updates, double *earlier, double *steps);

/* Adds an array of lanes to another. */
IN_LIBRARY void add_in_lanes(int size, const double *added, double *sums);

/* Sums of squares, a number for each lane. */
IN_LIBRARY void squares_in_lanes(int size, const double *in_lanes, double *squares);

/* Arrays of each row into an array of lanes, and out of it. */
IN_LIBRARY void gather_lanes(const double *const *sources, int count, double *in_lanes);
IN_LIBRARY void scatter_lanes(const double *in_lanes, int count, double *const *targets);

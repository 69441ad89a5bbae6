/* What the parts of the solver of rods in exact contact share: tables of the arrangements of contacts, and calls of their
   equations.

   The library's own source includes, in this order: its configuration, its kernels, this header, its tables, then
   square_systems.c, contact_newton.c, contact_shape.c, contact_faults.c, contact_settle.c and contact.c, which includes
   contact_error.c where errors are estimated, as this header includes blind_turns.c. All is one translation unit, so that
   nothing but the functions of the library's header is visible to a linker.

   An arrangement says who touches what, at points or along lines. Its unknowns are z = (x, f, p): the unknowns of the rods,
   the forces of the contacts, and the abscissae of contact that are not at a tip. */
#ifndef CONTACT_ARRANGEMENTS
#error "This file is a part of the library's own source: compile that one."
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "The solver looks for values that are not finite: compile without -ffast-math."
#endif

#include <math.h>
#include <string.h>

typedef contact_real real;
#define ABSOLUTE fabs
typedef contact_workspace workspace;
typedef contact_candidate candidate;
typedef contact_touch touch;

enum {
  ARRANGEMENTS = CONTACT_ARRANGEMENTS,
  INPUTS = CONTACT_INPUTS,
  RODS = CONTACT_RODS,
  OWNERS = CONTACT_OWNERS, /* of contacts: rods, then bodies where any may touch, each a ball with one section, at 1 */
  POSES = CONTACT_POSES, /* tips of rods, then bodies */
  PAIRS = CONTACT_PAIRS,
  MOST_TOUCHES = CONTACT_TOUCHES, /* contacts of any arrangement */
  TRIES = CONTACT_TRIES,          /* arrangements that are solved for one change of the inputs */
  CANDIDATES = CONTACT_CANDIDATES,
  POSE_SIZE = 7,    /* position and quaternion */
#ifdef RODS_TOUCH_RODS
  OBSTACLES = CONTACT_OBSTACLES, /* behind them rods are counted, which others touch in their place */
  SAMPLES_OF_ROD = CONTACT_SAMPLES_OF_ROD, /* intervals between the sections of a rod that are looked at first */
  CONTACT_RATES = 5 /* from, to, the forces there, and the place on another rod */
#else
  CONTACT_RATES = 4 /* from, to, and the forces there */
#endif
};

/* A generated function of z and of the inputs, or of a point. */
typedef int (*kernel)(const real **, real **, int *, real *, int);

/* A contact of an arrangement. */
typedef struct {
  int rod;
  int obstacle;
  int is_line;
  int ends;        /* 1 for a point, 2 for a line */
  int moving;      /* how many of its ends are sought: those that are not at the tip */
  int first_force; /* among the forces: of its ends, then along it */
  int along;       /* coefficients of the force along a line */
  int first_place; /* among the places */
#ifdef RODS_TOUCH_RODS
  real held[2]; /* ends of the rod, and of another rod that it touches, at which the place stays; -1 for a sought one */
#endif
} contact_entry;

/* The elements of a rod in an arrangement. */
typedef struct {
  int elements;
  int first_strain;        /* in x */
  int first_node;          /* among the nodes of all rods */
  const int *place_of_end; /* place of contact at which an element ends; -1 if its end is fixed */
  const real *nominal;     /* that abscissa; else where strains are counted in the element's own width */
} rod_elements;

/* A rod on the modes and nodes of an arrangement. */
typedef struct {
  int intervals;            /* of each element, one less than its nodes */
  const int *modes;         /* polynomials of each admitted strain in an element */
  int points;               /* at which strains are fitted */
  const real *local_points; /* these, in an element */
  const real *const *fits;  /* for each strain the matrix from its values there to coefficients, row after row */
  const real *local_nodes;
  const real *barycentric; /* weights of the interpolation between nodes */
} rod_modes;

#if CONTACT_ESTIMATES_ERRORS
#include "blind_turns.c"
#endif

typedef struct {
  int size; /* of z */
  int unknowns;
  int strains; /* of the unknowns, the first */
  int forces;
  int places;
  int touches;
  int nodes_of_rods;
  const contact_entry *touch;
  const rod_elements *rods;
  const rod_modes *modes; /* of every rod */
  kernel residual;
  kernel jacobian;
  kernel rate;     /* rate of the residual for rates of z and the inputs */
  kernel nodes;    /* positions of the nodes, and of bodies that may touch; whether they resolve the rods */
  kernel tips;     /* position and quaternion of every tip and body */
  kernel tip_rate; /* rates of the tips and bodies */
  kernel contacts; /* forces of the contacts in world axes, and at their ends */
#if CONTACT_ESTIMATES_ERRORS
  kernel watched; /* positions over lengths, quaternions, and lengths of cables over those of their rods */
  const turned_elements *turned; /* beside the richer modes */
#endif
#if CONTACT_ACTUATORS
  kernel actuators; /* efforts and their conjugates */
#endif
#if CONTACT_STABILITY
  kernel bends;      /* second derivative of the gap along the rod at every contact, over the length */
  const real *roots; /* of the energy unit of each unknown over the largest; zero of multipliers */
#endif
} arrangement;

/* Properties of a rod or a body in every arrangement. */
typedef struct {
  int rank; /* among the owners of contacts, in whose order an arrangement has them */
  int components;   /* admitted strains */
  int is_chebyshev; /* polynomials of strains; else Legendre's */
  real radius_at_base;
  real radius_at_tip;
  real length;
  real force_unit; /* EI/l2, N */
#if CONTACT_STABILITY
  real energy; /* unit of its energy over the largest */
#endif
} rod_entry;

#ifdef RODS_TOUCH_RODS
/* Number of the rod that another touches in the place of an obstacle; negative for an obstacle. */
static int other_rod(int obstacle) { return obstacle - OBSTACLES; }

#endif
/* A rod and an obstacle that it must not enter. */
typedef struct {
  int rod;
  int obstacle;
  kernel distance;
} pair_entry;

static void call(kernel function, const real *z, const real *inputs, real *first, real *second, workspace *work) {
  const real *arguments[CONTACT_KERNEL_ARGUMENTS] = {z, inputs};
  real *results[CONTACT_KERNEL_RESULTS] = {first, second};
  (void)function(arguments, results, work->kernel_integers, work->kernel_reals, 0);
}

/* A function of z, of the inputs and of their rates. */
static void call_rate(kernel function, const real *z, const real *inputs, const real *z_rate, const real *inputs_rate,
                      real *rate, workspace *work) {
  const real *arguments[CONTACT_KERNEL_ARGUMENTS] = {z, inputs, z_rate, inputs_rate};
  real *results[CONTACT_KERNEL_RESULTS] = {rate};
  (void)function(arguments, results, work->kernel_integers, work->kernel_reals, 0);
}

static real dot(const real *a, const real *b, int count) {
  real sum = 0;
  for (int i = 0; i < count; i++) sum += a[i] * b[i];
  return sum;
}

static real norm_of(const real *a, int count) { return sqrt(dot(a, a, count)); }

static int all_finite(const real *a, int count) {
  for (int i = 0; i < count; i++) {
    if (!isfinite(a[i])) return 0;
  }
  return 1;
}

static real larger(real a, real b) { return a > b ? a : b; }

static real smaller(real a, real b) { return a < b ? a : b; }

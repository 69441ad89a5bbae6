/* Functions of a model that C calls over and over: in machine code, as a program, or in Python. Libraries of simulated
   motions include this file; KernelRecord in cosserat_casadi/motion/contact_law.py has the layout of kernel. Uses:
   KERNEL_ARGUMENTS. */

/* A function in machine code, as CasADi calls it. */
typedef int (*casadi_kernel)(const real **arguments, real **results, long long *integers, real *scratch, int memory);

/* A function of the model. The caller writes the arguments into this memory, and reads the result from it. */
typedef struct {
  int counts[KERNEL_ARGUMENTS]; /* numbers of each argument */
  real *arguments[KERNEL_ARGUMENTS];
  real *result;
  casadi_kernel code; /* machine code; null without it */
  const real **code_arguments;
  real **code_results;
  long long *integers;
  real *scratch;
  const int *program; /* lines that work on slots of four lanes; null without a program */
  real *slots;
  int lines;
  int size; /* numbers of the program's result */
  void (*run)(const int *program, int lines, real *slots);
  int (*evaluate)(void); /* calls Python; not zero if Python raised an exception */
} kernel;

/* Calls a function. Returns 0 if Python raised an exception, which leaves the result without meaning. */
static int call(kernel *function) {
  if (function->code) {
    function->code(function->code_arguments, function->code_results, function->integers, function->scratch, 0);
  } else if (function->program) {
    real *slot = function->slots;
    for (int k = 0; k < KERNEL_ARGUMENTS; k++) {
      const real *values = function->arguments[k];
      for (int i = 0; i < function->counts[k]; i++, slot += 4) slot[0] = slot[1] = slot[2] = slot[3] = values[i];
    }
    function->run(function->program, function->lines, function->slots);
    for (int i = 0; i < function->size; i++) function->result[i] = slot[4 * i];
  } else {
    return !function->evaluate();
  }
  return 1;
}

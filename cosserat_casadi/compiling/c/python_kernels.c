/* Functions of a model that C calls over and over: in machine code, as a program, or in Python. Libraries of simulated
   motions include it; cosserat_casadi/motion/contact_law.py has the same record. Uses: KERNEL_ARGUMENTS. */

/* A function in machine code, as CasADi calls it. */
typedef int (*casadi_kernel)(const real **arguments, real **results, long long *integers, real *scratch, int memory);

/* A function of the model. Its arguments and its result, in this memory, are those of the last call. */
typedef struct {
  int counts[KERNEL_ARGUMENTS]; /* of numbers */
  real *arguments[KERNEL_ARGUMENTS];
  real *result;
  casadi_kernel code; /* null where there is none */
  const real **code_arguments;
  real **code_results;
  long long *integers;
  real *scratch;
  const int *program; /* on slots of four lanes; null where there is none */
  real *slots;
  int lines;
  int size; /* of the result of the program */
  void (*run)(const int *program, int lines, real *slots);
  int (*evaluate)(void); /* in Python; not zero where it was interrupted */
} kernel;

/* Zero where Python has raised something: no value counts then. */
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

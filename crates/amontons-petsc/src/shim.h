/* Plain functions over PETSc and MPI, so that their types and macros stay in C, where the compiler checks them.
 *
 * Every function returns 0, or an error code; am_error has the message then. Those on matrices, on solvers and on values
 * of all processes are collective: every process has to call them in the same order. Rows are numbered so that each
 * process owns a range of them. Vectors are the entries of the own rows. */
#ifndef AMONTONS_SHIM_H
#define AMONTONS_SHIM_H

#include <stddef.h>
#include <stdint.h>

/* A matrix whose rows are distributed, in blocks. */
typedef struct am_matrix am_matrix;
/* Krylov methods with the levels of a multigrid method. */
typedef struct am_solver am_solver;

/* What a Krylov method calls; `context` is passed on. Each returns 0, or another number if it fails. */
typedef int (*am_operator)(void *context, const double *in, double *out);
typedef struct {
  void *context;
  am_operator product;      /* the operator times a vector */
  am_operator precondition; /* an approximate solution */
  int (*norm)(void *context, const double *residual, double *norm); /* of a residual of conjugate gradients */
  int (*goes_on)(void *context);                                    /* 0: the iteration is to end */
  double goal;      /* norm of the residual at which the iteration ends */
  int limit;        /* products at most */
  int is_symmetric; /* by conjugate gradients; else by flexible GMRES */
} am_callbacks;

/* The preconditioner of am_levels: smoothed aggregation, a factor that every process has, a distributed factor. */
enum { AM_LEVELS = 0, AM_COPIES = 1, AM_FACTOR = 2 };
/* How am_solve ended. */
enum { AM_REACHED = 0, AM_LIMIT = 1, AM_STOPPED = 2, AM_FAILED = 3 };

int am_start(int *rank, int *size);
int am_finish(void);
void am_abort(int code);
void am_mute(void);
void am_unmute(void);
void am_say(const char *text);
const char *am_error(void);

int am_largest(uint64_t *values, int count);
int am_share(void *bytes, int count);
int am_sum(double *values, int count);
int am_gather(const double *own, int count, double *all, const int *counts, const int *starts);

int am_matrix_new(int nodes, int size, int kind, const int *inside, const int *outside, am_matrix **out);
int am_matrix_clear(am_matrix *matrix);
int am_matrix_add(am_matrix *matrix, int node, int count, const int *nodes, const double *blocks);
int am_matrix_ready(am_matrix *matrix);
int am_matrix_product(am_matrix *matrix, const double *in, double *out);
int am_matrix_modes(am_matrix *matrix, int count, const double *modes);
void am_matrix_free(am_matrix *matrix);

int am_solver_new(int rows, am_solver **out);
int am_levels(am_solver *solver, am_matrix *matrix, int kind);
int am_cycle(am_solver *solver, const double *in, double *out);
int am_solve(am_solver *solver, const am_callbacks *callbacks, const double *b, double *x, int *made);
void am_solver_free(am_solver *solver);

#endif

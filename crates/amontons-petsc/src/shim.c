#define _GNU_SOURCE /* memfd_create */
#include "shim.h"

#include <petscksp.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

struct am_matrix {
  Mat mat;
  Vec in, out;
  PetscInt size, first; /* of a block; first own node */
};

struct am_solver {
  KSP ksp;
  Mat op;
  PC levels;
  Vec b, x, in, out;
  const am_callbacks *callbacks; /* of the present call of am_solve */
  int has_stopped;
};

/* The first message of the present error: PETSc repeats it in every caller. */
static char message[1024];

static PetscErrorCode keep(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                           PetscErrorType type, const char *text, void *context)
{
  (void)comm, (void)line, (void)file, (void)context;
  if (type == PETSC_ERROR_INITIAL)
    snprintf(message, sizeof message, "%s: %s", function ? function : "PETSc", text ? text : "no message");
  return code ? code : PETSC_ERR_LIB;
}

const char *am_error(void) { return message[0] ? message : "an error without a message"; }

static int mpi(int code)
{
  int length = 0;
  char text[MPI_MAX_ERROR_STRING] = "";
  if (code == MPI_SUCCESS) return 0;
  MPI_Error_string(code, text, &length);
  snprintf(message, sizeof message, "MPI: %s", text);
  return code;
}

/* Starts MPI and PETSc. Calls come from one thread at a time, but not always from the same. */
int am_start(int *rank, int *size)
{
  int provided = 0, is_started = 0;
  PetscFunctionBeginUser;
  if (mpi(MPI_Initialized(&is_started))) return 1;
  if (!is_started && mpi(MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &provided))) return 1;
  if (!is_started && provided < MPI_THREAD_SERIALIZED) {
    snprintf(message, sizeof message, "this MPI cannot be called from several threads in turn (MPI_THREAD_SERIALIZED)");
    return 1;
  }
  /* The program handles signals itself. */
  PetscCall(PetscOptionsSetValue(NULL, "-no_signal_handler", "true"));
  PetscCall(PetscInitializeNoArguments());
  PetscCall(PetscPushErrorHandler(keep, NULL));
  if (mpi(MPI_Comm_rank(PETSC_COMM_WORLD, rank)) || mpi(MPI_Comm_size(PETSC_COMM_WORLD, size))) return 1;
  PetscFunctionReturn(0);
}

int am_finish(void)
{
  PetscErrorCode code = PetscFinalize();
  return code ? code : mpi(MPI_Finalize());
}

void am_abort(int code) { MPI_Abort(MPI_COMM_WORLD, code); }

/* Standard error as it was, and what is written there since. */
static int shown = STDERR_FILENO, hidden = -1;

/* Leads standard output nowhere, and standard error to memory. */
void am_mute(void)
{
  int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  shown = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  hidden = memfd_create("stderr", MFD_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO);
  if (hidden >= 0 || nowhere >= 0) dup2(hidden >= 0 ? hidden : nowhere, STDERR_FILENO);
  if (nowhere >= 0) close(nowhere);
}

static void say(const char *text, ssize_t length)
{
  while (length > 0) {
    ssize_t written = write(shown, text, (size_t)length);
    if (written <= 0) return;
    text += written;
    length -= written;
  }
}

/* Writes a text to standard error, muted or not. */
void am_say(const char *text) { say(text, (ssize_t)strlen(text)); }

/* Writes to standard error what was written there while it was muted. */
void am_unmute(void)
{
  char text[4096];
  ssize_t length;
  if (hidden < 0 || lseek(hidden, 0, SEEK_SET) < 0) return;
  while ((length = read(hidden, text, sizeof text)) > 0) say(text, length);
}

int am_largest(uint64_t *values, int count)
{
  return mpi(MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_UINT64_T, MPI_MAX, PETSC_COMM_WORLD));
}

int am_share(void *bytes, int count) { return mpi(MPI_Bcast(bytes, count, MPI_BYTE, 0, PETSC_COMM_WORLD)); }

int am_sum(double *values, int count)
{
  return mpi(MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD));
}

int am_gather(const double *own, int count, double *all, const int *counts, const int *starts)
{
  return mpi(MPI_Allgatherv(own, count, MPI_DOUBLE, all, counts, starts, MPI_DOUBLE, PETSC_COMM_WORLD));
}

/* A vector over the own entries of `values`, which are not copied. */
static PetscErrorCode around(Vec vec, const double *values)
{
  return VecPlaceArray(vec, (PetscScalar *)(uintptr_t)values);
}

/* A matrix of own nodes with blocks of `size`² entries, by the numbers of blocks per row among the own columns and
 * among those of other processes: for a preconditioner, or for products if `kind` is negative. Preconditioners need a
 * matrix by entries; products are faster by blocks. A matrix with the contact as it is need not be symmetric. */
int am_matrix_new(int nodes, int size, int kind, const int *inside, const int *outside, am_matrix **out)
{
  am_matrix *made;
  PetscFunctionBeginUser;
  message[0] = 0;
  PetscCall(PetscNew(&made));
  *out = made;
  made->size = size;
  PetscCall(MatCreate(PETSC_COMM_WORLD, &made->mat));
  PetscCall(MatSetSizes(made->mat, nodes * size, nodes * size, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSize(made->mat, size));
  PetscCall(MatSetType(made->mat, kind >= 0 || size == 1 ? MATAIJ : MATBAIJ));
  PetscCall(MatXAIJSetPreallocation(made->mat, size, inside, outside, NULL, NULL));
  PetscCall(MatSetOption(made->mat, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_TRUE));
  PetscCall(MatSetOption(made->mat, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  if (kind <= AM_LEVELS) PetscCall(MatSetOption(made->mat, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatGetOwnershipRange(made->mat, &made->first, NULL));
  made->first /= size;
  PetscCall(VecCreateMPIWithArray(PETSC_COMM_WORLD, size, nodes * size, PETSC_DECIDE, NULL, &made->in));
  PetscCall(VecCreateMPIWithArray(PETSC_COMM_WORLD, size, nodes * size, PETSC_DECIDE, NULL, &made->out));
  PetscFunctionReturn(0);
}

/* Sets all entries to zero and keeps their places. */
int am_matrix_clear(am_matrix *matrix) { return MatZeroEntries(matrix->mat); }

/* Adds blocks of a row: `blocks` has the first rows of all of them, then the second rows. `node` counts own nodes, and
 * `nodes` all. */
int am_matrix_add(am_matrix *matrix, int node, int count, const int *nodes, const double *blocks)
{
  PetscInt row = matrix->first + node;
  return MatSetValuesBlocked(matrix->mat, 1, &row, count, nodes, blocks, ADD_VALUES);
}

int am_matrix_ready(am_matrix *matrix)
{
  PetscFunctionBeginUser;
  PetscCall(MatAssemblyBegin(matrix->mat, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix->mat, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

int am_matrix_product(am_matrix *matrix, const double *in, double *out)
{
  PetscFunctionBeginUser;
  PetscCall(around(matrix->in, in));
  PetscCall(around(matrix->out, out));
  PetscCall(MatMult(matrix->mat, matrix->in, matrix->out));
  PetscCall(VecResetArray(matrix->in));
  PetscCall(VecResetArray(matrix->out));
  PetscFunctionReturn(0);
}

/* Motions of nearly zero energy, one vector of own rows after the other. PETSc wants them orthonormal; motions that
 * depend on the others are left out. */
int am_matrix_modes(am_matrix *matrix, int count, const double *modes)
{
  Vec kept[8];
  PetscInt own, made = 0;
  MatNullSpace space;
  PetscFunctionBeginUser;
  PetscCall(MatGetLocalSize(matrix->mat, &own, NULL));
  for (int k = 0; k < count && k < 8; ++k) {
    PetscReal before, after;
    PetscScalar *values;
    PetscCall(MatCreateVecs(matrix->mat, &kept[made], NULL));
    PetscCall(VecGetArray(kept[made], &values));
    memcpy(values, modes + (size_t)k * own, (size_t)own * sizeof *modes);
    PetscCall(VecRestoreArray(kept[made], &values));
    PetscCall(VecNorm(kept[made], NORM_2, &before));
    for (int pass = 0; pass < 2; ++pass) {
      for (PetscInt j = 0; j < made; ++j) {
        PetscScalar along;
        PetscCall(VecDot(kept[made], kept[j], &along));
        PetscCall(VecAXPY(kept[made], -along, kept[j]));
      }
    }
    PetscCall(VecNorm(kept[made], NORM_2, &after));
    if (after <= 1e-8 * before || before <= 0) {
      PetscCall(VecDestroy(&kept[made]));
      continue;
    }
    PetscCall(VecScale(kept[made], 1 / after));
    ++made;
  }
  PetscCall(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, made, kept, &space));
  PetscCall(MatSetNearNullSpace(matrix->mat, space));
  PetscCall(MatNullSpaceDestroy(&space));
  for (PetscInt k = 0; k < made; ++k) PetscCall(VecDestroy(&kept[k]));
  PetscFunctionReturn(0);
}

void am_matrix_free(am_matrix *matrix)
{
  PetscBool has_ended = PETSC_FALSE;
  if (!matrix || PetscFinalized(&has_ended) || has_ended) return;
  (void)MatDestroy(&matrix->mat);
  (void)VecDestroy(&matrix->in);
  (void)VecDestroy(&matrix->out);
  (void)PetscFree(matrix);
}

/* Calls an operator of the program with the own entries of two vectors. */
static PetscErrorCode call(am_solver *solver, am_operator of, Vec in, Vec out)
{
  const PetscScalar *from;
  PetscScalar *to;
  int failed;
  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(in, &from));
  PetscCall(VecGetArrayWrite(out, &to));
  failed = of(solver->callbacks->context, from, to);
  PetscCall(VecRestoreArrayWrite(out, &to));
  PetscCall(VecRestoreArrayRead(in, &from));
  PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_USER, "an operator of the program failed");
  PetscFunctionReturn(0);
}

static PetscErrorCode product(Mat mat, Vec in, Vec out)
{
  am_solver *solver;
  PetscFunctionBegin;
  PetscCall(MatShellGetContext(mat, &solver));
  PetscCall(call(solver, solver->callbacks->product, in, out));
  PetscFunctionReturn(0);
}

static PetscErrorCode precondition(PC pc, Vec in, Vec out)
{
  am_solver *solver;
  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &solver));
  PetscCall(call(solver, solver->callbacks->precondition, in, out));
  PetscFunctionReturn(0);
}

/* Ends at the goal. Conjugate gradients measure their residual by the norm of the program; GMRES works with a residual
 * that is weighed already. */
static PetscErrorCode test(KSP ksp, PetscInt made, PetscReal norm, KSPConvergedReason *reason, void *context)
{
  am_solver *solver = context;
  PetscFunctionBegin;
  (void)made;
  *reason = KSP_CONVERGED_ITERATING;
  if (solver->callbacks->is_symmetric) {
    Vec residual;
    const PetscScalar *values;
    int failed;
    PetscCall(KSPBuildResidual(ksp, NULL, solver->in, &residual));
    PetscCall(VecGetArrayRead(residual, &values));
    failed = solver->callbacks->norm(solver->callbacks->context, values, &norm);
    PetscCall(VecRestoreArrayRead(residual, &values));
    PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_USER, "a norm of the program failed");
  }
  if (PetscIsInfOrNanReal(norm)) {
    *reason = KSP_DIVERGED_NANORINF;
  } else if (norm <= solver->callbacks->goal) {
    *reason = KSP_CONVERGED_ATOL;
  } else if (!solver->callbacks->goes_on(solver->callbacks->context)) {
    solver->has_stopped = 1;
    *reason = KSP_DIVERGED_BREAKDOWN;
  }
  PetscFunctionReturn(0);
}

/* A solver of `rows` own unknowns. Options of experts have the prefix amontons_. */
int am_solver_new(int rows, am_solver **out)
{
  am_solver *made;
  PC pc;
  PetscFunctionBeginUser;
  message[0] = 0;
  PetscCall(PetscNew(&made));
  *out = made;
  PetscCall(MatCreateShell(PETSC_COMM_WORLD, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, made, &made->op));
  PetscCall(MatShellSetOperation(made->op, MATOP_MULT, (void (*)(void))product));
  PetscCall(MatCreateVecs(made->op, &made->in, &made->out));
  PetscCall(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, rows, PETSC_DECIDE, NULL, &made->b));
  PetscCall(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, rows, PETSC_DECIDE, NULL, &made->x));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &made->ksp));
  PetscCall(KSPSetOptionsPrefix(made->ksp, "amontons_"));
  PetscCall(KSPSetOperators(made->ksp, made->op, made->op));
  PetscCall(KSPGetPC(made->ksp, &pc));
  /* The prefix of the levels is that of the solver, so that -amontons_pc_type is theirs. */
  PetscCall(PCSetOptionsPrefix(pc, "amontons_contact_"));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, made));
  PetscCall(PCShellSetApply(pc, precondition));
  PetscFunctionReturn(0);
}

static PetscErrorCode set_kind(PC pc, int kind)
{
  KSP copy;
  PC lu;
  PetscFunctionBegin;
  switch (kind) {
  case AM_COPIES:
    /* A distributed factor of a small matrix would only send messages. */
    PetscCall(PCSetType(pc, PCREDUNDANT));
    PetscCall(PCRedundantGetKSP(pc, &copy));
    PetscCall(KSPGetPC(copy, &lu));
    PetscCall(PCSetType(lu, PCLU));
    PetscCall(PCFactorSetShiftType(lu, MAT_SHIFT_NONZERO));
    break;
  case AM_FACTOR:
    PetscCall(PCSetType(pc, PCLU));
    PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
    break;
  default:
    PetscCall(PCSetType(pc, PCGAMG));
    PetscCall(PCGAMGSetReuseInterpolation(pc, PETSC_TRUE));
    PetscCall(PCGAMGSetCoarseEqLim(pc, 500));
  }
  PetscFunctionReturn(0);
}

/* Makes the preconditioner of a kind from a matrix. Called again with the same matrix and other entries it keeps the
 * interpolations between levels, or the order of elimination. */
int am_levels(am_solver *solver, am_matrix *matrix, int kind)
{
  Mat before = NULL;
  PetscFunctionBeginUser;
  message[0] = 0;
  if (solver->levels) PetscCall(PCGetOperators(solver->levels, NULL, &before));
  if (before != matrix->mat) {
    PetscCall(PCDestroy(&solver->levels));
    PetscCall(PCCreate(PETSC_COMM_WORLD, &solver->levels));
    PetscCall(PCSetOptionsPrefix(solver->levels, "amontons_"));
    PetscCall(PCSetOperators(solver->levels, matrix->mat, matrix->mat));
    PetscCall(set_kind(solver->levels, kind));
    PetscCall(PCSetFromOptions(solver->levels));
  } else {
    PetscCall(PCSetOperators(solver->levels, matrix->mat, matrix->mat));
  }
  PetscCall(PCSetUp(solver->levels));
  PetscFunctionReturn(0);
}

/* An approximate solution by the levels. */
int am_cycle(am_solver *solver, const double *in, double *out)
{
  PetscFunctionBeginUser;
  PetscCall(around(solver->in, in));
  PetscCall(around(solver->out, out));
  PetscCall(PCApply(solver->levels, solver->in, solver->out));
  PetscCall(VecResetArray(solver->in));
  PetscCall(VecResetArray(solver->out));
  PetscFunctionReturn(0);
}

static PetscErrorCode set_up(am_solver *solver)
{
  const am_callbacks *callbacks = solver->callbacks;
  PetscFunctionBegin;
  PetscCall(KSPSetType(solver->ksp, callbacks->is_symmetric ? KSPCG : KSPFGMRES));
  PetscCall(KSPSetNormType(solver->ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetInitialGuessNonzero(solver->ksp, PETSC_FALSE));
  if (!callbacks->is_symmetric) PetscCall(KSPGMRESSetRestart(solver->ksp, callbacks->limit));
  PetscCall(KSPSetTolerances(solver->ksp, 0, 0, PETSC_MAX_REAL, callbacks->limit));
  PetscCall(KSPSetFromOptions(solver->ksp));
  PetscCall(KSPSetConvergenceTest(solver->ksp, test, solver, NULL));
  PetscFunctionReturn(0);
}

/* Iterates from zero until the norm of the residual is small enough. Returns how it ended, or -1 after an error. */
int am_solve(am_solver *solver, const am_callbacks *callbacks, const double *b, double *x, int *made)
{
  KSPConvergedReason reason;
  PetscInt products;
  PetscErrorCode code;
  message[0] = 0;
  solver->callbacks = callbacks;
  solver->has_stopped = 0;
  if (set_up(solver) || around(solver->b, b)) return -1;
  if (around(solver->x, x)) return -1;
  code = KSPSolve(solver->ksp, solver->b, solver->x);
  if (VecResetArray(solver->b) || VecResetArray(solver->x) || code) return -1;
  if (KSPGetConvergedReason(solver->ksp, &reason) || KSPGetIterationNumber(solver->ksp, &products)) return -1;
  *made = (int)products;
  if (reason > 0) return AM_REACHED;
  if (solver->has_stopped) return AM_STOPPED;
  return reason == KSP_DIVERGED_ITS ? AM_LIMIT : AM_FAILED;
}

void am_solver_free(am_solver *solver)
{
  PetscBool has_ended = PETSC_FALSE;
  if (!solver || PetscFinalized(&has_ended) || has_ended) return;
  (void)KSPDestroy(&solver->ksp);
  (void)PCDestroy(&solver->levels);
  (void)MatDestroy(&solver->op);
  (void)VecDestroy(&solver->b);
  (void)VecDestroy(&solver->x);
  (void)VecDestroy(&solver->in);
  (void)VecDestroy(&solver->out);
  (void)PetscFree(solver);
}

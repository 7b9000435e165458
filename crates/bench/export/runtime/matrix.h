/* dynoid runtime. Small dense matrices: the matrix exponential, and the exact step of a linear system. */
#ifndef DYNOID_MATRIX_H
#define DYNOID_MATRIX_H

/* States of the bench, and the size of the matrix whose exponential gives its step. */
#define STATES 6
#define INPUTS 2
#define MATRIX (STATES + 2 * INPUTS)

/* dx/dt = a x + b u. */
typedef struct {
    double a[STATES][STATES];
    double b[STATES][INPUTS];
} linear_system;

/* x(t + seconds) = transition x + first u(t) + last u(t + seconds), for inputs that run straight in between. */
typedef struct {
    double seconds;
    double transition[STATES][STATES];
    double first[STATES][INPUTS];
    double last[STATES][INPUTS];
} linear_step;

/* The exact step of a system. Returns 0 if it leaves the finite numbers. */
int linear_step_of(const linear_system *system, double seconds, linear_step *step);

/* One step of the state. */
void linear_step_apply(const linear_step *step, double x[STATES], const double u0[INPUTS], const double u1[INPUTS]);

#endif

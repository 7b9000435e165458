/* dynoid runtime. A linear model on the clock of its data: x(k + 1) = A x(k) + B u(k), y(k) = C x(k) + D u(k).
 *
 * Use: keep the state x yourself, at first the initial state or zeros. At each sample call linear_output with the inputs of the
 * sample, then linear_advance with the same inputs. Matrices are in rows. No function allocates or keeps anything elsewhere. */
#ifndef DYNOID_LINEAR_H
#define DYNOID_LINEAR_H

typedef struct {
    int states, inputs, outputs;
    double sample_time_s;
    const double *a, *b, *c, *d;
} linear_model;

/* The outputs at a sample. */
void linear_output(const linear_model *model, const double *x, const double *u, double *y);

/* The state of the next sample. `x` and `next` are not the same. */
void linear_advance(const linear_model *model, const double *x, const double *u, double *next);

#endif

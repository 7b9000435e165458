/* dynoid runtime. A linear model on the clock of its data; see linear.h. */
#include "linear.h"

static double product(const double *row, const double *vector, int count) {
    double sum = 0.0;
    for (int j = 0; j < count; j++) sum += row[j] * vector[j];
    return sum;
}

void linear_output(const linear_model *model, const double *x, const double *u, double *y) {
    int n = model->states, m = model->inputs;
    for (int i = 0; i < model->outputs; i++) y[i] = product(model->c + i * n, x, n) + product(model->d + i * m, u, m);
}

void linear_advance(const linear_model *model, const double *x, const double *u, double *next) {
    int n = model->states, m = model->inputs;
    for (int i = 0; i < n; i++) next[i] = product(model->a + i * n, x, n) + product(model->b + i * m, u, m);
}

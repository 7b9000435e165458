/* dynoid runtime. The matrix exponential by scaling and squaring with a Pade approximant of degree 13 (Higham, SIAM J. Matrix Anal.
 * Appl. 26 (2005) 1179), and the first-order hold of a linear system by it. */
#include "matrix.h"

#include <math.h>
#include <string.h>

typedef double square[MATRIX][MATRIX];

static const double PADE[14] = {
    64764752532480000.0, 32382376266240000.0, 7771770303897600.0, 1187353796428800.0, 129060195264000.0,
    10559470521600.0,    670442572800.0,      33522128640.0,      1323241920.0,       40840800.0,
    960960.0,            16380.0,             182.0,              1.0,
};
/* Largest norm for which the approximant is exact to working precision. */
static const double THETA = 5.371920351148152;

static void multiply(square a, square b, square product) {
    square result;
    for (int i = 0; i < MATRIX; i++) {
        for (int j = 0; j < MATRIX; j++) {
            double sum = 0.0;
            for (int k = 0; k < MATRIX; k++) sum += a[i][k] * b[k][j];
            result[i][j] = sum;
        }
    }
    memcpy(product, result, sizeof result);
}

/* The largest sum of a column. */
static double norm(square a) {
    double largest = 0.0;
    for (int j = 0; j < MATRIX; j++) {
        double sum = 0.0;
        for (int i = 0; i < MATRIX; i++) sum += fabs(a[i][j]);
        if (!(sum <= largest)) largest = sum; /* NaN is kept */
    }
    return largest;
}

/* c6 a6 + c4 a4 + c2 a2 + c0 1. */
static void combine(square powers[3], const double c[4], square sum) {
    for (int i = 0; i < MATRIX; i++) {
        for (int j = 0; j < MATRIX; j++) {
            sum[i][j] = c[3] * powers[2][i][j] + c[2] * powers[1][i][j] + c[1] * powers[0][i][j] + (i == j ? c[0] : 0.0);
        }
    }
}

/* Solves left x = right in place, by Gaussian elimination with pivots from the column. Returns 0 if left is singular. */
static int solve(square left, square right) {
    for (int k = 0; k < MATRIX; k++) {
        int pivot = k;
        for (int i = k + 1; i < MATRIX; i++) {
            if (fabs(left[i][k]) > fabs(left[pivot][k])) pivot = i;
        }
        if (!(fabs(left[pivot][k]) > 0.0)) return 0;
        for (int j = 0; j < MATRIX; j++) {
            double upper = left[k][j], other = right[k][j];
            left[k][j] = left[pivot][j];
            left[pivot][j] = upper;
            right[k][j] = right[pivot][j];
            right[pivot][j] = other;
        }
        for (int i = 0; i < MATRIX; i++) {
            double factor = i == k ? 0.0 : left[i][k] / left[k][k];
            if (factor == 0.0) continue;
            for (int j = k; j < MATRIX; j++) left[i][j] -= factor * left[k][j];
            for (int j = 0; j < MATRIX; j++) right[i][j] -= factor * right[k][j];
        }
    }
    for (int i = 0; i < MATRIX; i++) {
        for (int j = 0; j < MATRIX; j++) right[i][j] /= left[i][i];
    }
    return 1;
}

/* The approximant of e^a, in place. */
static int pade(square a) {
    square powers[3], high, odd, even, left;
    const double high_odd[4] = {0.0, PADE[9], PADE[11], PADE[13]};
    const double low_odd[4] = {PADE[1], PADE[3], PADE[5], PADE[7]};
    const double high_even[4] = {0.0, PADE[8], PADE[10], PADE[12]};
    const double low_even[4] = {PADE[0], PADE[2], PADE[4], PADE[6]};
    multiply(a, a, powers[0]);
    multiply(powers[0], powers[0], powers[1]);
    multiply(powers[1], powers[0], powers[2]);
    combine(powers, high_odd, high);
    multiply(powers[2], high, high);
    combine(powers, low_odd, odd);
    for (int i = 0; i < MATRIX * MATRIX; i++) (&odd[0][0])[i] += (&high[0][0])[i];
    multiply(a, odd, odd);
    combine(powers, high_even, high);
    multiply(powers[2], high, high);
    combine(powers, low_even, even);
    for (int i = 0; i < MATRIX; i++) {
        for (int j = 0; j < MATRIX; j++) {
            even[i][j] += high[i][j];
            left[i][j] = even[i][j] - odd[i][j];
            a[i][j] = even[i][j] + odd[i][j];
        }
    }
    return solve(left, a);
}

/* e^a in place. Returns 0 if it is not finite. */
static int exponential(square a) {
    double size = norm(a);
    int squarings = 0;
    if (!(size < 1e15)) return 0;
    while (size > THETA) {
        size *= 0.5;
        squarings++;
    }
    for (int i = 0; i < MATRIX * MATRIX; i++) (&a[0][0])[i] = ldexp((&a[0][0])[i], -squarings);
    if (!pade(a)) return 0;
    for (int i = 0; i < squarings; i++) multiply(a, a, a);
    return isfinite(norm(a));
}

/* e^[A B 0; 0 0 1; 0 0 0] = [F G1 G2; 0 1 1; 0 0 1] gives x1 = F x0 + (G1 - G2) u0 + G2 u1. */
int linear_step_of(const linear_system *system, double seconds, linear_step *step) {
    square generator;
    memset(generator, 0, sizeof generator);
    for (int i = 0; i < STATES; i++) {
        for (int j = 0; j < STATES; j++) generator[i][j] = system->a[i][j] * seconds;
        for (int j = 0; j < INPUTS; j++) generator[i][STATES + j] = system->b[i][j] * seconds;
    }
    for (int j = 0; j < INPUTS; j++) generator[STATES + j][STATES + INPUTS + j] = 1.0;
    if (!exponential(generator)) return 0;
    step->seconds = seconds;
    for (int i = 0; i < STATES; i++) {
        for (int j = 0; j < STATES; j++) step->transition[i][j] = generator[i][j];
        for (int j = 0; j < INPUTS; j++) {
            step->last[i][j] = generator[i][STATES + INPUTS + j];
            step->first[i][j] = generator[i][STATES + j] - step->last[i][j];
        }
    }
    return 1;
}

void linear_step_apply(const linear_step *step, double x[STATES], const double u0[INPUTS], const double u1[INPUTS]) {
    double next[STATES];
    for (int i = 0; i < STATES; i++) {
        double free = 0.0, forced = 0.0;
        for (int j = 0; j < STATES; j++) free += step->transition[i][j] * x[j];
        for (int j = 0; j < INPUTS; j++) forced += step->first[i][j] * u0[j] + step->last[i][j] * u1[j];
        next[i] = free + forced;
    }
    memcpy(x, next, sizeof next);
}

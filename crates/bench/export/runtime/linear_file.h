/* A linear model, as the file `linear.txt` among an FMU's resources holds it. */
#ifndef DYNOID_LINEAR_FILE_H
#define DYNOID_LINEAR_FILE_H

#include "linear.h"

typedef struct {
    char token[64];          /* of the model description that belongs to it */
    int draws;               /* of the covariance, after the estimate */
    linear_model estimate;   /* its matrices are the first of those in `numbers` */
    double *numbers;         /* A, B, C and D of the estimate, then of each draw */
} linear_file;

/* Reads the file in a folder, whose path is in UTF-8. Returns what is wrong, or NULL. */
const char *linear_file_read(linear_file *file, const char *folder);

/* The estimate for 0, or a draw. */
linear_model linear_file_draw(const linear_file *file, int draw);

void linear_file_free(linear_file *file);

#endif

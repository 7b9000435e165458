/* The model of one bench, as the file `bench.txt` among an FMU's resources holds it. */
#ifndef DYNOID_MODEL_FILE_H
#define DYNOID_MODEL_FILE_H

#include "bench.h"

typedef struct {
    char token[64];                       /* of the model description that belongs to it */
    int has_speed_control;
    double estimate[BENCH_PARAMETERS];
    bench_initial initial;
    double speed_range_rad_s[2];          /* in which the model was validated */
    double torque_range_nm[2];            /* of T_d */
    double nominal[STATES];               /* how large each state usually is, as the model description has it */
    int draws, columns;
    int column[BENCH_PARAMETERS];         /* the parameters that a draw has, in its order */
    double *draw;                         /* one row a draw */
} bench_model;

/* The names of the parameters, in their order. */
extern const char *const BENCH_NAMES[BENCH_PARAMETERS];

/* Reads the file in a folder, whose path is in UTF-8. Returns what is wrong, or NULL. */
const char *model_file_read(bench_model *model, const char *folder);

void model_file_free(bench_model *model);

#endif

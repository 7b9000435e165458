/* Reads the model of a bench; see model_file.h. */
#include "model_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "text_file.h"

const char *const BENCH_NAMES[BENCH_PARAMETERS] = {
    "J_d", "J_e", "K", "B", "K_p", "K_i", "tau_c", "tau_n", "k", "k_a", "tau_f", "tau_t", "a", "T_limit", "T_gate", "T_s",
};

static const int MOST_DRAWS = 100000;

/* ---- entries ------------------------------------------------------------------------------------------------- */

static int parameter_named(const char *name) {
    for (int i = 0; i < BENCH_PARAMETERS; i++) {
        if (strcmp(name, BENCH_NAMES[i]) == 0) return i;
    }
    return -1;
}

/* draws COUNT COLUMNS NAME ... and the rows. */
static const char *read_draws(bench_model *model, char **rest) {
    size_t count;
    if (model->draw) return "bench.txt has two sets of draws";
    if (!text_whole(rest, MOST_DRAWS, &model->draws) || !text_whole(rest, BENCH_PARAMETERS, &model->columns)) {
        return "bench.txt: the number of draws cannot be read";
    }
    for (int i = 0; i < model->columns; i++) {
        const char *name = text_word(rest);
        model->column[i] = name ? parameter_named(name) : -1;
        if (model->column[i] < 0) return "bench.txt: a draw has an unknown parameter";
    }
    count = (size_t)model->draws * (size_t)model->columns;
    model->draw = (double *)calloc(count + 1, sizeof(double));
    if (!model->draw) return "there is no memory for the draws";
    return text_numbers(rest, model->draw, (int)count) ? NULL : "bench.txt: a draw cannot be read";
}

static const char *read_entry(bench_model *model, const char *name, char **rest) {
    int parameter = parameter_named(name), yes = 0;
    if (parameter >= 0) {
        return text_numbers(rest, &model->estimate[parameter], 1) ? NULL : "bench.txt: a parameter cannot be read";
    }
    if (strcmp(name, "token") == 0) {
        const char *token = text_word(rest);
        if (!token || strlen(token) >= sizeof model->token) return "bench.txt: the token cannot be read";
        strcpy(model->token, token);
        return NULL;
    }
    if (strcmp(name, "speed_control") == 0) {
        if (!text_whole(rest, 1, &yes)) return "bench.txt: speed_control is neither 0 nor 1";
        model->has_speed_control = yes;
        return NULL;
    }
    if (strcmp(name, "initial") == 0) {
        double start[2];
        if (!text_numbers(rest, start, 2)) return "bench.txt: the initial speed and torque cannot be read";
        model->initial.speed_rad_s = start[0];
        model->initial.torque_nm = start[1];
        return NULL;
    }
    if (strcmp(name, "speed_range") == 0) {
        return text_numbers(rest, model->speed_range_rad_s, 2) ? NULL : "bench.txt: the range of speed cannot be read";
    }
    if (strcmp(name, "torque_range") == 0) {
        return text_numbers(rest, model->torque_range_nm, 2) ? NULL : "bench.txt: the range of torque cannot be read";
    }
    if (strcmp(name, "nominals") == 0) {
        return text_numbers(rest, model->nominal, STATES) ? NULL : "bench.txt: the nominals of the states cannot be read";
    }
    if (strcmp(name, "draws") == 0) return read_draws(model, rest);
    return "bench.txt has an unknown entry; it was written for another version";
}

static const char *read_text(bench_model *model, char *text) {
    char *rest = text, *name = text_word(&rest);
    int version = 0;
    if (!name || strcmp(name, "dynoid-bench") != 0) return "bench.txt is no model of a bench";
    if (!text_whole(&rest, 1, &version) || version != 1) return "bench.txt has another version than 1";
    while ((name = text_word(&rest)) != NULL) {
        const char *fault;
        if (strcmp(name, "end") == 0) return bench_fault(model->estimate);
        fault = read_entry(model, name, &rest);
        if (fault) return fault;
    }
    return "bench.txt ends too early";
}

const char *model_file_read(bench_model *model, const char *folder) {
    char *text;
    const char *fault;
    memset(model, 0, sizeof *model);
    model->speed_range_rad_s[0] = model->torque_range_nm[0] = -HUGE_VAL;
    model->speed_range_rad_s[1] = model->torque_range_nm[1] = HUGE_VAL;
    for (int i = 0; i < STATES; i++) model->nominal[i] = 1.0;
    fault = text_file_read(folder, "bench.txt", &text);
    if (fault) return fault;
    fault = read_text(model, text);
    free(text);
    if (fault) model_file_free(model);
    return fault;
}

void model_file_free(bench_model *model) {
    free(model->draw);
    model->draw = NULL;
}

/* Reads the model file: words between blanks, comments from # to the end of the line, numbers in hexadecimal, since
 * these are exact and do not depend on the decimal sign of the host. */
#include "model_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const BENCH_NAMES[BENCH_PARAMETERS] = {
    "J_d", "J_e", "K", "B", "K_p", "K_i", "tau_c", "tau_n", "k", "k_a", "tau_f", "tau_t", "a", "T_limit", "T_gate", "T_s",
};

/* No file of ours is larger. */
static const size_t LARGEST = 4u << 20;
static const int MOST_DRAWS = 100000;

/* ---- the file as text ---------------------------------------------------------------------------------------- */

#ifdef _WIN32
/* Windows opens a path in UTF-16. */
static FILE *open_file(const char *path) {
    size_t length = strlen(path), n = 0;
    wchar_t *wide = (wchar_t *)calloc(length + 1, sizeof(wchar_t));
    FILE *file;
    if (!wide) return NULL;
    for (const unsigned char *c = (const unsigned char *)path; *c;) {
        int more = *c < 0x80 ? 0 : *c < 0xe0 ? 1 : *c < 0xf0 ? 2 : 3;
        unsigned long code = more == 0 ? *c : (unsigned long)(*c & (0x3f >> more));
        for (c++; more > 0 && (*c & 0xc0) == 0x80; more--) code = code << 6 | (*c++ & 0x3f);
        if (code >= 0x10000) {
            wide[n++] = (wchar_t)(0xd800 + ((code - 0x10000) >> 10));
            code = 0xdc00 + ((code - 0x10000) & 0x3ff);
        }
        wide[n++] = (wchar_t)code;
    }
    file = _wfopen(wide, L"rb");
    free(wide);
    return file;
}
#else
static FILE *open_file(const char *path) { return fopen(path, "rb"); }
#endif

static char *text_of(FILE *file) {
    char *text = (char *)malloc(LARGEST + 1);
    size_t length;
    if (!text) return NULL;
    length = fread(text, 1, LARGEST + 1, file);
    if (length > LARGEST || ferror(file)) {
        free(text);
        return NULL;
    }
    text[length] = '\0';
    return text;
}

/* ---- words --------------------------------------------------------------------------------------------------- */

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* The next word, ended with a zero; NULL at the end. */
static char *word(char **rest) {
    char *c = *rest, *start;
    while (is_blank(*c) || *c == '#') {
        if (*c == '#') {
            while (*c && *c != '\n') c++;
        } else {
            c++;
        }
    }
    if (!*c) return NULL;
    start = c;
    while (*c && !is_blank(*c)) c++;
    if (*c) *c++ = '\0';
    *rest = c;
    return start;
}

static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* A number as C's %a writes it, or "inf". Returns 0 for anything else. */
static int number(const char *text, double *value) {
    int negative = *text == '-', after_point = 0, exponent = 0, sign = 1, digits = 0;
    double sum = 0.0;
    if (negative) text++;
    if (strcmp(text, "inf") == 0) {
        *value = negative ? -HUGE_VAL : HUGE_VAL;
        return 1;
    }
    if (text[0] != '0' || text[1] != 'x') return 0;
    for (text += 2; digit(*text) >= 0 || *text == '.'; text++) {
        if (*text == '.') {
            after_point = 1;
            continue;
        }
        if (++digits > 14) return 0;
        sum = sum * 16.0 + digit(*text);
        if (after_point) exponent -= 4;
    }
    if (digits == 0 || *text++ != 'p') return 0;
    if (*text == '-') sign = -1;
    if (*text == '-' || *text == '+') text++;
    int written = 0;
    for (; *text >= '0' && *text <= '9' && written < 10000; text++) written = written * 10 + (*text - '0');
    *value = ldexp(negative ? -sum : sum, exponent + sign * written);
    return *text == '\0';
}

static int numbers(char **rest, double *values, int count) {
    for (int i = 0; i < count; i++) {
        const char *next = word(rest);
        if (!next || !number(next, &values[i])) return 0;
    }
    return 1;
}

static int whole(char **rest, int most, int *value) {
    double read;
    if (!numbers(rest, &read, 1) || !(read >= 0.0 && read <= most) || read != floor(read)) return 0;
    *value = (int)read;
    return 1;
}

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
    if (!whole(rest, MOST_DRAWS, &model->draws) || !whole(rest, BENCH_PARAMETERS, &model->columns)) {
        return "bench.txt: the number of draws cannot be read";
    }
    for (int i = 0; i < model->columns; i++) {
        const char *name = word(rest);
        model->column[i] = name ? parameter_named(name) : -1;
        if (model->column[i] < 0) return "bench.txt: a draw has an unknown parameter";
    }
    count = (size_t)model->draws * (size_t)model->columns;
    model->draw = (double *)calloc(count + 1, sizeof(double));
    if (!model->draw) return "there is no memory for the draws";
    return numbers(rest, model->draw, (int)count) ? NULL : "bench.txt: a draw cannot be read";
}

static const char *read_entry(bench_model *model, const char *name, char **rest) {
    int parameter = parameter_named(name), yes = 0;
    if (parameter >= 0) {
        return numbers(rest, &model->estimate[parameter], 1) ? NULL : "bench.txt: a parameter cannot be read";
    }
    if (strcmp(name, "token") == 0) {
        const char *token = word(rest);
        if (!token || strlen(token) >= sizeof model->token) return "bench.txt: the token cannot be read";
        strcpy(model->token, token);
        return NULL;
    }
    if (strcmp(name, "speed_control") == 0) {
        if (!whole(rest, 1, &yes)) return "bench.txt: speed_control is neither 0 nor 1";
        model->has_speed_control = yes;
        return NULL;
    }
    if (strcmp(name, "initial") == 0) {
        double start[2];
        if (!numbers(rest, start, 2)) return "bench.txt: the initial speed and torque cannot be read";
        model->initial.speed_rad_s = start[0];
        model->initial.torque_nm = start[1];
        return NULL;
    }
    if (strcmp(name, "speed_range") == 0) {
        return numbers(rest, model->speed_range_rad_s, 2) ? NULL : "bench.txt: the range of speed cannot be read";
    }
    if (strcmp(name, "torque_range") == 0) {
        return numbers(rest, model->torque_range_nm, 2) ? NULL : "bench.txt: the range of torque cannot be read";
    }
    if (strcmp(name, "draws") == 0) return read_draws(model, rest);
    return "bench.txt has an unknown entry; it was written for another version";
}

static const char *read_text(bench_model *model, char *text) {
    char *rest = text, *name = word(&rest);
    int version = 0;
    if (!name || strcmp(name, "dynoid-bench") != 0) return "bench.txt is no model of a bench";
    if (!whole(&rest, 1, &version) || version != 1) return "bench.txt has another version than 1";
    while ((name = word(&rest)) != NULL) {
        const char *fault;
        if (strcmp(name, "end") == 0) return bench_fault(model->estimate);
        fault = read_entry(model, name, &rest);
        if (fault) return fault;
    }
    return "bench.txt ends too early";
}

const char *model_file_read(bench_model *model, const char *path) {
    FILE *file;
    char *text;
    const char *fault;
    memset(model, 0, sizeof *model);
    model->speed_range_rad_s[0] = model->torque_range_nm[0] = -HUGE_VAL;
    model->speed_range_rad_s[1] = model->torque_range_nm[1] = HUGE_VAL;
    file = open_file(path);
    if (!file) return "the file bench.txt cannot be opened";
    text = text_of(file);
    fclose(file);
    if (!text) return "the file bench.txt cannot be read";
    fault = read_text(model, text);
    free(text);
    if (fault) model_file_free(model);
    return fault;
}

void model_file_free(bench_model *model) {
    free(model->draw);
    model->draw = NULL;
}

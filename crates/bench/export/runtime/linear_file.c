/* Reads a linear model; see linear_file.h. */
#include "linear_file.h"

#include <stdlib.h>
#include <string.h>

#include "text_file.h"

static const int MOST_STATES = 1000, MOST_CHANNELS = 1000, MOST_DRAWS = 100000;
/* Numbers that a text file of ours can hold. */
static const double MOST_NUMBERS = 1e6;

static double size_of_one(const linear_model *m) {
    return ((double)m->states + m->outputs) * ((double)m->states + m->inputs);
}

static const char *read_sizes(linear_file *file, char **rest) {
    linear_model *m = &file->estimate;
    if (!text_whole(rest, MOST_STATES, &m->states) || !text_whole(rest, MOST_CHANNELS, &m->inputs) ||
        !text_whole(rest, MOST_CHANNELS, &m->outputs) || !text_whole(rest, MOST_DRAWS, &file->draws) ||
        !text_numbers(rest, &m->sample_time_s, 1) || !(m->sample_time_s > 0.0)) {
        return "linear.txt: the sizes cannot be read";
    }
    return size_of_one(m) * (file->draws + 1.0) <= MOST_NUMBERS ? NULL : "linear.txt: the model is too large";
}

static const char *read_text(linear_file *file, char *text) {
    char *rest = text;
    const char *word = text_word(&rest), *fault;
    int version = 0, count;
    if (!word || strcmp(word, "dynoid-linear") != 0) return "linear.txt is no linear model";
    if (!text_whole(&rest, 1, &version) || version != 1) return "linear.txt has another version than 1";
    word = text_word(&rest);
    if (!word || strlen(word) >= sizeof file->token) return "linear.txt: the token cannot be read";
    strcpy(file->token, word);
    fault = read_sizes(file, &rest);
    if (fault) return fault;
    count = (int)size_of_one(&file->estimate) * (file->draws + 1);
    file->numbers = (double *)calloc((size_t)count + 1, sizeof(double));
    if (!file->numbers) return "there is no memory for the model";
    if (!text_numbers(&rest, file->numbers, count)) return "linear.txt: a number cannot be read";
    word = text_word(&rest);
    return word && strcmp(word, "end") == 0 ? NULL : "linear.txt does not end where it should";
}

const char *linear_file_read(linear_file *file, const char *folder) {
    char *text;
    const char *fault;
    memset(file, 0, sizeof *file);
    fault = text_file_read(folder, "linear.txt", &text);
    if (fault) return fault;
    fault = read_text(file, text);
    free(text);
    if (fault) linear_file_free(file);
    return fault;
}

linear_model linear_file_draw(const linear_file *file, int draw) {
    linear_model m = file->estimate;
    m.a = file->numbers + (size_t)draw * (size_t)size_of_one(&m);
    m.b = m.a + m.states * m.states;
    m.c = m.b + m.states * m.inputs;
    m.d = m.c + m.outputs * m.states;
    return m;
}

void linear_file_free(linear_file *file) {
    free(file->numbers);
    file->numbers = NULL;
}

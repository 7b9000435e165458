/* Text files among the resources; see text_file.h. */
#include "text_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* No file of ours is larger. */
static const size_t LARGEST = 4u << 20;

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

static const char *content_of(FILE *file, char **text) {
    size_t length;
    *text = (char *)malloc(LARGEST + 1);
    if (!*text) return "there is no memory for a file of the resources";
    length = fread(*text, 1, LARGEST + 1, file);
    if (length <= LARGEST && !ferror(file)) {
        (*text)[length] = '\0';
        return NULL;
    }
    free(*text);
    *text = NULL;
    return "a file of the resources cannot be read";
}

const char *text_file_read(const char *folder, const char *name, char **text) {
    size_t length = folder ? strlen(folder) : 0;
    const char *fault = "the model's file cannot be opened in the folder of the resources";
    char *path;
    FILE *file;
    *text = NULL;
    if (length == 0) return "there is no folder of resources, where the model is";
    path = (char *)malloc(length + 2 + strlen(name));
    if (!path) return "there is no memory for an instance";
    memcpy(path, folder, length);
    if (path[length - 1] != '/' && path[length - 1] != '\\') path[length++] = '/';
    strcpy(path + length, name);
    file = open_file(path);
    if (file) {
        fault = content_of(file, text);
        fclose(file);
    }
    free(path);
    return fault;
}

/* ---- words --------------------------------------------------------------------------------------------------- */

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* The next word, ended with a zero; NULL at the end. */
char *text_word(char **rest) {
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

int text_numbers(char **rest, double *values, int count) {
    for (int i = 0; i < count; i++) {
        const char *next = text_word(rest);
        if (!next || !number(next, &values[i])) return 0;
    }
    return 1;
}

int text_whole(char **rest, int most, int *value) {
    double read;
    if (!text_numbers(rest, &read, 1) || !(read >= 0.0 && read <= most) || read != floor(read)) return 0;
    *value = (int)read;
    return 1;
}

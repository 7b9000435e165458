/* Text files among the resources: words between blanks, comments from # to the end of the line, numbers in hexadecimal,
 * since these are exact and do not depend on the decimal sign of the host. */
#ifndef DYNOID_TEXT_FILE_H
#define DYNOID_TEXT_FILE_H

/* Reads a file of a folder, whose path is in UTF-8; the caller frees the text. Returns what is wrong, or NULL. */
const char *text_file_read(const char *folder, const char *name, char **text);

/* The next word, ended with a zero; NULL at the end. */
char *text_word(char **rest);
/* So many numbers. Returns 0 for anything else. */
int text_numbers(char **rest, double *values, int count);
/* A whole number from 0 to `most`. Returns 0 for anything else. */
int text_whole(char **rest, int most, int *value);

#endif
